"""A sum of sines that begins and ends at rest, in closed form."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Multisine:
    """Position e(t) sum_i A_i sin(2 pi f_i t + p_i) of the motor at the gear output.

    e rises from 0 to 1 in the ramp and falls again at the end, as s^4 (35 - 84 s + 70 s^2 - 20 s^3)
    with s from 0 to 1: position, velocity, acceleration and jerk begin and end at 0.
    """

    amplitudes: Sequence[float]  # [rad]
    frequencies: Sequence[float]  # [Hz]
    phases: Sequence[float]  # [rad]
    duration: float  # [s]
    ramp: float  # [s]

    def times(self, T: float) -> Array:
        """Times from the start to the end, T apart [s]."""
        return T * np.arange(round(self.duration / T) + 1, dtype=np.float64)

    def at(self, t: Array) -> tuple[Array, Array, Array]:
        """Position [rad], velocity [rad/s] and acceleration [rad/s2]."""
        w = 2 * np.pi * np.array(self.frequencies)[:, None]
        A, angle = np.array(self.amplitudes)[:, None], w * t + np.array(self.phases)[:, None]
        x, v = np.sum(A * np.sin(angle), axis=0), np.sum(A * w * np.cos(angle), axis=0)
        a = -np.sum(A * w**2 * np.sin(angle), axis=0)
        e, de, dde = self._envelope(t)
        return e * x, de * x + e * v, dde * x + 2 * de * v + e * a

    def _envelope(self, t: Array) -> tuple[Array, Array, Array]:
        """The envelope e with its derivatives; the ramps do not overlap."""
        rising = t < self.duration / 2
        s = np.clip(np.where(rising, t, self.duration - t) / self.ramp, 0.0, 1.0)
        slope = np.where(rising, 1.0, -1.0) / self.ramp
        e = s**4 * (35 - 84 * s + 70 * s**2 - 20 * s**3)
        return (
            e,
            140 * (s * (1 - s)) ** 3 * slope,
            420 * (s * (1 - s)) ** 2 * (1 - 2 * s) * slope**2,
        )

    def scaled(self, factor: float) -> Multisine:
        """The motion with amplitudes multiplied by a factor."""
        amplitudes = [factor * A for A in self.amplitudes]
        return Multisine(amplitudes, self.frequencies, self.phases, self.duration, self.ramp)
