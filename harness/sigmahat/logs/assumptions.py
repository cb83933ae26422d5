"""What the parameters of FilteredRegression take for granted, so that no data show it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from sigmahat.fmi.instance import Value

UNITS = {
    "bias": "N.m",
    "damping": "N.m.s/rad",
    "load_friction": "",
    "eccentric": "rad",
    "delay": "s",
    "hysteresis": "N.m",
}
"""Of what FilteredRegression estimates beside motor data: output bias_hat, parameter prior.bias."""
MOTOR = {"B": "kg.m2", "D_theta": "N.m.s/rad"}
"""Units of the motor data: parameter motor.B, output B_hat."""


def priors(p: Mapping[str, Value]) -> dict[str, float]:
    """Standard deviations of the priors of UNITS, in the units of the outputs.

    p  all parameters
    """
    tau_e, phi = float(p["prior.tau_e"]), float(p["range.phi"])
    # Friction by load is the sum of two: by the torque of the spring, and by that of the motor.
    by_load = math.sqrt(2) if p["prior.tau_coulomb"] else 1.0
    per_unit = {
        "bias": tau_e,
        "damping": tau_e / phi,
        "hysteresis": tau_e,
        "load_friction": by_load,
    }
    return {name: float(p[f"prior.{name}"]) * per_unit.get(name, 1.0) for name in UNITS}


def exact(p: Mapping[str, Value]) -> Sequence[str]:
    """Motor data that are taken as exact, of MOTOR."""
    if p["modality"] != "Residual":
        return []
    return [name for name in MOTOR if not float(p[f"motor.{name}"]) * float(p[f"prior.{name}"])]


def absent(p: Mapping[str, Value]) -> Sequence[str]:
    """What is taken as absent: tau_coulomb, and names of UNITS."""
    names = [name for name, std in priors(p).items() if not std]
    if p["modality"] == "Residual" and not p["prior.tau_coulomb"]:
        names.insert(0, "tau_coulomb")
    return names
