"""Measurements of a motor with a spring, by inverse dynamics from given motions.

The positions of the motor and the deformation are prescribed. The motor torque is computed from
them with (3) and Coulomb friction, so no differential equation has to be solved.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from c_library import Array

T = 1e-3
GAMMA = 50.0
COULOMB_VELOCITY = 0.02  # [rad/s]


@dataclass(frozen=True)
class Joint:
    """Motion and data of a joint with a lever arm as that of the AwAS. The motor data are the
    defaults of the estimator."""

    duration: float = 10.0
    """[s]"""
    frequency: float = 1.0
    """Frequency of the motor [Hz]."""
    amplitude: float = 0.8
    """Amplitude of the motor [rad]."""
    deformation: float = 0.02
    """Amplitude of phi, at 1.3 times the frequency [rad]."""
    B: float = 2.3e-5
    D_theta: float = 1e-3
    tau_coulomb: float = 0.0
    stiffness: Callable[[Array], Array] = np.ones_like
    """Stiffness over time [s], relative to the AwAS."""
    counts: float = 40000.0
    """Counts per turn of the encoders; 0: no rounding."""
    noise: float = 10**-2.5
    """Standard deviation of the motor torque [N.m]."""
    seed: int = 1

    @property
    def t(self) -> Array:
        """Times [s]."""
        return T * np.arange(round(self.duration / T) + 1, dtype=np.float64)

    @property
    def motion(self) -> tuple[Array, Array, Array, Array, Array]:
        """theta, its two derivatives, phi [rad], lever arm [m]. The motion starts at rest."""
        t, w = self.t, 2 * np.pi * self.frequency
        theta = self.amplitude * (1 - np.cos(w * t))
        theta_dot = self.amplitude * w * np.sin(w * t)
        theta_ddot = self.amplitude * w**2 * np.cos(w * t)
        phi = self.deformation * (1 - np.cos(1.3 * w * t)) * np.sin(0.7 * w * t)
        return theta, theta_dot, theta_ddot, phi, 0.07 + 0.02 * np.sin(0.9 * t)

    @property
    def tau_e(self) -> Array:
        """Flexibility torque (28) [N.m]."""
        _, _, _, phi, r = self.motion
        return self.stiffness(self.t) * 14220 * r**2 * np.sin(2 * phi)

    @property
    def sigma(self) -> Array:
        """Stiffness (29) [N.m/rad]."""
        _, _, _, phi, r = self.motion
        return self.stiffness(self.t) * 2 * 14220 * r**2 * np.cos(2 * phi)

    def measurements(self) -> Array:
        """theta, q, theta_c, tau, tau_e_sensor [size: ticks x 5]."""
        theta, theta_dot, theta_ddot, phi, r = self.motion
        rng = np.random.default_rng(self.seed)
        tau = GAMMA * (self.B * theta_ddot + self.D_theta * theta_dot) - self.tau_e / GAMMA
        tau += self.tau_coulomb * np.tanh(theta_dot / COULOMB_VELOCITY)
        tau += self.noise * rng.normal(size=len(tau))
        theta_c = (0.1 - r) / (0.0025 / (2 * np.pi))
        sensor = self.tau_e + 10 * self.noise * rng.normal(size=len(tau))
        q, theta = self._rounded(theta + phi), self._rounded(theta)
        return np.column_stack([theta, q, theta_c, tau, sensor])

    def _rounded(self, x: Array) -> Array:
        count = 2 * np.pi / self.counts if self.counts else 0.0
        return np.round(x / count) * count if count else x
