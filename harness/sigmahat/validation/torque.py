"""How well a stiffness that is known explains the torque of a log."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.instance import Fmu, Slave, Value
from sigmahat.identification.noise import low_pass
from sigmahat.logs.log import Array
from sigmahat.logs.replay import gap, play, replay
from sigmahat.logs.resampling import stretches
from sigmahat.logs.sampling import Samples

LOW = 2.0
"""Frequency of the low pass [Hz]."""
_CHUNK = 1 << 16
_SHORTEST = 2.0
"""Of a stretch that is filtered: over its ends, the filter knows nothing [1/LOW]."""


@dataclass(frozen=True)
class TorqueError:
    """Predicted less measured torque of the spring."""

    rms: float
    """Root mean square of the error [N.m]."""
    std: float
    """Standard deviation of the measured torque [N.m]."""

    share: float
    """Of the instants of the log at which it is taken [1]."""

    @property
    def relative(self) -> float:
        """The error over that standard deviation [1]."""
        return self.rms / self.std if self.std > 0 else float("nan")

    @staticmethod
    def of(error: Array, torque: Array, ticks: int) -> TorqueError | None:
        """From samples, of a number of ticks; None without any."""
        if not len(error):
            return None
        rms, std = float(np.sqrt(np.mean(error**2))), float(np.std(torque))
        return TorqueError(rms, std, len(error) / ticks)


def torque_errors(
    fmu: Fmu, samples: Samples, start: Mapping[str, Value]
) -> tuple[TorqueError | None, TorqueError | None]:
    """The error over all instants that count, and below 2 Hz; None where there are none.

    The log is played twice: at the first time the estimator finds the friction and the bias of this
    log; the second time counts. Where the motor is slower than regression.slow the sign of its
    friction is unknown, and so is the torque of the spring: these instants do not count.

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
    """After a low pass without phase; nan outside of stretches that are long enough for it."""
    filtered = np.full(len(values), np.nan)
    for first, last in zip(*stretches(used), strict=True):
        if (last - first) * T * LOW >= _SHORTEST:
            filtered[first:last] = low_pass(values[first:last], LOW, T)
    return filtered
