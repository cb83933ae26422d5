"""Stretches of ticks with values, and the gaps between them."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sigmahat.recording.log import Array

_LARGEST = 1e12  # SH_LARGEST_MEASUREMENT of sigmahat.h


def stretches(mask: ArrayLike) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Returns the first index of each run of true values, and the index after each run."""
    padded = np.zeros(np.size(mask) + 2, dtype=np.bool_)
    padded[1:-1] = mask
    edges = np.flatnonzero(padded[1:] != padded[:-1])
    return edges[::2], edges[1::2]


def refused(values: Array) -> NDArray[np.bool_]:
    """Marks ticks that the estimator skips because of the input values [size: ticks x ports]."""
    skipped = np.zeros(len(values), dtype=np.bool_)
    for column in values.T:  # one column at a time, to limit the memory
        skipped |= ~((column >= -_LARGEST) & (column <= _LARGEST))
    return skipped
