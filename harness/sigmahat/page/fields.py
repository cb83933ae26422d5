"""What there is to choose and to fill in, as data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

ANGLES = ("rad", "mrad", "deg", "turn", "counts")
TORQUES = ("N.m", "mN.m", "kN.m", "A", "mA")
UNITS: Mapping[str, Sequence[str]] = {
    "theta": ANGLES,
    "q": ANGLES,
    "theta_c": (*ANGLES, "mm"),
    "tau": TORQUES,
    "tau_e_sensor": TORQUES[:3],
}
"""Units to choose from, by port; a file may name any other one."""
TITLES: Mapping[str, str] = {
    "theta": "theta: motor",
    "q": "q: link",
    "tau": "tau: torque of the motor",
    "theta_c": "theta_c: set-point",
    "tau_e_sensor": "tau_e_sensor: torque sensor",
}
"""Ports, those that most joints have first."""
BY_SCALE = "factor"
"""Stands for no unit: the port has a scale."""


@dataclass(frozen=True)
class NumberField:
    """A key whose value is a number."""

    key: str
    title: str
    default: str = ""
    """What holds where the key is not there."""
    units: Sequence[str] = ()
    """Units of the column with which it is shown; none: with all of them."""
    ports: Sequence[str] = ()
    """Ports at which it is shown; none: at all of them."""


OF_PORT = (
    NumberField("counts_per_turn", "counts per turn", units=("counts",)),
    NumberField("gear_ratio", "gear ratio", "1", ports=("theta", "tau")),
    NumberField("torque_constant", "torque constant [N.m/A]", units=("A", "mA")),
    NumberField("scale", "port per unit of the column", units=(BY_SCALE,)),
    NumberField("mm_per_turn", "mm per turn of the motor", "number of mm", units=("mm",)),
    NumberField("zero", "zero, in its unit", "0"),
    NumberField("wrap", "starts again after", "never", ports=("theta", "q", "theta_c")),
    NumberField("delay", "recorded later by [s]", "0", ports=("tau",)),
)
"""Of each port."""
PARAMETERS = (
    NumberField("samplePeriod", "sample period [s]", "0.001"),
    NumberField("motor.gamma", "motor.gamma", "gear ratio of theta"),
    NumberField("motor.B", "motor.B [kg.m²]"),
    NumberField("motor.D_theta", "motor.D_theta [N.m.s/rad]"),
)
"""Of the estimator."""
CHOICES: Mapping[str, Sequence[str]] = {
    "modality": ("Residual", "Sensor", "Model"),
    "method": ("Paper2011", "FilteredRegression"),
}
"""Parameters with a few values; the first one is the start value of the FMU."""
