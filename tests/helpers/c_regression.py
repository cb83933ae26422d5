"""The state of FilteredRegression in C as numpy arrays."""

from typing import Any

import numpy as np

from c_library import Array, Estimator

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


def covariance(estimator: Estimator) -> Array:
    """Covariance of the posterior, with prior variances of 1, in its own order."""
    U, D, _ = factors(estimator.state.method.regression.posterior.information)
    return np.asarray(np.linalg.inv((U.T * D) @ U), dtype=np.float64)


def kinds(estimator: Estimator) -> list[str]:
    """Kind of each column, as in the oracle: 'POWER'."""
    names = {
        getattr(estimator.library.lib, name): name.removeprefix("SH_COLUMN_")
        for name in dir(estimator.library.lib)
        if name.startswith("SH_COLUMN_")
    }
    columns = estimator.state.method.regression.columns
    return [names[column.kind] for column in columns.column[0 : columns.size]]
