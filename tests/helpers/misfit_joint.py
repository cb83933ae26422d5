"""Measurements of a joint with one thing that the model of FilteredRegression does not have.

Positions are prescribed, and the torque of the motor follows from them by inverse dynamics.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from c_library import Array

T = 1e-3
B, D_THETA = 2.3e-5, 1e-3
STIFFNESS = 140.0
RANGE = 0.1
SETTINGS = {  # with the scale of the stiffness, prior.tau_e / range.phi, at its true value
    **{"method": 2, "rls.n": 2, "rls.m": 1, "range.phi": RANGE, "prior.tau_e": STIFFNESS * RANGE},
    "prior.torque_gain": 0.0,
}


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

    @property
    def sigma(self) -> Array:
        """Slope of the spring where it is engaged [N.m/rad]."""
        return np.full(len(self.t), STIFFNESS)

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
        count = 2 * np.pi / 40000
        positions = [np.round(x / count) * count for x in (theta, q)]
        return np.column_stack([*positions, np.zeros(len(tau)), tau, np.zeros(len(tau))])

    def play(self, phi: Array) -> Array:
        """Element of hysteresis, -1..1."""
        width, state, states = 0.02 * RANGE, 0.0, np.zeros(len(phi))
        for k in range(1, len(phi)):
            state = float(np.clip(state + phi[k] - phi[k - 1], -width, width))
            states[k] = state / width
        return states
