"""Encoders round to counts. They count on past a full turn, so nothing wraps."""

from __future__ import annotations

import math

import numpy as np

from rivals.records import Array


def count(counts: int) -> float:
    """The angle of one count [rad]."""
    return 2 * math.pi / counts


def rounded(angle: Array, counts: int) -> Array:
    """What an encoder with this number of counts a turn reads [rad]."""
    read: Array = np.round(angle / count(counts)) * count(counts)
    return read
