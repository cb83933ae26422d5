"""A plant of your own, from equations in CasADi to an FMU, in one file.

A pendulum on a spring that hardens, driven by a motor; with it, the estimator. Needs a C compiler
and CasADi, which `pip install '.[plants]'` adds.

Usage: python own_plant.py [FOLDER]     writes PendulumPlant.fmu there
"""

import sys
from pathlib import Path

try:
    import casadi as ca
except ModuleNotFoundError:
    sys.exit("own_plant.py: CasADi is not installed; to install it: pip install 'sigmahat[plants]'")

import sigmahat
from sigmahat import PlantEquations, PlantVariable, encoder, write_plant_fmu

# The equations. Names are those of the variables of the FMU.
plant = PlantEquations("PendulumPlant")
tau = plant.input("tau")
M = plant.parameter("link.M")
D_q = plant.parameter("link.D_q")
mgl = plant.parameter("link.mgl")
B = plant.parameter("motor.B")
D_theta = plant.parameter("motor.D_theta")
gamma = plant.parameter("motor.gamma")
k_1 = plant.parameter("spring.k_1")
phi_0 = plant.parameter("spring.phi_0")
counts = plant.parameter("encoder.counts")

# scale: how large a change of the state matters.
q = plant.state("q", start=plant.parameter("initial.q"), scale=0.01)
theta = plant.state("theta", start=0.0, scale=0.01)
q_dot = plant.state("q_dot", start=0.0, scale=1.0)
theta_dot = plant.state("theta_dot", start=0.0, scale=1.0)

phi = q - theta
tau_e = k_1 * phi_0 * ca.sinh(phi / phi_0)
plant.derivative(q, q_dot)
plant.derivative(q_dot, (-D_q * q_dot - mgl * ca.sin(q) - tau_e) / M)
plant.derivative(theta, theta_dot)
plant.derivative(theta_dot, (tau - D_theta * gamma * theta_dot + tau_e / gamma) / (B * gamma))

plant.output("q_measured", encoder(q, counts))
plant.output("theta_measured", encoder(theta, counts))
plant.output("tau_measured", tau + plant.noise(plant.parameter("noise.variance")))
plant.output("sigma", k_1 * ca.cosh(phi / phi_0))
plant.output("phi", phi)

# Data for the model description: unit, description, start value.
variables = {
    "tau": PlantVariable("N.m", "Torque of the motor, before its gear"),
    "link.M": PlantVariable("kg.m2", "Inertia of the pendulum", 0.1),
    "link.D_q": PlantVariable("N.m.s/rad", "Friction of the pendulum", 0.15),
    "link.mgl": PlantVariable("N.m", "Gravity torque of the horizontal pendulum", 5.0),
    "motor.B": PlantVariable("kg.m2", "Inertia of the motor", 2.3e-5),
    "motor.D_theta": PlantVariable("N.m.s/rad", "Friction of the motor", 1e-3),
    "motor.gamma": PlantVariable("1", "Gear ratio", 50.0),
    "spring.k_1": PlantVariable("N.m/rad", "Stiffness of the undeformed spring", 80.0),
    "spring.phi_0": PlantVariable("rad", "Deformation at which the spring hardens", 0.08),
    "encoder.counts": PlantVariable("1", "Counts per turn of both encoders", 40000.0),
    "noise.variance": PlantVariable("N2.m2", "Variance of the noise of tau_measured", 1e-5),
    "initial.q": PlantVariable("rad", "Position of the pendulum at the start", 0.0),
    "q_measured": PlantVariable("rad", "Position of the pendulum, from its encoder"),
    "theta_measured": PlantVariable(
        "rad", "Position of the motor after its gear, from its encoder"
    ),
    "tau_measured": PlantVariable("N.m", "Torque of the motor with noise"),
    "sigma": PlantVariable("N.m/rad", "True stiffness"),
    "phi": PlantVariable("rad", "True deformation"),
}


def main(folder: Path) -> None:
    fmu = folder / "PendulumPlant.fmu"
    write_plant_fmu(plant, variables, fmu)
    recording = sigmahat.simulate(
        sigmahat.Plant(
            fmu=str(fmu),
            start={},
            inputs={"tau": sigmahat.Sines(0.0, [sigmahat.Sine(0.2, 0.5), sigmahat.Sine(0.1, 1.3)])},
            record=["sigma"],
        ),
        {
            "RESIDUAL": sigmahat.EstimatorFmu(
                fmu="StiffnessEstimator",
                # One transmission without set-point: rls.m = 1; phi and phi^3: rls.n = 2. phi^3 is
                # some 1e-4, so over 10 000 ticks the ridge 1/(c P_0) must be far below 1e-4.
                start={"rls.n": 2, "rls.m": 1, "rls.P_0": 1e28},
                connections={"theta": "theta_measured", "q": "q_measured", "tau": "tau_measured"},
                record=["sigma"],
            )
        },
        T=1e-3,
        steps=10_000,
    )
    true, estimate = recording.plant["sigma"], recording.estimators["RESIDUAL"]["sigma"]
    found = sigmahat.indices(recording.t, true, estimate)
    print(f"{fmu}: after 1 s, MSREP {found.msrep_settled:.2g} %")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
