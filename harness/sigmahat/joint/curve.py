"""The answer as a curve: torque and stiffness over the deformation, with intervals.

What is drawn, written and put into words is this record. It is computed by `logs/curve.py`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sigmahat.joint.records import Range
from sigmahat.joint.sheet import Polynomial

Array = NDArray[np.float64]

NORMAL_95 = 1.96
"""Half the width of an interval of 95 % over the standard deviation."""
_NEAR = 0.25
"""Of the distance to the next set-point: so near are the points that belong to one."""


@dataclass(frozen=True)
class Branch:
    """The curve at one set-point. Arrays are of one size, in the order of the deformation."""

    set_point: float
    """[1]"""
    reach: Range
    """Deformation of the data at this set-point [rad]: beyond it, the curve is a guess."""
    phi: Array
    """Deformation [rad], from below the reach to above it."""
    tau_e: Array
    """Flexibility torque [N.m]"""
    tau_e_std: Array | None
    """Its standard deviation [N.m], at most; None if the method claims none."""
    sigma: Array
    """Stiffness [N.m/rad]"""
    sigma_std: Array | None
    """Its standard deviation, as the estimator reports it [N.m/rad]; None as above."""

    @property
    def within(self) -> NDArray[np.bool_]:
        """Whether each point is in the reach of the data."""
        return (self.phi >= self.reach[0]) & (self.phi <= self.reach[1])

    def torque_interval(self) -> tuple[Array, Array] | None:
        """Lower and upper end of the 95 % interval of the torque [N.m]."""
        return _interval(self.tau_e, self.tau_e_std)

    def stiffness_interval(self) -> tuple[Array, Array] | None:
        """Lower and upper end of the 95 % interval of the stiffness [N.m/rad]."""
        return _interval(self.sigma, self.sigma_std)


@dataclass(frozen=True)
class Curve:
    """The answer of an estimator that has seen a log."""

    polynomial: Polynomial
    """Of the torque."""
    branches: Sequence[Branch]
    """One for each set-point, which increases; a single one for a fixed spring. None: no data."""

    @property
    def claims(self) -> bool:
        """Whether there are intervals."""
        return any(branch.sigma_std is not None for branch in self.branches)


def _interval(value: Array, std: Array | None) -> tuple[Array, Array] | None:
    if std is None:
        return None
    return value - NORMAL_95 * std, value + NORMAL_95 * std


def characteristic(reach: Range) -> tuple[float, float, float]:
    """Deformations at which the stiffness is printed [rad]: the middle, and half way to either end.

    The middle is 0, where the reach contains it.
    """
    low, high = reach
    middle = 0.0 if low <= 0 <= high else (low + high) / 2
    return (low + middle) / 2, middle, (high + middle) / 2


def nearest(settings: Sequence[float], set_points: Array) -> NDArray[np.intp]:
    """Which of several set-points each point belongs to; -1 if it is far from all of them.

    settings  increasing
    """
    if len(settings) == 1:
        return np.zeros(len(set_points), np.intp)
    levels = np.asarray(settings, np.float64)
    steps = np.diff(levels)
    width = _NEAR * np.minimum(np.append(steps, np.inf), np.insert(steps, 0, np.inf))
    found: NDArray[np.intp] = np.abs(set_points[:, None] - levels).argmin(axis=1)
    found[np.abs(set_points - levels[found]) > width[found]] = -1
    return found
