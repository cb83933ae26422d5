"""Measurements of a motor with a spring, by inverse dynamics from given motions.

The positions of the motor and the deformation are prescribed. The motor torque is computed from
them with (3) and Coulomb friction, so no differential equation has to be solved. One joint has a
lever arm as the AwAS, the other one thing that the model of FilteredRegression does not have.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from c_library import Array

T = 1e-3
GAMMA, B, D_THETA = 50.0, 2.3e-5, 1e-3
COULOMB_VELOCITY = 0.02  # [rad/s]


STIFFNESS, RANGE = 140.0, 0.1  # of MisfitJoint
SETTINGS = {  # for it, with the scale of the stiffness, prior.tau_e / range.phi, at its true value
    **{"method": 2, "rls.n": 2, "rls.m": 1, "range.phi": RANGE, "prior.tau_e": STIFFNESS * RANGE},
    "prior.torque_gain": 0.0,
}


def rounded(x: Array, counts: float) -> Array:
    """Reading of an encoder [rad]; exact for no counts."""
    count = 2 * np.pi / counts if counts else 0.0
    return np.round(x / count) * count if count else x


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
    B: float = B
    D_theta: float = D_THETA
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
        q, theta = rounded(theta + phi, self.counts), rounded(theta, self.counts)
        return np.column_stack([theta, q, theta_c, tau, sensor])


@dataclass(frozen=True)
class MisfitJoint:
    """A linear spring, and what is beside it."""

    gamma: float = 50.0
    duration: float = 12.0
    tau_coulomb: float = 0.01
    bias: float = 0.0
    """Constant torque [N.m]."""
    load_friction: float = 0.0
    """Friction per flexibility torque [1]."""
    delay: float = 0.0
    """By which the torque is recorded late [s]."""
    eccentric: float = 0.0
    """Amplitude of the once-per-turn error of the link encoder [rad]."""
    damping: float = 0.0
    """Of the spring [N.m.s/rad]."""
    hysteresis: float = 0.0
    """Half the height of the loop [N.m], of an element of 2 % of the range."""
    gap: float = 0.0
    """Half the dead zone [rad]."""
    stops: bool = False
    """The joint is at rest at the end."""
    seed: int = 1

    @property
    def t(self) -> Array:
        return T * np.arange(round(self.duration / T), dtype=np.float64)

    def sum_of_sines(self, size: float, frequencies: tuple[float, ...]) -> tuple[Array, ...]:
        """Signal of about this size, zero at the start, and two derivatives."""
        rng = np.random.default_rng(self.seed)
        start = 1 - np.exp(-((self.t / 0.3) ** 3))
        if self.stops:
            start = start * start[::-1]
        signal = np.zeros(len(self.t))
        for f in frequencies:
            signal += size * start * np.sin(2 * np.pi * f * self.t + rng.uniform(0, 6))
        first = np.gradient(signal, T, edge_order=2)
        return signal, first, np.gradient(first, T, edge_order=2)

    @property
    def phi(self) -> tuple[Array, ...]:
        return self.sum_of_sines(0.02, (0.45, 1.13, 2.31))

    def measurements(self) -> Array:
        """theta, q, theta_c, tau, tau_e_sensor [size: ticks x 5]."""
        rng = np.random.default_rng(self.seed)
        theta, theta_dot, theta_ddot = self.sum_of_sines(0.5, (0.31, 0.83, 1.7))
        phi, phi_dot, _ = self.phi
        sign = np.tanh(theta_dot / 5e-3)
        tau_e = STIFFNESS * (phi - np.clip(phi, -self.gap, self.gap)) + self.damping * phi_dot
        tau_e = tau_e + self.hysteresis * self.play(phi)
        friction = self.tau_coulomb * sign * np.sign(self.gamma)
        friction = friction + self.load_friction * np.abs(tau_e) * sign / self.gamma
        tau = self.gamma * (B * theta_ddot + D_THETA * theta_dot) + friction
        tau = tau - (tau_e + self.bias) / self.gamma
        tau = np.interp(self.t - self.delay, self.t, tau)
        tau = tau + 3.2e-3 * rng.normal(size=len(tau))
        q = theta + phi
        q = q + self.eccentric * np.sin(q + 0.7)
        theta, q, zero = rounded(theta, 40000.0), rounded(q, 40000.0), np.zeros(len(tau))
        return np.column_stack([theta, q, zero, tau, zero])

    def play(self, phi: Array) -> Array:
        """Element of hysteresis, -1..1."""
        width, state, states = 0.02 * RANGE, 0.0, np.zeros(len(phi))
        for k in range(1, len(phi)):
            state = float(np.clip(state + phi[k] - phi[k - 1], -width, width))
            states[k] = state / width
        return states
