"""The motor equation as a regression off line, as the methods of the family IDIM form it.

    g^2 B theta'' + g^2 D theta' + g tau_c sign(theta') + offset - tau_e(phi) = g tau

Filters follow M. Gautier, "Dynamic identification of robots with power model", ICRA 1997, and
A. Janot, P.-O. Vandanjon, M. Gautier, "A generic instrumental variable approach for industrial
robot identification", IEEE Trans. Control Systems Technology 22(1):132-145, 2014, section II: a
Butterworth filter without lag with a corner at 10 times the frequency of the dynamics, central
differences, and a low pass without lag (Chebyshev, order 8) at twice the frequency of the dynamics,
through which both sides of the equation pass before most samples are dropped ("parallel
decimation").
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import signal

from rivals.records import Array, JointLog
from rivals.spring import Spring, spring

ORDER = 4
"""Of the Butterworth filter."""
DYNAMICS = 0.99
"""Share of the power of the motor velocity below the frequency of the dynamics."""
EDGE = 5
"""Rows that are dropped at both ends, where filters without lag have no past or no future."""
INERTIA, VISCOUS, COULOMB, OFFSET, SPRING = 0, 1, 2, 3, 4
"""Columns; those of the spring are the last ones."""


@dataclass(frozen=True)
class Motion:
    """Positions and their derivatives at every sample."""

    theta: Array  # [rad]
    theta_dot: Array  # [rad/s]
    theta_ddot: Array  # [rad/s2]
    phi: Array  # [rad]


@dataclass(frozen=True)
class Filters:
    """What the measured signals pass."""

    sample_period: float  # [s]
    dynamics: float  # frequency of the dynamics [Hz]

    @property
    def butterworth(self) -> Array:
        """Sections of the filter of the positions."""
        corner = min(10 * self.dynamics * 2 * self.sample_period, 0.8)
        return np.asarray(signal.butter(ORDER, corner, output="sos"))

    @property
    def decimation(self) -> int:
        """One of so many samples is kept: the low pass of a decimation is at 0.8 of Nyquist."""
        return max(int(0.8 / (2 * self.dynamics * 2 * self.sample_period)), 1)

    @property
    def chebyshev(self) -> Array:
        """Sections of the low pass of the decimation."""
        return np.asarray(signal.cheby1(8, 0.05, 0.8 / self.decimation, output="sos"))

    def motion(self, log: JointLog) -> Motion:
        """The motion of a log."""
        T = self.sample_period
        theta, q = (signal.sosfiltfilt(self.butterworth, x) for x in (log.theta, log.q))
        theta_dot = np.gradient(theta, T)
        return Motion(theta, theta_dot, np.gradient(theta_dot, T), q - theta)

    def decimated(self, columns: Array) -> Array:
        """Columns through the low pass, at the rows that are kept."""
        low = signal.sosfiltfilt(self.chebyshev, columns, axis=0)[:: self.decimation]
        return np.asarray(low[EDGE:-EDGE])


def filters(log: JointLog) -> Filters:
    """The filters for a log. Raises ValueError if the motor does not move."""
    T, known = log.sample_period, log.known
    segment = min(len(log.theta), round(8 / T))
    f, density = signal.welch(log.theta, 1 / T, nperseg=segment, detrend="linear")
    rounding = 2 * T * encoder_std(known.counts_theta) ** 2  # white, one-sided density
    power = (2 * np.pi * f) ** 2 * np.where(density > 4 * rounding, density, 0.0)
    if not power.sum() > 0:
        raise ValueError("the motor does not move")
    share = np.cumsum(power) / power.sum()
    return Filters(T, float(f[np.searchsorted(share, DYNAMICS)]))


def encoder_std(counts: int) -> float:
    """Standard deviation of the rounding error of an encoder [rad]; 0 if it does not round."""
    return 2 * np.pi / counts / np.sqrt(12) if counts else 0.0


def columns(log: JointLog, motion: Motion, shape: Spring) -> Array:
    """The left side of the equation per parameter: B, D, tau_c, offset, coefficients of the spring.

    [size: samples x (4 + coefficients)]
    """
    g = log.known.gamma
    return np.column_stack(
        [
            g**2 * motion.theta_ddot,
            g**2 * motion.theta_dot,
            g * np.sign(motion.theta_dot),
            np.ones(len(motion.theta)),
            -shape.torque(motion.phi, log.theta_c),
        ]
    )


@dataclass(frozen=True)
class Regression:
    """Rows y = X beta + error of a log."""

    filters: Filters
    motion: Motion
    spring: Spring
    X: Array
    y: Array

    def stiffness(self, log: JointLog, beta: Array, covariance: Array) -> tuple[Array, Array]:
        """Stiffness and its standard deviation at every sample [N.m/rad].

        covariance  of all coefficients
        """
        slope = self.spring.slope(self.motion.phi, log.theta_c)
        variance = np.sum((slope @ covariance[SPRING:, SPRING:]) * slope, axis=1)
        return slope @ beta[SPRING:], np.sqrt(np.maximum(variance, 0.0))


def regression(log: JointLog) -> Regression:
    """The rows of a log."""
    passed, shape = filters(log), spring(log)
    motion = passed.motion(log)
    X = passed.decimated(columns(log, motion, shape))
    y = passed.decimated(log.known.gamma * log.tau)
    return Regression(passed, motion, shape, X, y)
