"""Limits of an axis that single values, far from all others, do not set."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_OUTER = 0.5
"""Percent of the values at either end."""
_FURTHER = 0.5
"""How much further than the others these are shown, over the range of the others."""


def limits(values: NDArray[Any]) -> tuple[float, float]:
    """Least and greatest of the values that are shown; (0, 1) if none is finite.

    The outermost percent, for example a spike after a gap, is cut off where it is far away.
    """
    finite = values[np.isfinite(values)]
    if not len(finite):
        return 0.0, 1.0
    low, high = np.percentile(finite, [_OUTER, 100 - _OUTER]).tolist()
    least, greatest = float(finite.min()), float(finite.max())
    if not high > low:
        return least, greatest
    further = _FURTHER * (high - low)
    return max(least, low - further), min(greatest, high + further)
