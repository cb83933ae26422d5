"""Gaussian elimination on expressions: a sparse linear system solved by straight-line code."""

from __future__ import annotations

import casadi as ca


class Elimination:
    """Factors of a square sparse matrix, and the solution of systems with it.

    Pivots are diagonal entries, in the order of the least possible fill-in (Markowitz), whatever
    their values: this suits the matrices s I - J of an implicit integration, where s is large.
    """

    def __init__(self, matrix: ca.SX) -> None:
        size = matrix.size1()
        self._rows: list[dict[int, ca.SX]] = [{} for _ in range(size)]
        for row, column in zip(*matrix.sparsity().get_triplet(), strict=True):
            self._rows[row][column] = matrix[row, column]
        self._order: list[int] = []
        rest = set(range(size))
        while rest:
            pivot = min(rest, key=lambda k: (self._fill_in(k, rest), k))
            rest.remove(pivot)
            self._order.append(pivot)
            self._eliminate(pivot, rest)

    def _fill_in(self, pivot: int, rest: set[int]) -> int:
        """Bound on the entries that become nonzero."""
        in_row = len(self._rows[pivot].keys() & rest)
        in_column = sum(pivot in self._rows[i] for i in rest)
        return (in_row - 1) * (in_column - 1)

    def _eliminate(self, pivot: int, rest: set[int]) -> None:
        """Keeps 1/pivot on the diagonal, and the multipliers below it."""
        row = self._rows[pivot]
        row[pivot] = 1 / row[pivot]
        for i in sorted(rest):
            if pivot in self._rows[i]:
                multiplier = self._rows[i][pivot] = self._rows[i][pivot] * row[pivot]
                for j in sorted(row.keys() & rest):
                    self._rows[i][j] = self._rows[i].get(j, 0) - multiplier * row[j]

    @property
    def factors(self) -> ca.SX:
        """All entries of the factors [size: k]."""
        return ca.vertcat(*(row[j] for row in self._rows for j in sorted(row)))

    def solve(self, factors: ca.SX, b: ca.SX) -> ca.SX:
        """Solution for the right-hand side b [size: n], with the entries given as `factors`."""
        entry = iter(ca.vertsplit(factors))
        rows = [{j: next(entry) for j in sorted(row)} for row in self._rows]
        x = ca.vertsplit(b)
        for k, pivot in enumerate(self._order):
            for i in self._order[k + 1 :]:
                if pivot in rows[i]:
                    x[i] -= rows[i][pivot] * x[pivot]
        for k, pivot in reversed(list(enumerate(self._order))):
            for j in self._order[k + 1 :]:
                if j in rows[pivot]:
                    x[pivot] -= rows[pivot][j] * x[j]
            x[pivot] *= rows[pivot][pivot]
        return ca.vertcat(*x)
