"""Total least squares of the motor equation off line: both sides of it have errors.

S. Van Huffel and J. Vandewalle, "The Total Least Squares Problem: Computational Aspects and
Analysis", SIAM 1991: columns without error (Coulomb friction, offset) are eliminated first, and the
others are scaled by the covariance of their errors (generalised TLS, chapter 10); covariance of the
solution to first order (chapter 8). M. Gautier, P.-O. Vandanjon, C. Presse, "Identification of
inertial and drive gain parameters of robots", Proc. IEEE CDC 1994, use it for robots. The errors of
the columns are those of the encoders' rounding and of the torque's noise after the filters. TLS has
no place for the values of a data sheet.
"""

from __future__ import annotations

import time

import numpy as np
from scipy import linalg, signal

from rivals.answer import answer
from rivals.records import Array, Estimate, JointLog
from rivals.regression import (
    COULOMB,
    INERTIA,
    OFFSET,
    SPRING,
    VISCOUS,
    Filters,
    Regression,
    encoder_std,
    regression,
)

_SMALLEST = 1e-9  # error of a column, relative to the column, if there is none


def estimate(log: JointLog) -> Estimate:
    """The estimate of the whole log, the same at every sample but for the deformation."""
    begin = time.perf_counter()
    rows = regression(log)
    beta, covariance = solve(rows.X, rows.y, errors(log, rows))
    return answer(log, *rows.stiffness(log, beta, covariance), time.perf_counter() - begin)


def solve(X: Array, y: Array, C: Array) -> tuple[Array, Array]:
    """Coefficients and covariance.

    C  covariance of the errors of a row (X, y)
    """
    both = np.column_stack([X, y])
    scale = np.sqrt(np.mean(both**2, axis=0))
    both = both / scale
    C = C / np.outer(scale, scale)
    exact = [i for i in range(len(C)) if C[i, i] == 0]
    noisy = [i for i in range(len(C)) if C[i, i] > 0]
    Q, _ = np.linalg.qr(both[:, exact])
    rest = both[:, noisy] - Q @ (Q.T @ both[:, noisy])
    half = np.linalg.cholesky(C[np.ix_(noisy, noisy)])
    _, singular, V = np.linalg.svd(linalg.solve_triangular(half, rest.T, lower=True).T, False)
    v = linalg.solve_triangular(half.T, V[-1])
    beta = np.zeros(len(C) - 1)
    beta[noisy[:-1]] = -v[:-1] / v[-1]
    A, b = both[:, :-1], both[:, -1]
    beta[exact] = np.linalg.lstsq(A[:, exact], b - A @ beta)[0]
    residual = b - A @ beta
    variance = residual @ residual / (len(b) - len(beta))
    information = A.T @ A - singular[-1] ** 2 * C[:-1, :-1]
    unit = scale[-1] / scale[:-1]
    return beta * unit, variance * np.linalg.inv(information) * np.outer(unit, unit)


def errors(log: JointLog, rows: Regression) -> Array:
    """Covariance of the errors of a row (X, y), the mean over all rows.

    To first order in the errors of velocity, acceleration and deformation, and of the torque.
    """
    g, known = log.known.gamma, log.known
    white = spectrum(rows.filters)
    of_theta = encoder_std(known.counts_theta) ** 2
    of_q = encoder_std(known.counts_q) ** 2
    # velocity, acceleration, deformation: the velocity is a quarter of a period off the others
    motion = of_theta * np.array(
        [[white[1], 0, 0], [0, white[2], white[1]], [0, white[1], white[0]]]
    )
    motion[2, 2] += of_q * white[0]
    slope = -rows.spring.slope(rows.motion.phi, log.theta_c)
    size = rows.X.shape[1]
    jacobian = np.zeros((len(slope), size, 3))
    jacobian[:, VISCOUS, 0] = jacobian[:, INERTIA, 1] = g**2
    jacobian[:, SPRING:, 2] = slope
    C = np.zeros((size + 1, size + 1))
    C[:size, :size] = np.einsum("kim,mn,kjn->ij", jacobian, motion, jacobian, optimize=True)
    C[:size, :size] /= len(slope)
    C[size, size] = (g * known.noise_tau) ** 2 * white_of_torque(rows.filters)
    smallest = (_SMALLEST**2) * np.mean(np.column_stack([rows.X, rows.y]) ** 2, axis=0)
    smallest[[COULOMB, OFFSET]] = 0
    return C + np.diag(smallest)


def spectrum(filters: Filters) -> tuple[float, float, float]:
    """Variance of white noise of variance 1 after the filters: as it is, once and twice derived."""
    omega, low = _low_pass(filters)
    _, butterworth = signal.sosfreqz(filters.butterworth, omega)
    gain = (low * np.abs(butterworth) ** 2) ** 2
    difference = np.sin(omega) / filters.sample_period
    mean = [float(np.mean(gain * difference ** (2 * order))) for order in range(3)]
    return mean[0], mean[1], mean[2]


def white_of_torque(filters: Filters) -> float:
    """Variance of white noise of variance 1 after the low pass alone."""
    _, low = _low_pass(filters)
    return float(np.mean(low**2))


def _low_pass(filters: Filters) -> tuple[Array, Array]:
    """Gain of the low pass, forwards and backwards, over the angle per sample."""
    omega, low = signal.sosfreqz(filters.chebyshev, 1 << 14)
    return omega, np.abs(low) ** 2
