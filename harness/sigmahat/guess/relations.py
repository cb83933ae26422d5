"""Finds relations between columns: lines, copies, and derivatives."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from sigmahat.recording.log import Array

_SMOOTH = 15  # number of samples in the window of a differentiation by polynomials
_INNER = slice(_SMOOTH // 2, -(_SMOOTH // 2))  # samples with a complete window
_DERIVATIVE = 0.97  # least correlation of a column with the derivative of another column
_COPY = 1e-4  # largest relative residual of a column that is a copy in another unit


@dataclass(frozen=True)
class Line:
    """A fitted line y = offset + slope x."""

    slope: float
    offset: float
    correlation: float
    rest: float  # standard deviation of the residual, relative to y


def line(x: Array, y: Array) -> Line:
    """Fits a line to two columns of equal size; correlation 0 if a column does not vary."""
    x_0, y_0 = x - x.mean(), y - y.mean()
    xx, yy, xy = float(x_0 @ x_0), float(y_0 @ y_0), float(x_0 @ y_0)
    if xx == 0 or yy == 0:
        return Line(0.0, float(y.mean()), 0.0, 1.0)
    slope, correlation = xy / xx, xy / np.sqrt(xx * yy)
    rest = float(np.sqrt(max(1 - correlation**2, 0.0)))
    return Line(slope, float(y.mean() - slope * x.mean()), correlation, rest)


def is_copy(x: Array, y: Array) -> bool:
    """Returns whether one column is a copy of the other column in another unit."""
    return line(x, y).rest < _COPY


def smooth(x: Array, T: float = 1.0, order: int = 0) -> Array:
    """Computes a derivative of samples T apart, along the last axis, at the samples _INNER.

    A cubic polynomial is fitted to the samples around each sample (Savitzky and Golay, Analytical
    Chemistry 36:1627-1639, 1964). The import of scipy.signal would take two seconds.
    """
    places = np.arange(_SMOOTH) - _SMOOTH // 2
    factors = np.linalg.pinv(np.vander(places, 4, increasing=True))[order]
    values: Array = sliding_window_view(x, _SMOOTH, axis=-1) @ factors
    return values * (math.factorial(order) / T**order)


def derivatives(columns: Sequence[Array], T: float) -> Sequence[bool]:
    """Returns for each column whether it is a derivative of another column; samples T apart."""
    if not columns or len(columns[0]) < 4 * _SMOOTH:
        return [False] * len(columns)
    x = np.array(columns)
    both = [smooth(x, T, order) for order in (1, 0)]
    for each in both:
        each -= each.mean(axis=1, keepdims=True)
        each /= np.linalg.norm(each, axis=1, keepdims=True) + 1e-300
    correlation = both[1] @ both[0].T
    np.fill_diagonal(correlation, 0.0)
    found: list[bool] = (np.abs(correlation) > _DERIVATIVE).any(axis=1).tolist()
    return found


def scale_of_derivative(x: Array, v: Array, T: float) -> float | None:
    """Returns the ratio of v to the derivative of x; None if v is not the derivative of x."""
    if len(x) < 4 * _SMOOTH:
        return None
    fitted = line(smooth(x, T, 1), smooth(v))
    return fitted.slope if fitted.correlation**2 > _DERIVATIVE**2 else None


_CLEAR = 10.0  # least ratio of a coefficient to its standard error


def share_of_motor(theta: Array, phi: Array) -> float | None:
    """Computes how much of a fast motion of the motor the deformation shows; None if not clear.

    The link is too heavy to follow a fast motor, so phi = q - theta changes by -theta there. The
    equation of the link (1), with q = theta + phi and gravity as a linear spring, says the same at
    all frequencies: phi'' = -theta'' - (K / M) phi - ..., whose coefficient of theta'' is returned.
    In other units, or with theta before its gear, it is -1 times the ratio of the units and 1 /
    gear; it is positive for theta - q.
    """
    if len(theta) < 4 * _SMOOTH:
        return None
    x = np.array([theta, phi])
    (x_0, phi_0), (x_1, phi_1), (x_2, phi_2) = (smooth(x, 1.0, order) for order in (0, 1, 2))
    regressors = np.column_stack([x_2, phi_0, x_0, phi_1, x_1, np.ones_like(x_0)])
    scales = np.linalg.norm(regressors, axis=0) + 1e-300
    solved, rest, rank, _ = np.linalg.lstsq(regressors / scales, phi_2, rcond=None)
    if rank < regressors.shape[1] or not len(rest):
        return None
    inverse = np.linalg.inv((regressors / scales).T @ (regressors / scales))
    # Smoothed errors are correlated: there are about as many independent ones as windows.
    error = float(np.sqrt(inverse[0, 0] * rest[0] * _SMOOTH / len(phi_2)))
    return float(solved[0] / scales[0]) if abs(solved[0]) > _CLEAR * error else None
