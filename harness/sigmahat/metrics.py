"""Performance indices of a stiffness estimate, and their mean over seeds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

SETTLED = 1.0
"""Time after which an estimate is judged without its start-up [s]."""


@dataclass(frozen=True)
class Indices:
    """Performance indices of one estimate over one run."""

    mse: float
    """(35) [(N.m/rad)2]"""
    msrep: float
    """(36) [%]"""
    msrep_settled: float
    """(36) over t >= SETTLED [%]"""


def mse(sigma: ArrayLike, estimate: ArrayLike) -> float:
    """Mean square error, (35), in the square of the unit of sigma.

    Both arguments have the shape (p + 1,), p >= 1: samples k = 0..p. As printed, the p + 1 squares
    are divided by p. Raises ValueError for other shapes and values that are not finite.
    """
    true, estimated = _pair(sigma, estimate)
    return float(np.sum((true - estimated) ** 2) / (len(true) - 1))


def msrep(sigma: ArrayLike, estimate: ArrayLike) -> float:
    """Mean square relative error, (36) [%]; arguments as for mse, with sigma nonzero."""
    true, estimated = _pair(sigma, estimate)
    if not np.all(true):
        raise ValueError("relative error: expected a true stiffness that is nowhere zero")
    return mse(np.ones_like(true), estimated / true) * 100


def indices(t: NDArray[np.float64], sigma: ArrayLike, estimate: ArrayLike) -> Indices:
    """All indices of one run; t [s] has the shape of sigma and estimate [N.m/rad]."""
    true, estimated = _pair(sigma, estimate)
    settled = t >= SETTLED
    return Indices(
        mse(true, estimated), msrep(true, estimated), msrep(true[settled], estimated[settled])
    )


def mean_interval(values: Sequence[float]) -> tuple[float, float]:
    """Mean over independent runs and half the width of its 95 % interval (Student t).

    The half width of a single value is not known: nan.
    """
    mean = float(np.mean(values))
    if len(values) < 2:
        return mean, math.nan
    from scipy.special import stdtrit

    deviation = float(np.std(values, ddof=1))
    return mean, float(stdtrit(len(values) - 1, 0.975)) * deviation / math.sqrt(len(values))


def _pair(sigma: ArrayLike, estimate: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    true, estimated = np.asarray(sigma, float), np.asarray(estimate, float)
    if true.ndim != 1 or true.shape != estimated.shape or len(true) < 2:
        raise ValueError(
            "expected true and estimated stiffness of the same shape (p + 1,), p >= 1, "
            f"got {true.shape} and {estimated.shape}"
        )
    if not (np.all(np.isfinite(true)) and np.all(np.isfinite(estimated))):
        raise ValueError("expected finite stiffness, got values that are not")
    return true, estimated
