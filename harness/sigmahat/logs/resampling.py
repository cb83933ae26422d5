"""The values of one column at the ticks of the estimator.

A sample at a tick, within a thousandth of the period, is used without a change. A slower, faster or
uneven column has samples elsewhere. Ticks between two such samples are interpolated linearly, if
the samples are not further apart than the longest gap. The longest gap is configured, or three
times the usual interval of the column. All other ticks get nan, and the estimator skips them. So a
column with a sample for nearly every tick is only interpolated if a longest gap is configured.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sigmahat.logs.log import Array

AT_TICK = 1e-3
"""Largest distance of a sample from its tick, in periods."""
_USUAL_INTERVALS = 3.0


@dataclass(frozen=True)
class Resampled:
    """A column at the ticks, and statistics of its samples."""

    values: Array
    """Values [size: ticks], nan at ticks without a value."""
    interval: float
    """Usual time between two samples [s]."""
    even: bool
    """Whether nearly every tick has a sample."""
    interpolated: int = 0
    """Number of interpolated ticks."""
    between: int = 0
    """Number of samples between ticks, before the first tick, and after the last tick."""
    missing: int = 0
    """Number of samples without a time or a value."""


def at_ticks(
    t: Array, values: Array, T: float, ticks: int, longest_gap: float | None
) -> Resampled | None:
    """The values of a column at the ticks; None if the column has no number.

    t            times since the first tick [s], increasing; nan where unknown; [size: samples]
    values       [size: samples], nan where a sample is missing
    T            time between ticks [s]
    longest_gap  longest time between two samples to interpolate over [s]; None: see above
    """
    finite = np.isfinite(t) & np.isfinite(values)
    if not finite.any():
        return None
    if not finite.all():
        t, values = t[finite], values[finite]
    if longest_gap is None and len(t) == ticks and _one_for_each_tick(t, T):
        return Resampled(values, T, True)  # the usual case, with the least memory
    position = t / T
    nearest = np.round(position)
    at = (np.abs(position - nearest) <= AT_TICK) & (nearest >= 0) & (nearest < ticks)
    resampled = np.full(ticks, np.nan)
    resampled[nearest[at][::-1].astype(np.int64)] = values[at][::-1]  # of two samples, the first
    interval = float(np.median(np.diff(t))) if len(t) > 1 else T
    even = bool(abs(interval / T - 1) < AT_TICK and np.count_nonzero(at) > 0.99 * len(t))
    if longest_gap is None:
        longest_gap = 0.0 if even else _USUAL_INTERVALS * interval
    empty = np.flatnonzero(np.isnan(resampled))
    after = np.searchsorted(position, empty)
    inside = (after > 0) & (after < len(t))
    empty, after = empty[inside], after[inside]
    empty = empty[t[after] - t[after - 1] <= longest_gap * (1 + AT_TICK)]
    resampled[empty] = np.interp(empty.astype(np.float64), position, values)
    return Resampled(
        resampled,
        interval,
        even,
        interpolated=len(empty),
        between=int(np.count_nonzero(~at)),
        missing=len(finite) - len(t),
    )


def _one_for_each_tick(t: Array, T: float) -> bool:
    off = t / T
    off -= np.arange(len(t))
    return not np.any(np.abs(off, out=off) > AT_TICK)


def stretches(mask: ArrayLike) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Runs of true values: the first index of each run, and the index after its last index."""
    edges = np.diff(np.concatenate([[0], np.asarray(mask, dtype=np.int8), [0]]))
    return np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
