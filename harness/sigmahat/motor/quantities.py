"""Defines the result of an identification, and converts the result to text and to JSON."""

import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sigmahat.motor.equation import COULOMB_VELOCITY
from sigmahat.recording import notes
from sigmahat.recording.notes import Note

ACCEPTED = 3.0
"""Standard deviations of a prior up to which FilteredRegression accepts motor data without doubt
(SH_OUTSIDE_PRIOR in `c/filtered_regression/report.c`)."""

WIDE = 1.0
"""Relative prior of motor data that the log does not determine. With a prior of 0, motor data count
as exact in FilteredRegression; with 1, values up to 4 times the given value are accepted."""

_UNMODELLED = 5.0
"""Largest error of undetermined values by unmodelled effects, relative to the interval of the fits:
of 24 undetermined inertias of joints with such effects, ten were outside of the interval of the
fits, and none was outside of five times this interval."""


@dataclass(frozen=True)
class Quantity:
    """One identified parameter with its 95 % interval, value +- half_width."""

    value: float  #: Value of the parameter, in `unit`.
    half_width: float
    """Half the width of the interval, in `unit`; inf if the motion does not determine the value."""
    unit: str
    """kg.m2 for B, N.m.s/rad for D_theta, N.m for tau_coulomb, rad for zero, N.m/A for
    torque_constant."""
    determined: bool
    """Whether the interval is narrow enough to use the value: within +-10 %. For tau_coulomb, +-0.5
    % of the torque is enough, for zero +-5 % of the covered deformation."""

    @property
    def interval(self) -> tuple[float, float]:
        """Both ends of the interval, in the same unit.

        The interval of an undetermined value is wider than half_width says: effects that the motor
        equation does not have can shift such a value by several times its random error.
        """
        half_width = self.half_width * (1.0 if self.determined else _UNMODELLED)
        return self.value - half_width, self.value + half_width

    @property
    def fitted(self) -> tuple[float, float]:
        """Both ends of the interval of the fits alone, in the same unit."""
        return self.value - self.half_width, self.value + self.half_width

    @property
    def told(self) -> bool:
        """Old name of `determined`, up to version 0.1."""
        warnings.warn("Quantity.told is now .determined", DeprecationWarning, stacklevel=2)
        return self.determined


@dataclass(frozen=True)
class Identified:
    """Motor data, polynomial orders and noise, identified from a log."""

    quantities: Mapping[str, Quantity]
    """Identified parameters by name: B, D_theta, tau_coulomb, zero, and maybe torque_constant. With
    a torque sensor instead of a motor, only zero."""
    symmetric: bool  #: Value for rls.symmetric.
    n: int  #: Value for rls.n.
    m: int  #: Value for rls.m, with the least error in a cross-validation.
    phi: float  #: Largest magnitude of the deformation, from its zero [rad].
    zero: float
    """Deformation at which the spring has no torque [rad]; 0 if the difference is insignificant."""
    set_point: float  #: Largest distance of the set-point from its center [1].
    set_point_center: float  #: Middle of the set-points; 0 if the torque does not depend on it [1].
    set_point_moves: bool  #: Whether the set-point changes in the log; otherwise m is 1.
    has_sensor: bool  #: Whether the torque is that of a sensor, as in modality Sensor.
    B: float  #: Motor inertia of the configuration [kg.m2].
    D_theta: float  #: Viscous friction of the configuration [N.m.s/rad].
    tau_variance: float = 0.0  #: Variance of the noise of the torque [(N.m)2].
    theta_variance: float = 0.0
    """Variance of the noise of the motor position, rounding included [rad2]."""
    bandwidth: float | None = None
    """Bandwidth of a filter that balances the noise of torque and position; at most the frequency
    up to which deformation and torque are coherent [rad/s]. None without a motor."""
    coherent: float = math.inf
    """Frequency above which the deformation is noise [Hz]; inf without noise."""
    V_a: float | None = None  #: Value for filter.V_a [rad2/s4]; None without a motor.
    knees: tuple[float, ...] = ()
    """Up to two deformations at which the slope of the spring torque changes suddenly [rad]."""
    torque: float = 0.0
    """Largest magnitude of the torque of the motor after its gear, or of the spring [N.m]."""
    notes: Sequence[Note] = ()  #: On reading the log, on its samples and on the motor.


_UNITS = {
    "tau_noise_variance": "(N.m)2",
    "theta_noise_variance": "rad2",
    "filter_bandwidth": "rad/s",
    "filter.V_a": "rad2/s4",
    "deformation_is_noise_above": "Hz",
    "zero_of_deformation": "rad",
    "knees": "rad",
    "largest_phi": "rad",
    "largest_setPoint_distance": "1",
    "setPoint_center": "1",
    "largest_gamma_tau": "N.m",
    "found": "kg.m2",
    "configured": "kg.m2",
    "prior": "1",
    **notes.UNITS,
}
"""Units of the numbers with these keys in JSON; each identified parameter has its own `unit`."""


def as_dict(identified: Identified) -> dict[str, Any]:
    """Returns the result as a dictionary for JSON, with the units of its numbers by key."""
    return {
        "units": _UNITS,
        **{
            name: {
                "value": quantity.value if quantity.determined else None,
                "interval": list(quantity.interval),
                "unit": quantity.unit,
            }
            for name, quantity in identified.quantities.items()
        },
        "rls.symmetric": identified.symmetric,
        "rls.n": identified.n,
        "rls.m": identified.m,
        "tau_noise_variance": identified.tau_variance,
        "theta_noise_variance": identified.theta_variance,
        "filter_bandwidth": identified.bandwidth,
        "filter.V_a": identified.V_a,
        "deformation_is_noise_above": identified.coherent,
        "zero_of_deformation": identified.zero,
        "knees": list(identified.knees),
        "largest_phi": identified.phi,
        "largest_setPoint_distance": identified.set_point,
        "setPoint_center": identified.set_point_center,
        "largest_gamma_tau": identified.torque,
        "notes": [note.as_dict() for note in identified.notes],
    }


def summary(identified: Identified) -> str:
    """Formats the result of an identification as text that fits on one screen."""
    lines = [f"  {note.in_words}" for note in identified.notes]
    lines.append("")
    lines += [f"{name:16}{_text(name, each)}" for name, each in identified.quantities.items()]
    if not all(each.determined for each in identified.quantities.values()):
        lines.append("  `sigmahat motion` proposes what to record for more, from this log: --after")
    lines += [
        "",
        f"powers          rls.n = {identified.n}, rls.m = {identified.m} (cross-validation), "
        f"{'odd powers of phi alone' if identified.symmetric else 'odd and even powers of phi'}",
        f"noise           torque {math.sqrt(identified.tau_variance):.2g} N.m, "
        f"motor position {math.sqrt(identified.theta_variance):.2g} rad (standard deviations)",
        *_filter(identified),
        f"ranges          deformation {identified.phi:.3g} rad, "
        f"set-point {identified.set_point_center:.3g} +- {identified.set_point:.3g}, "
        f"{'torque' if identified.has_sensor else 'gamma tau'} {identified.torque:.3g} N.m",
    ]
    if not identified.has_sensor:
        lines.append(f"friction is     tau_coulomb tanh(theta_dot / ({COULOMB_VELOCITY:g} rad/s))")
    lines += [
        f"knee            the slope of the torque changes at +-{knee:.3g} rad"
        for knee in identified.knees
    ]
    if math.isfinite(identified.coherent):
        lines.append(
            f"above {identified.coherent:.2g} Hz the deformation is noise, "
            "not caused by a torque; the bandwidth is chosen below this frequency"
        )
    return "\n".join(lines)


def _filter(identified: Identified) -> Iterator[str]:
    if identified.V_a is not None and identified.bandwidth is not None:
        yield (
            f"filter          V_a = {identified.V_a:.2g} rad2/s4; "
            f"bandwidth {identified.bandwidth:.3g} rad/s"
        )


def _text(name: str, quantity: Quantity) -> str:
    low, high = quantity.interval
    if name == "B":
        low = max(low, 0.0)
    if quantity.determined:
        return f"{quantity.value:.4g} +- {quantity.half_width:.2g} {quantity.unit} (95 %)"
    if math.isfinite(quantity.half_width):
        return f"cannot tell: somewhere from {low:.2g} to {high:.2g} {quantity.unit}"
    return "cannot tell: the motion does not show it"
