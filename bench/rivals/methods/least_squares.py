"""Ordinary least squares of the motor equation off line: IDIM-LS.

    g^2 B theta'' + g^2 D theta' + g tau_c sign(theta') + offset - tau_e(phi) = g tau

M. Gautier, "Dynamic identification of robots with power model", Proc. IEEE ICRA 1997, 1922-1927;
W. Khalil and E. Dombre, "Modeling, Identification and Control of Robots", Hermes Penton 2002,
chapter 12: the variance of the error is from the residual, and the covariance from it and the
information. The data sheet's inertia and viscous friction take part as two more rows with their own
standard deviations, as a priori values do in M. Gautier and G. Venture, "Identification of standard
dynamic parameters of robots with positive definite inertia matrix", Proc. IEEE/RSJ IROS 2013.

Filters follow Gautier, and A. Janot, P.-O. Vandanjon, M. Gautier, "A generic instrumental variable
approach for industrial robot identification", IEEE Trans. Control Systems Technology 22(1):132-145,
2014, section II: a Butterworth filter without lag with a corner at 10 times the frequency of the
dynamics, central differences, and a low pass without lag (Chebyshev, order 8) at twice the
frequency of the dynamics, through which both sides of the equation pass before most samples are
dropped ("parallel decimation").
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from scipy import signal

from rivals.records import Array, Estimate, JointLog, Known, encoder_std, with_interval
from rivals.spring import spring

ORDER = 4
"""Of the Butterworth filter."""
DYNAMICS = 0.99
"""Share of the power of the motor velocity below the frequency of the dynamics."""
EDGE = 5
"""Rows that are dropped at both ends, where filters without lag have no past or no future."""
INERTIA, VISCOUS, COULOMB, OFFSET, SPRING = 0, 1, 2, 3, 4
"""Columns; those of the spring are the last ones."""


def estimate(log: JointLog) -> Estimate:
    """The estimate of the whole log, the same at every sample but for the deformation."""
    begin = time.perf_counter()
    rows = regression(log)
    beta, covariance = solve(rows.X, rows.y, log.known)
    variance = np.sum((rows.slope @ covariance[SPRING:, SPRING:]) * rows.slope, axis=1)
    std = np.sqrt(np.maximum(variance, 0.0))
    return with_interval(log, rows.slope @ beta[SPRING:], std, time.perf_counter() - begin)


@dataclass(frozen=True)
class Regression:
    """Rows y = X beta + error of a log: B, D, tau_c, offset, coefficients of the spring."""

    X: Array  # [size: rows x (4 + coefficients)]
    y: Array
    slope: Array  # of the functions of the spring at every sample [size: samples x coefficients]


def regression(log: JointLog) -> Regression:
    """The rows of a log. Raises ValueError if the motor does not move."""
    T, g, shape, f = log.sample_period, log.known.gamma, spring(log), dynamics(log)
    corner = min(10 * f * 2 * T, 0.8)
    butterworth = signal.butter(ORDER, corner, output="sos")
    theta, q = (signal.sosfiltfilt(butterworth, x) for x in (log.theta, log.q))
    theta_dot, phi = np.gradient(theta, T), q - theta
    columns = (
        *(g**2 * np.gradient(theta_dot, T), g**2 * theta_dot, g * np.sign(theta_dot)),
        *(np.ones(len(theta)), -shape.torque(phi, log.theta_c), g * log.tau),
    )
    keep = decimation(T, f)
    chebyshev = signal.cheby1(8, 0.05, 0.8 / keep, output="sos")
    rows = signal.sosfiltfilt(chebyshev, np.column_stack(columns), axis=0)[::keep][EDGE:-EDGE]
    return Regression(rows[:, :-1], rows[:, -1], shape.slope(phi, log.theta_c))


def decimation(T: float, f: float) -> int:
    """One of so many samples is kept: the low pass of a decimation is at 0.8 of Nyquist."""
    return max(int(0.8 / (2 * f * 2 * T)), 1)


def dynamics(log: JointLog) -> float:
    """The frequency of the dynamics [Hz]. Raises ValueError if the motor does not move."""
    T = log.sample_period
    segment = min(len(log.theta), round(8 / T))
    f, density = signal.welch(log.theta, 1 / T, nperseg=segment, detrend="linear")
    rounding = 2 * T * encoder_std(log.known.counts_theta) ** 2  # white, one-sided density
    power = (2 * np.pi * f) ** 2 * np.where(density > 4 * rounding, density, 0.0)
    if not power.sum() > 0:
        raise ValueError("the motor does not move")
    share = np.cumsum(power) / power.sum()
    return float(f[np.searchsorted(share, DYNAMICS)])


def solve(X: Array, y: Array, known: Known) -> tuple[Array, Array]:
    """Coefficients and covariance. The variance of the rows is that of their residual."""
    scale = np.sqrt(np.mean(X**2, axis=0))
    X = X / scale
    mean, information = a_priori(known, scale)
    beta = np.linalg.lstsq(X, y)[0]
    for _ in range(2):  # the first time the residual is that without the rows of the data sheet
        residual = y - X @ beta
        variance = residual @ residual / (len(y) - len(beta))
        precision = X.T @ X / variance + np.diag(information)
        beta = np.linalg.solve(precision, X.T @ y / variance + information * mean)
    return beta / scale, np.linalg.inv(precision) / np.outer(scale, scale)


def a_priori(known: Known, scale: Array) -> tuple[Array, Array]:
    """What the data sheet says of the coefficients times scale: mean, and 1/variance.

    The information is 0 where it says nothing.
    """
    mean, information = np.zeros(len(scale)), np.zeros(len(scale))
    for column, value, relative in (
        (INERTIA, known.B, known.relative_std_B),
        (VISCOUS, known.D_theta, known.relative_std_D_theta),
    ):
        mean[column] = value * scale[column]
        if value and relative:
            information[column] = (relative * value * scale[column]) ** -2
    return mean, information
