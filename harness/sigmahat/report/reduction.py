"""Fewer points of long signals that make the same picture, and every sample somewhere."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

BUDGET = 400_000
"""Values of all signals together; as 4 bytes in base64 they are 2 MB of a report."""
_MOST = 20_000
"""Values of a signal; a browser takes seconds to draw longer lines."""


@dataclass(frozen=True)
class Reduced:
    """Signals over common times."""

    t: NDArray[np.float64]
    signals: dict[str, NDArray[np.float32]]
    """Of the shape of t."""
    bucket: int
    """Samples of which the least and the greatest are kept; 1: every sample is there."""
    every: tuple[float, float]
    """Between these times every sample is there."""


def reduce(t: NDArray[Any], signals: Mapping[str, NDArray[Any]], budget: int = BUDGET) -> Reduced:
    """Keeps at most about budget values of all signals, and 20000 of each.

    Half of them are every sample around the middle, where single counts of an encoder show. The
    others are the least and the greatest value of each bucket, in the order of their times.
    t and the signals have the same shape (N,), N >= 1.
    """
    rows = min(max(budget // max(len(signals), 1), 8), _MOST)
    t = np.asarray(t, dtype=np.float64)
    if len(t) <= rows:
        whole = {name: np.asarray(s, dtype=np.float32) for name, s in signals.items()}
        return Reduced(t, whole, 1, (float(t[0]), float(t[-1])))
    first = (len(t) - rows // 2) // 2
    last = first + rows // 2
    bucket = -(-(len(t) - rows // 2) * 2 // (rows - rows // 2))
    parts = [_starts(0, first, bucket), _starts(last, len(t), bucket)]
    times = [_twice(t, starts) for starts in parts]
    reduced = {}
    for name, values in signals.items():
        x = np.asarray(values, dtype=np.float32)
        before, after = (
            _extremes(x, starts, end) for starts, end in zip(parts, (first, len(t)), strict=True)
        )
        reduced[name] = np.concatenate([before, x[first:last], after])
    common = np.concatenate([times[0], t[first:last], times[1]])
    return Reduced(common, reduced, bucket, (float(t[first]), float(t[last - 1])))


def _starts(first: int, end: int, bucket: int) -> NDArray[np.intp]:
    return np.arange(first, end, bucket)


def _twice(t: NDArray[np.float64], starts: NDArray[np.intp]) -> NDArray[np.float64]:
    """Two times in each bucket: its start, and half way to the next."""
    ends = np.append(t[starts[1:]], t[min(starts[-1] + 1, len(t) - 1)]) if len(starts) else starts
    return np.column_stack([t[starts], (t[starts] + ends) / 2]).ravel()


def _extremes(x: NDArray[np.float32], starts: NDArray[np.intp], end: int) -> NDArray[np.float32]:
    """Least and greatest of x from each start to the next, the earlier of the two first."""
    bucket = int(starts[1] - starts[0]) if len(starts) > 1 else end - int(starts[0])
    padded = np.full(len(starts) * bucket, np.nan, dtype=np.float32)
    padded[: end - starts[0]] = x[starts[0] : end]
    table = padded.reshape(len(starts), bucket)
    empty = np.isnan(table).all(axis=1)
    low = np.where(np.isnan(table), np.inf, table).argmin(axis=1)
    high = np.where(np.isnan(table), -np.inf, table).argmax(axis=1)
    order = np.column_stack([np.minimum(low, high), np.maximum(low, high)])
    values = np.take_along_axis(table, order, axis=1)
    values[empty] = np.nan
    flat: NDArray[np.float32] = values.ravel()
    return flat
