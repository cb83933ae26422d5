"""The state of FilteredRegression in C as dense numpy arrays."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from c_library import Array, Estimator
from misfit_priors import WITHOUT_MISFITS

SIDES = 2


def factors(a: Any) -> tuple[Array, Array, Array]:
    """U, D and right-hand sides z of a `sh_information` of n parameters [size: n x n, n, n x 2]."""
    n = a.size
    U, z = np.eye(n), np.zeros((n, SIDES))
    at = 0
    for i in range(n):
        others = n - 1 - i
        row = np.array(list(a.U[at : at + others + SIDES]))
        U[i, i + 1 :], z[i] = row[:others], row[others:]
        at += others + SIDES
    return U, np.array(list(a.D)[:n]), z


def dense(a: Any) -> tuple[Array, Array]:
    """Information matrix sum w x x', and sum w x y for both sides [size: n x n, n x 2]."""
    U, D, z = factors(a)
    return (U.T * D) @ U, (U.T * D) @ z


def covariance(estimator: Estimator) -> Array:
    """Covariance of the posterior, with prior variances of 1, in the order of `live.column`."""
    matrix, _ = dense(estimator.state.method.regression.live.information)
    return np.asarray(np.linalg.inv(matrix), dtype=np.float64)


def coefficients(estimator: Estimator) -> list[tuple[str, int]]:
    """Kind and number of each column, as in the oracle: 'BASIS', 0."""
    names = {
        getattr(estimator.library.lib, name): name.removeprefix("SH_COLUMN_")
        for name in dir(estimator.library.lib)
        if name.startswith("SH_COLUMN_")
    }
    regression = estimator.state.method.regression
    n, orders = estimator.parameters.rls.n, len(estimator.estimate.eta[0])
    return [
        numbered(names[column.kind], column.index // orders, column.index % orders, n)
        for column in regression.column[0 : regression.size]
    ]


def numbered(kind: str, i: int, j: int, n: int) -> tuple[str, int]:
    """Kind and number of a column whose index stands for the coefficient eta[i][j]."""
    width = re.fullmatch(r"(GAP|PLAY)_(\d)", kind)
    if width is not None:
        return width[1], int(width[2]) - 1
    number = {"BASIS": j * n + i, "POWER": i - n, "DAMPING": j}
    return kind, number.get(kind, 0)


# Priors of all that a joint has besides the model; 0 removes their columns.
PLAIN = {"prior.torque_gain": 0.0, **WITHOUT_MISFITS}
