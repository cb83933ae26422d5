"""Least squares in the information form, against dense matrices in extended precision."""

import numpy as np
import pytest

import dense_regression
import oracle
from c_library import Array, Library
from c_regression import SIDES, dense, factors

SIZES = [1, 2, 3, 4, 5, 9, 31, 63]
Y = 1  # the side of y
each_size = pytest.mark.parametrize("size", SIZES)


class Information:
    """The C struct, and the same information as a dense matrix."""

    def __init__(self, c: Library, size: int, precision: float = 1.0) -> None:
        self.c, self.size = c, size
        self.a = c.new("sh_information")
        c.lib.sh_information_start(self.a, size, precision)
        self.want = dense_regression.Information(size, precision)

    @property
    def matrix(self) -> Array:
        return self.want.matrix[: self.size, : self.size].astype(float)

    def take(self, row: Array, w: float) -> tuple[float, float]:
        """Takes a row (x, sides). Returned weight, and prediction error of y left in the row."""
        left = row.copy()
        returned = self.c.lib.sh_information_take(self.a, self.c.pointer(left), w)
        self.want.take(row.astype(np.longdouble), w)
        return returned, left[-1]

    def fill(self, rng: np.random.Generator, samples: int) -> None:
        for _ in range(samples):
            self.take(rng.normal(size=self.size + SIDES), rng.uniform(0.1, 3.0))

    def solve(self, side: int) -> Array:
        """The estimate for a side."""
        beta, per_gain, last = np.zeros(self.size), np.zeros(self.size), self.c.new("sh_last_row")
        last[0] = self.c.lib.sh_information_last(self.a)
        both = (self.c.pointer(beta), self.c.pointer(per_gain))
        self.c.lib.sh_information_solve(self.a, last, *both)
        return beta if side == Y else per_gain

    def check(self, rel: float = 1e-9) -> None:
        """The factors multiply to the dense matrix, and its least sum of squares is left."""
        n = self.size
        found, want = np.hstack(dense(self.a)), self.want.matrix[:n].astype(float)
        assert found == pytest.approx(want, rel=rel, abs=rel * float(np.max(abs(want[:, :n]))))
        assert np.all(factors(self.a)[1] > 0)
        assert self.a.squares == pytest.approx(float(self.want.rest), rel=1e-8)


@each_size
def test_samples_add_to_the_information(c: Library, size: int) -> None:
    rng = np.random.default_rng(size)
    a = Information(c, size, 0.5)
    for _ in range(2 * size + 3):
        row, w = rng.normal(size=size + SIDES), rng.uniform(0, 3)
        x, inverse = row[:size], np.linalg.inv(a.matrix)
        error = row[-1] - x @ inverse @ a.want.matrix[:size, -1].astype(float)
        rho = x @ inverse @ x
        assert a.take(row, w) == pytest.approx((w / (1 + w * rho), error), rel=1e-8)
    a.check()
    for side in range(SIDES):
        right = a.want.matrix[:size, size + side].astype(float)
        want = np.linalg.solve(a.matrix, right)
        assert a.solve(side) == pytest.approx(want, rel=1e-8, abs=1e-10)
    for beta in (rng.normal(size=size), a.solve(Y)):
        found = c.lib.sh_information_squares(a.a, c.pointer(beta))
        assert found == pytest.approx(a.want.squares(beta.astype(np.longdouble)), rel=1e-9)


@each_size
def test_a_prediction_changes_nothing(c: Library, size: int) -> None:
    rng = np.random.default_rng(size)
    a = Information(c, size)
    a.fill(rng, size + 2)
    before = bytes(c.ffi.buffer(a.a))
    predicted, taken = np.repeat(rng.normal(size=(1, size + SIDES)), 2, axis=0)
    weight = c.lib.sh_information_predict(a.a, c.pointer(predicted), 1.7)
    assert bytes(c.ffi.buffer(a.a)) == before
    assert weight == pytest.approx(c.lib.sh_information_take(a.a, c.pointer(taken), 1.7), rel=1e-12)
    assert predicted == pytest.approx(taken, rel=1e-9, abs=1e-12)


@each_size
def test_a_negative_weight_removes_a_sample(c: Library, size: int) -> None:
    rng = np.random.default_rng(size)
    a = Information(c, size)
    a.fill(rng, 2 * size)
    row = rng.normal(size=size + SIDES)
    a.take(row, 2.0)
    rho = row[:size] @ np.linalg.inv(a.matrix) @ row[:size]
    returned, _ = a.take(row, -2.0)
    assert returned == pytest.approx(-2.0 / (1 - 2.0 * rho), rel=1e-8)
    a.check()


def test_fading_keeps_the_least_precision(c: Library) -> None:
    a = Information(c, 5)
    a.fill(np.random.default_rng(3), 20)
    rest = a.a.squares
    for _ in range(100):
        c.lib.sh_information_forget(a.a, 0.5, 1.0)
    assert factors(a.a)[1].tolist() == [1.0] * 5
    assert a.a.squares == pytest.approx(rest * 0.5**100)


@pytest.mark.parametrize("distance", [1e-3, 1e-6, 1e-9, 1e-12, 0.0])
def test_columns_that_are_almost_equal(c: Library, distance: float) -> None:
    """GIVEN a column that is almost a sum of two others, THEN predictions, and with priors the
    parameters, are as good as in exact arithmetic: no pivot is a rounding error."""
    rng = np.random.default_rng(5)
    rows = rng.normal(size=(30, 4))
    rows[:, 3] = rows[:, 0] + rows[:, 1] + distance * rng.normal(size=30)
    y = rows @ np.array([1.0, -2.0, 3.0, 0.5]) + 0.1 * rng.normal(size=30)
    for precision, rel in ((1.0, 1e-9), (1e-9, 1e-3)):
        a = Information(c, 4, precision)
        for x, value in zip(rows, y, strict=True):
            a.take(np.append(x, [0.0, value]), 1.0)
        exact = oracle.exact(rows)
        matrix = exact.T @ exact + np.diag(oracle.exact([precision] * 4))
        want = oracle.rounded(oracle.solve(matrix, exact.T @ oracle.exact(y)[:, None]))[:, 0]
        assert rows @ a.solve(Y) == pytest.approx(rows @ want, rel=rel, abs=rel)
        if precision == 1.0:
            assert a.solve(Y) == pytest.approx(want, rel=rel)
        assert np.all(factors(a.a)[1] > 0)
