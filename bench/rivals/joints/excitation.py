"""What the drives are asked for: multisines of torque or of position."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rivals.records import Array

Complex = NDArray[np.complex128]

FADE = 1.0  # [s] that a motion takes to begin


@dataclass(frozen=True)
class Multisine:
    """Sum of sines around zero."""

    frequencies: Array  # [Hz]
    amplitudes: Array
    phases: Array  # [rad]

    def __call__(self, t: Array) -> Array:
        """Values at the times t [s]; it fades in."""
        return _fade(t) * self.harmonics(t, np.ones(len(self.frequencies), np.complex128))

    def harmonics(self, t: Array, response: Complex) -> Array:
        """What a linear system with this complex response to each line makes of it, at rest 0."""
        lines = self.amplitudes * response
        angles = 2 * np.pi * np.outer(t, self.frequencies) + self.phases
        summed: Array = np.imag(np.exp(1j * angles) @ lines)
        return summed


def _fade(t: Array) -> Array:
    s = np.clip(t / FADE, 0, 1)
    smooth: Array = s * s * (3 - 2 * s)
    return smooth


@dataclass(frozen=True)
class Drive:
    """Command of a motor: u = feed_forward + kp (reference - theta) - kd theta', within +-peak.

    theta is what the encoder reads, theta' its difference through a low pass of the first order.
    """

    feed_forward: Array  # [N.m] at every sample
    reference: Array  # [rad] at every sample
    kp: float  # [N.m/rad]
    kd: float  # [N.m.s/rad]
    peak: float  # [N.m]
