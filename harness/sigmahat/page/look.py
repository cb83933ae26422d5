"""A preview of a column: its range, and a small line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sigmahat.logs.log import Array, Log, LogError

_BUCKETS = 80
WIDTH, HEIGHT = 160, 28
"""Size of the line."""


@dataclass(frozen=True)
class Look:
    """A preview of a column."""

    span: str
    """Least and greatest value, or why the column has no values."""
    line: Sequence[tuple[float, float]]
    """Points in a box of 160 x 28, from its upper left corner."""


def look(log: Log, name: str) -> Look:
    """The preview of a column of a log."""
    try:
        values = log.read(name)
    except LogError:
        return Look("text", ())
    finite = np.flatnonzero(np.isfinite(values))
    if not len(finite):
        return Look("no number", ())
    low, high = float(values[finite].min()), float(values[finite].max())
    return Look(f"{low:.5g} to {high:.5g}", _line(values, finite, low, high))


def _line(
    values: Array, finite: NDArray[np.intp], low: float, high: float
) -> Sequence[tuple[float, float]]:
    """The least and the greatest value of each bucket, in the order of the rows."""
    points = []
    for part in np.array_split(finite, min(_BUCKETS, len(finite))):
        own = values[part]
        for i in sorted({int(own.argmin()), int(own.argmax())}):
            x = WIDTH * part[i] / max(len(values) - 1, 1)
            y = (HEIGHT - 2) * (high - own[i]) / ((high - low) or 1.0) + 1
            points.append((round(float(x), 1), round(float(y), 1)))
    return points
