"""Ordinary least squares of the motor equation off line: IDIM-LS.

M. Gautier, "Dynamic identification of robots with power model", Proc. IEEE ICRA 1997, 1922-1927;
W. Khalil and E. Dombre, "Modeling, Identification and Control of Robots", Hermes Penton 2002,
chapter 12: rows from filtered measurements, the variance of the error from the residual and
the covariance from it and the information. The data sheet's inertia and viscous friction take
part as two more rows with their own standard deviations, as a priori values do in M. Gautier and
G. Venture, "Identification of standard dynamic parameters of robots with positive definite inertia
matrix", Proc. IEEE/RSJ IROS 2013.
"""

from __future__ import annotations

import time

import numpy as np

from rivals.records import Array, Estimate, JointLog, Known, with_interval
from rivals.regression import INERTIA, VISCOUS, regression


def estimate(log: JointLog) -> Estimate:
    """The estimate of the whole log, the same at every sample but for the deformation."""
    begin = time.perf_counter()
    rows = regression(log)
    beta, covariance = solve(rows.X, rows.y, log.known)
    return with_interval(log, *rows.stiffness(log, beta, covariance), time.perf_counter() - begin)


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
