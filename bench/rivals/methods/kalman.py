"""Extended Kalman filter whose states are the motor's motion and the parameters of its equation.

L. Ljung, "Asymptotic behavior of the extended Kalman filter as a parameter estimator for linear
systems", IEEE Trans. Automatic Control 24(1):36-50, 1979; D. Simon, "Optimal State Estimation",
Wiley 2006, section 13.4: parameters become states that are constant or walk at random. States:
theta, theta', the coefficients of the spring (a random walk), B and D relative to the data sheet,
tau_c and an offset (constants). The torque and the link position are inputs, the motor position is
the measurement; nothing is assumed of the load.

What a practitioner has to choose, from the data sheet alone: the noise of the measurement is that
of rounding; the velocity is driven by the noise of the torque, by the rounding of q through the
spring, and by a tenth of the largest friction, as friction is not just a sign; start values and
their standard deviations are those of the data sheet; the stiffness walks by 1 % of its scale, the
largest torque over the largest deformation, in a second. The sign of the velocity is a tanh, which
is steep at one count in ten samples, or less steep if the step needs it.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from math import cosh, tanh

import numpy as np

from rivals.records import (
    Array,
    Estimate,
    JointLog,
    encoder_std,
    none_found,
    with_interval,
)
from rivals.spring import Spring, spring

WALK = 0.01  # of the stiffness in a second, relative to its scale
FRICTION = 0.1  # standard deviation of what friction does besides, by the largest friction
_SMALLEST = 1e-9  # standard deviation of a position that is not rounded [rad]
THETA, VELOCITY, INERTIA, VISCOUS, COULOMB, OFFSET, SPRING = range(7)


def estimate(log: JointLog) -> Estimate:
    """The estimate on line: at each sample from those up to it."""
    begin = time.perf_counter()
    shape = spring(log)
    filtered = Filter(log, shape)
    phi = log.q - log.theta
    slope = shape.slope(phi, log.theta_c)
    stiffness, variance = np.empty(len(phi)), np.empty(len(phi))
    stiffness[0] = slope[0] @ filtered.x[SPRING:]
    variance[0] = slope[0] @ filtered.P[SPRING:, SPRING:] @ slope[0]
    for k in range(1, len(phi)):
        filtered.predict(inputs(log, k))
        filtered.correct(log.theta[k])
        if not np.isfinite(filtered.x[THETA]) or filtered.P[THETA, THETA] < 0:
            return none_found(log, time.perf_counter() - begin, f"diverged at sample {k}")
        stiffness[k] = slope[k] @ filtered.x[SPRING:]
        variance[k] = slope[k] @ filtered.P[SPRING:, SPRING:] @ slope[k]
    std = np.sqrt(np.maximum(variance, 0.0))
    return with_interval(log, stiffness, std, time.perf_counter() - begin)


@dataclass(frozen=True)
class Inputs:
    """Means over a step."""

    tau: float
    q: float
    theta_c: float


def inputs(log: JointLog, k: int) -> Inputs:
    """Inputs from sample k-1 to k."""
    return Inputs(*(float(a[k - 1] + a[k]) / 2 for a in (log.tau, log.q, log.theta_c)))


class Filter:
    """State and covariance."""

    def __init__(self, log: JointLog, shape: Spring) -> None:
        known, T = log.known, log.sample_period
        self.known, self.T, self.shape = known, T, shape
        size = SPRING + shape.n * shape.m
        rounding = max(encoder_std(known.counts_theta), _SMALLEST)
        self.R = rounding**2
        self.of_q = encoder_std(known.counts_q) ** 2
        g = known.gamma
        steep = 2 * np.pi / known.counts_theta / (10 * T) if known.counts_theta else 0.0
        self.slow = max(steep, 2 * T * known.tau_coulomb / (g * known.B), 1e-6)
        self.x = np.zeros(size)
        self.x[[THETA, INERTIA, VISCOUS]] = log.theta[0], 1.0, 1.0
        self.x[SPRING] = known.range_tau_e
        std = np.full(size, known.range_tau_e)
        std[THETA], std[VELOCITY] = rounding, 1.0
        std[INERTIA], std[VISCOUS] = known.relative_std_B, known.relative_std_D_theta
        std[COULOMB], std[OFFSET] = known.tau_coulomb, known.tau_coulomb * abs(g)
        self.P = np.diag(std**2)
        self.walk = np.zeros(size)
        self.walk[SPRING:] = (WALK * known.range_tau_e) ** 2 * T

    def predict(self, u: Inputs) -> None:
        """To the next sample, with the midpoint of the position."""
        known, T, x = self.known, self.T, self.x
        g, v = known.gamma, float(x[VELOCITY])
        phi, theta_c = np.array([u.q - x[THETA] - T / 2 * v]), np.array([u.theta_c])
        torques = self.shape.torque(phi, theta_c)[0]
        stiffness = float(self.shape.slope(phi, theta_c)[0] @ x[SPRING:])
        inertia = g**2 * known.B * float(x[INERTIA])
        sign = tanh(v / self.slow)
        torque = g * u.tau + float(torques @ x[SPRING:]) - x[OFFSET]
        torque -= g**2 * known.D_theta * x[VISCOUS] * v + g * x[COULOMB] * sign
        acceleration = torque / inertia
        a = np.zeros(len(x))  # derivatives of the acceleration
        a[THETA] = -stiffness
        damping = known.D_theta * g**2 * x[VISCOUS]
        steep = 0.0 if abs(v) > 20 * self.slow else 1 / cosh(v / self.slow) ** 2 / self.slow
        a[VELOCITY] = -stiffness * T / 2 - damping - g * x[COULOMB] * steep
        a[INERTIA] = -torque / x[INERTIA]
        a[VISCOUS], a[COULOMB], a[OFFSET] = -(g**2) * known.D_theta * v, -g * sign, -1.0
        a[SPRING:] = torques
        a *= T / inertia
        self._move(a, T * acceleration)
        torque2 = known.noise_tau**2 + (FRICTION * known.tau_coulomb) ** 2
        noise = g**2 * torque2 + stiffness**2 * self.of_q
        self.P[VELOCITY, VELOCITY] += (T / inertia) ** 2 * noise
        self.P[np.diag_indices(len(x))] += self.walk

    def _move(self, a: Array, step: float) -> None:
        """x and P after a step of the velocity, whose derivatives are `a`."""
        T, x, P = self.T, self.x, self.P
        x[THETA] += T * (x[VELOCITY] + step / 2)
        x[VELOCITY] += step
        F = np.eye(len(x))
        F[VELOCITY] += a
        F[THETA] += a * (T / 2)
        F[THETA, VELOCITY] += T
        self.P = F @ P @ F.T

    def correct(self, theta: float) -> None:
        """With the measured position."""
        variance = self.P[THETA, THETA] + self.R
        gain = self.P[:, THETA] / variance
        self.x = self.x + gain * (theta - self.x[THETA])
        self.P = self.P - np.outer(gain, gain) * variance
