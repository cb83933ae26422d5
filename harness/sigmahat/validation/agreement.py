"""How well two estimates agree: of a torque, and of a stiffness."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.instance import Fmu, Slave, Value
from sigmahat.identification.noise import low_pass
from sigmahat.joint.curve import NORMAL_95
from sigmahat.logs.log import Array
from sigmahat.logs.replay import gap, play, replay
from sigmahat.logs.sampling import Samples, stretches

LOW = 2.0  # frequency of the low pass [Hz]
_CHUNK = 1 << 16
_SHORTEST = 2.0
"""Shortest stretch that is filtered: beyond both ends, the filter has no data [1/LOW]."""


@dataclass(frozen=True)
class TorqueError:
    """Predicted less measured torque of the spring."""

    rms: float
    """Root mean square of the error [N.m]."""
    std: float
    """Standard deviation of the measured torque [N.m]."""

    share: float
    """Fraction of the instants of the log that the error covers [1]."""

    @property
    def relative(self) -> float:
        """The error divided by this standard deviation [1]."""
        return self.rms / self.std if self.std > 0 else float("nan")

    @staticmethod
    def of(error: Array, torque: Array, ticks: int) -> TorqueError | None:
        """The error from samples of a log with `ticks` ticks; None without samples."""
        if not len(error):
            return None
        rms, std = float(np.sqrt(np.mean(error**2))), float(np.std(torque))
        return TorqueError(rms, std, len(error) / ticks)


def torque_errors(
    fmu: Fmu, samples: Samples, start: Mapping[str, Value]
) -> tuple[TorqueError | None, TorqueError | None]:
    """The error at all instants that count, and the error below 2 Hz; None without such instants.

    The log is replayed twice: the first replay finds friction and bias of this log, the second
    replay counts. If the motor is slower than regression.slow, the sign of its friction is unknown,
    and so is the torque of the spring: these instants do not count.

    start  values of the FMU with which the curve does not change, start_values.as_fixed_curve
    """
    with Slave(fmu, "curve") as slave:
        for _ in replay(slave, samples, start, _CHUNK):
            pass
        t_0 = gap(slave, samples.T * len(samples.values), fmu.parameters(start))
        parts = list(play(slave, samples, _CHUNK, t_0))
    played = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    used = played["valid"] & (played["a"] > 0)
    moving = used
    if start["modality"] == "Residual":
        moving = used & (np.abs(played["theta_dot"]) >= float(start["regression.slow"]))
    both = played["epsilon"], played["tau_e_residual"]
    error, torque = (values[moving] for values in both)
    ticks = len(samples.values)
    every = TorqueError.of(error, torque, ticks)
    if 2 * LOW * samples.T >= 1:
        return every, None
    error, torque = (_below(values, used, samples.T) for values in both)
    counts = moving & np.isfinite(error)
    return every, TorqueError.of(error[counts], torque[counts], ticks)


def _below(values: Array, used: NDArray[np.bool_], T: float) -> Array:
    """Values after a low pass without phase; nan outside of stretches that are long enough."""
    filtered = np.full(len(values), np.nan)
    for first, last in zip(*stretches(used), strict=True):
        if (last - first) * T * LOW >= _SHORTEST:
            filtered[first:last] = low_pass(values[first:last], LOW, T)
    return filtered


@dataclass(frozen=True)
class Agreement:
    """The stiffness that was learned before, compared with the stiffness of a log alone."""

    before: tuple[float, float]
    """Stiffness learned before, and half the width of its interval; both are medians [N.m/rad]."""
    alone: tuple[float, float]
    """Stiffness of the log alone, and half the width of its interval; both are medians."""
    alone_in_before: float
    """Fraction of instants at which the interval of `before` contains the stiffness of `alone`."""
    before_in_alone: float
    """Fraction of instants at which the interval of `alone` contains the stiffness of `before`."""
    overlap: float
    """Fraction of the instants at which both intervals overlap."""
    z: float
    """Difference divided by its standard deviation, root mean square over the instants."""
    agree: bool | None
    """Whether z is at most 1.96; None if an interval contains 0 at half of the instants or more:
    then agreement would mean nothing."""


def agreement(
    before: Mapping[str, Array], alone: Mapping[str, Array], torque_gain: float
) -> Agreement:
    """Compares two estimates at the same points, logs.curve.stiffness_at.

    torque_gain  relative standard deviation of the gain of the torque: both estimates have the same
                 error of this gain, which does not explain a difference
    """
    difference = alone["sigma"] - before["sigma"]
    halves = [NORMAL_95 * each["sigma_std"] for each in (before, alone)]
    by_gain = [torque_gain * e["sigma_per_gain"] * np.abs(e["sigma"]) for e in (before, alone)]
    both = zip((before, alone), by_gain, strict=True)
    own = [np.maximum(e["sigma_std"] ** 2 - g**2, 0.0) for e, g in both]
    std = np.sqrt(own[0] + own[1] + (by_gain[1] - by_gain[0]) ** 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(difference == 0, 0.0, difference / std)
    z = float(np.sqrt(np.mean(ratio**2)))
    pairs = list(zip(halves, (before, alone), strict=True))
    says_nothing = any(np.median(half - np.abs(each["sigma"])) >= 0 for half, each in pairs)
    first, second = (
        (float(np.median(each["sigma"])), float(np.median(half))) for half, each in pairs
    )
    widths = (*halves, halves[0] + halves[1])
    alone_in_before, before_in_alone, overlap = (
        float(np.mean(np.abs(difference) <= half)) for half in widths
    )
    agree = None if says_nothing else bool(z <= NORMAL_95)
    return Agreement(first, second, alone_in_before, before_in_alone, overlap, z, agree)
