"""Least squares in the information form: what test_regression_oracle.py does not see.

All other numbers appear in outputs of ticks, which test_regression_oracle.py compares.
"""

from typing import Any

import numpy as np
import pytest

import oracle
from c_library import Array, Library
from c_regression import SIDES, factors


def information(c: Library, precision: float, rows: Array, y: Array) -> Any:
    """After samples of weight 1; the other side is y, too, with the other sign."""
    a = c.new("sh_information")
    c.lib.sh_information_start(a, rows.shape[1], precision)
    for row in np.column_stack([rows, -y, y]):
        c.lib.sh_information_take(a, c.pointer(row), 1.0)
    return a


def solve(c: Library, a: Any) -> Array:
    """The estimate, by y."""
    beta, per_gain, last = np.zeros(a.size), np.zeros(a.size), c.new("sh_last_row")
    last[0] = c.lib.sh_information_last(a)
    c.lib.sh_information_solve(a, last, c.pointer(beta), c.pointer(per_gain))
    return beta


@pytest.mark.parametrize("size", [1, 2, 3, 4, 5, 9, 31, 63])
def test_a_prediction_is_what_taking_gives_and_changes_nothing(c: Library, size: int) -> None:
    rng = np.random.default_rng(size)
    a = information(c, 1.0, rng.normal(size=(size + 2, size)), rng.normal(size=size + 2))
    before = bytes(c.ffi.buffer(a))
    predicted, taken = np.repeat(rng.normal(size=(1, size + SIDES)), 2, axis=0)
    weight = c.lib.sh_information_predict(a, c.pointer(predicted), 1.7)
    assert bytes(c.ffi.buffer(a)) == before
    assert weight == pytest.approx(c.lib.sh_information_take(a, c.pointer(taken), 1.7), rel=1e-12)
    assert predicted == pytest.approx(taken, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("distance", [1e-3, 1e-6, 1e-9, 1e-12, 0.0])
def test_columns_that_are_almost_equal(c: Library, distance: float) -> None:
    """GIVEN a column that is almost a sum of two others, THEN predictions, and with priors the
    parameters, are as good as in exact arithmetic: no pivot is a rounding error."""
    rng = np.random.default_rng(5)
    rows = rng.normal(size=(30, 4))
    rows[:, 3] = rows[:, 0] + rows[:, 1] + distance * rng.normal(size=30)
    y = rows @ np.array([1.0, -2.0, 3.0, 0.5]) + 0.1 * rng.normal(size=30)
    for precision, rel in ((1.0, 1e-9), (1e-9, 1e-3)):
        a = information(c, precision, rows, y)
        exact = oracle.exact(rows)
        matrix = exact.T @ exact + np.diag(oracle.exact([precision] * 4))
        want = oracle.rounded(oracle.solve(matrix, exact.T @ oracle.exact(y)[:, None]))[:, 0]
        assert rows @ solve(c, a) == pytest.approx(rows @ want, rel=rel, abs=rel)
        if precision == 1.0:
            assert solve(c, a) == pytest.approx(want, rel=rel)
        assert np.all(factors(a)[1] > 0)
