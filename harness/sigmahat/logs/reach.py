"""Where the data reach: at which set-points, and at each of them over which deformations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sigmahat.joint.curve import nearest
from sigmahat.joint.records import LearnedLog, Range
from sigmahat.logs.log import Array
from sigmahat.logs.measured import MeasuredPoints

_FAMILY = 5
"""Set-points of a curve whose set-point moves."""
_MOST_LEVELS = 7
"""Set-points of a curve whose set-point takes a few values."""
_GAP = 0.05
"""Of the range of the set-point: values further apart are of different levels."""
_OUTER = 0.1
"""Percent of the points at either end: single wrong samples do not set the reach."""


@dataclass(frozen=True)
class Reach:
    """The data at a set-point."""

    set_point: float
    """[1]"""
    phi: Range
    """Deformation of the data there [rad]."""


def reaches(points: MeasuredPoints, before: Sequence[LearnedLog], one_curve: bool) -> list[Reach]:
    """Where the points of a log reach, and the logs that were learned from before it.

    Of those only the ranges are known, and not over which deformations at which set-point. So where
    their set-point moved they count only at set-points in their range that this log has not.

    one_curve  whether it is the same at all set-points
    """
    values = _inner(points.set_point)
    low = min([values.min(initial=np.inf), *(b.set_point[0] for b in before if b.set_point)])
    high = max([values.max(initial=-np.inf), *(b.set_point[1] for b in before if b.set_point)])
    if low > high:
        return []
    found = []
    settings = _settings(values, float(low), float(high), one_curve)
    of_setting = nearest(settings, points.set_point)
    for i, setting in enumerate(settings):
        own = points.phi[of_setting == i]
        ranges = [_range(own)] if len(own) else []
        ranges += [
            each.phi
            for each in before
            if each.phi
            and each.set_point
            and (one_curve or each.set_point[0] <= setting <= each.set_point[1])
            and (one_curve or not len(own) or each.set_point[0] == each.set_point[1])
        ]
        if ranges:
            phi = min(r[0] for r in ranges), max(r[1] for r in ranges)
            found.append(Reach(setting, phi))
    return found


def _inner(values: Array) -> Array:
    """Values without the outermost."""
    if not len(values):
        return values
    low, high = _range(values)
    inner: Array = values[(values >= low) & (values <= high)]
    return inner


def _range(values: Array) -> Range:
    low, high = np.percentile(values, [_OUTER, 100 - _OUTER]).tolist()
    return low, high


def _settings(values: Array, low: float, high: float, one_curve: bool) -> list[float]:
    """Set-points: levels of the data, else evenly over the range."""
    if one_curve or not high - low > 1e-9 * max(abs(low), abs(high)):
        return [(low + high) / 2]
    ordered = np.unique(values)
    gap = _GAP * (high - low)
    levels = np.split(ordered, np.flatnonzero(np.diff(ordered) > gap) + 1)
    complete = len(ordered) > 0 and low == ordered[0] and high == ordered[-1]
    if complete and len(levels) <= _MOST_LEVELS and all(np.ptp(each) < gap for each in levels):
        return [float(np.median(each)) for each in levels]
    evenly: list[float] = np.linspace(low, high, _FAMILY).tolist()
    return evenly
