"""What the scenarios of the paper record of an estimator, and how they compare it."""

from __future__ import annotations

from collections.abc import Iterable

from sigmahat.runs.scenario import Comparison

OUTPUTS = (
    "sigma",
    "tau_e",
    "tau_e_residual",
    "theta_dot",
    "phi",
    "setPoint",
    "a",
    "rho",
    "epsilon",
    "valid",
)
"""Outputs of StiffnessEstimator."""


def against_the_plant(estimators: Iterable[str]) -> list[Comparison]:
    """Each estimator compared with the true stiffness of the plant."""
    return [Comparison(name, f"{name}.sigma", "plant.sigma") for name in estimators]
