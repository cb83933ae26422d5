"""Least squares as dense matrices in extended precision: the other side of c/.../information.h.

The matrix of n columns and two right-hand sides is sum w r r' over rows r = (x, u, y).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Long = NDArray[np.longdouble]
SIDES = 2


def factors(matrix: Long, size: int) -> tuple[Long, Long, np.longdouble]:
    """Rows (U, U z) [size: size x size + 2], D, and the rest, by elimination."""
    left = matrix.copy()
    rows: Long = np.zeros((size, len(left)), dtype=np.longdouble)
    D: Long = np.zeros(size, dtype=np.longdouble)
    for i in range(size):
        D[i] = left[i, i]
        rows[i, i:] = left[i, i:] / D[i]
        left[i:, i:] -= D[i] * np.outer(rows[i, i:], rows[i, i:])
    return rows, D, left[-1, -1]


def inverse(matrix: Long) -> Long:
    """Inverse of a positive definite matrix."""
    size = len(matrix)
    both = np.hstack([matrix, np.eye(size, dtype=np.longdouble)])
    for i in range(size):
        both[i] /= both[i, i]
        factor = both[:, i].copy()
        factor[i] = 0
        both -= np.outer(factor, both[i])
    result: Long = both[:, size:]
    return result


class Information:
    """Sums over samples of `size` columns."""

    def __init__(self, size: int, precision: float) -> None:
        self.size, self.least = size, precision
        self.matrix: Long = np.zeros((size + SIDES, size + SIDES), dtype=np.longdouble)
        self.matrix[range(size), range(size)] = precision

    def take(self, row: Long, w: float | np.longdouble) -> None:
        self.matrix += w * np.outer(row, row)

    def fade(self, keep: float) -> None:
        """No entry of D falls below the precision of the start."""
        rows, D, rest = factors(self.matrix, self.size)
        D = np.maximum(D * keep, self.least)
        self.matrix = (rows.T * D) @ rows
        self.matrix[-1, -1] += rest * keep

    def walk(self, v: Long, c: float | np.longdouble) -> None:
        """Adds c v v' to the inverse."""
        g = self.matrix[:, : self.size] @ v
        self.matrix -= np.outer(g, g) * (c / (1 + c * (v @ g[: self.size])))

    def squares(self, beta: Long) -> float:
        """Weighted sum of squares of y - x' beta."""
        error = np.concatenate([beta, [0, -1]])
        return float(error @ self.matrix @ error)

    @property
    def rest(self) -> float:
        """Its least value."""
        return float(factors(self.matrix, self.size)[2])
