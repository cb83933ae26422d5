"""Why FilteredRegression is not confident, in words."""

DOUBTS = {
    "NotExcited": ("ports.q.column", "the motion was too small or too short"),
    "Misfit": ("rls.n", "the log contradicts the model"),
    "OutOfRange": ("range.phi", "the deformation is far beyond range.phi"),
    "FrictionOutsidePrior": (
        "motor.D_theta",
        "friction is further from motor.D_theta than prior.D_theta, or below 0",
    ),
    "InertiaOutsidePrior": ("motor.B", "the inertia is further from motor.B than prior.B allows"),
    "NegativeStiffness": ("ports.q.sign", "the stiffness found is negative"),
    "Change": ("rls.n", "the stiffness seems to change"),
}
"""Items of the FMU output `doubt`, with the key to check first and a description."""
