"""Least squares in the information form, against dense matrices."""

from __future__ import annotations

import numpy as np
import pytest

import oracle
from c_library import Array, Library
from c_regression import SIDES, dense, factors

SIZES = [1, 2, 3, 4, 5, 9, 31, 63]
Y = 1  # the side of y


class Information:
    """The C struct, and the same as dense matrices."""

    def __init__(self, c: Library, size: int, precision: float = 1.0) -> None:
        self.c, self.size = c, size
        self.a = c.new("sh_information")
        c.lib.sh_information_start(self.a, size, precision)
        self.matrix = precision * np.eye(size)
        self.right = np.zeros((size, SIDES))
        self.squares = 0.0  # sum of w y^2

    def take(self, x: Array, sides: Array, w: float) -> tuple[float, float]:
        """Returned weight, and the prediction error of y that remains in the row."""
        row = np.append(x, sides)
        returned = self.c.lib.sh_information_take(self.a, self.c.pointer(row), w)
        self.matrix += w * np.outer(x, x)
        self.right += w * np.outer(x, sides)
        self.squares += w * sides[Y] ** 2
        return returned, row[-1]

    def fill(self, rng: np.random.Generator, samples: int) -> None:
        for _ in range(samples):
            x, sides = rng.normal(size=self.size), rng.normal(size=SIDES)
            self.take(x, sides, rng.uniform(0.1, 3.0))

    def solve(self, side: int) -> Array:
        """The estimate for a side."""
        beta, last = np.zeros(self.size), self.c.new("sh_last_row")
        last[0] = self.c.lib.sh_information_last(self.a)
        if side == Y:
            self.c.lib.sh_information_solve(self.a, last, self.c.pointer(beta))
            return beta
        of_each = []
        for unit in np.eye(self.size):
            twice = 2 * unit
            first, second = self.c.pointer(unit), self.c.pointer(twice)
            found = self.c.lib.sh_information_combine(self.a, last, first, second)
            of_each.append(found.first.value[side])
            assert found.second.value[side] == pytest.approx(2 * of_each[-1])
        return np.array(of_each)

    def check(self, rel: float = 1e-9) -> None:
        """The factors multiply to the dense matrices."""
        matrix, right = dense(self.a)
        assert matrix == pytest.approx(self.matrix, rel=rel, abs=rel * np.max(abs(self.matrix)))
        assert right == pytest.approx(self.right, rel=rel, abs=rel * np.max(abs(self.right)))
        assert np.all(factors(self.a)[1] > 0)


@pytest.mark.parametrize("size", SIZES)
def test_samples_add_to_the_information(c: Library, size: int) -> None:
    rng = np.random.default_rng(size)
    a = Information(c, size, 0.5)
    for _ in range(2 * size + 3):
        x, sides, w = rng.normal(size=size), rng.normal(size=SIDES), rng.uniform(0, 3)
        inverse = np.linalg.inv(a.matrix)
        rho = x @ inverse @ x
        error = sides[Y] - x @ inverse @ a.right[:, Y]
        assert a.take(x, sides, w) == pytest.approx((w / (1 + w * rho), error), rel=1e-8)
    a.check()
    for side in range(SIDES):
        want = np.linalg.solve(a.matrix, a.right[:, side])
        assert a.solve(side) == pytest.approx(want, rel=1e-8, abs=1e-10)


@pytest.mark.parametrize("size", SIZES)
def test_a_negative_weight_removes_a_sample(c: Library, size: int) -> None:
    rng = np.random.default_rng(size)
    a = Information(c, size)
    a.fill(rng, 2 * size)
    matrix, squares = a.matrix.copy(), a.a.squares
    x, sides = rng.normal(size=size), rng.normal(size=SIDES)
    a.take(x, sides, 2.0)
    rho = x @ np.linalg.inv(a.matrix) @ x
    returned, _ = a.take(x, sides, -2.0)
    assert returned == pytest.approx(-2.0 / (1 - 2.0 * rho), rel=1e-8)
    assert a.matrix == pytest.approx(matrix)
    a.check()
    assert a.a.squares == pytest.approx(squares, rel=1e-8)


@pytest.mark.parametrize("size", SIZES)
def test_the_squares_are_those_of_all_samples_and_of_the_start(c: Library, size: int) -> None:
    rng = np.random.default_rng(size)
    a = Information(c, size, 0.3)
    a.fill(rng, size + 5)
    beta = rng.normal(size=size)
    want = a.squares - 2 * beta @ a.right[:, Y] + beta @ a.matrix @ beta
    assert c.lib.sh_information_squares(a.a, c.pointer(beta)) == pytest.approx(want, rel=1e-9)
    best = a.solve(Y)
    least = a.squares - a.right[:, Y] @ best
    assert a.a.squares == pytest.approx(least, rel=1e-8)
    assert c.lib.sh_information_squares(a.a, c.pointer(best)) == pytest.approx(
        a.a.squares, rel=1e-9
    )


def test_fading_scales_all_weights(c: Library) -> None:
    a = Information(c, 5, 1e-9)
    a.fill(np.random.default_rng(2), 20)
    estimate, rest = a.solve(Y), a.a.squares
    c.lib.sh_information_forget(a.a, 0.25, 1e-9)
    a.matrix *= 0.25
    a.right *= 0.25
    a.check()
    assert a.a.squares == pytest.approx(0.25 * rest)
    assert a.solve(Y) == pytest.approx(estimate, rel=1e-12)


def test_fading_keeps_the_least_precision(c: Library) -> None:
    a = Information(c, 5)
    a.fill(np.random.default_rng(3), 20)
    for _ in range(100):
        c.lib.sh_information_forget(a.a, 0.5, 1.0)
    assert factors(a.a)[1].tolist() == [1.0] * 5


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("variance", [0.0, 1e-6, 0.3, 1e6])
def test_process_noise_adds_to_the_covariance_and_keeps_the_estimate(
    c: Library, size: int, variance: float
) -> None:
    rng = np.random.default_rng(size)
    a = Information(c, size)
    a.fill(rng, 2 * size)
    estimate = [a.solve(side) for side in range(SIDES)]
    v = rng.normal(size=size)
    want = np.linalg.inv(a.matrix) + variance * np.outer(v, v)
    # The information along v that is left is this number of times smaller than before.
    lost = 1 + variance * float(v @ a.matrix @ v)
    rel, rest = 1e-8 + 1e-14 * lost, a.a.squares
    c.lib.sh_information_drift(a.a, c.pointer(v), variance)
    matrix, _ = dense(a.a)
    assert np.linalg.inv(matrix) == pytest.approx(want, abs=rel * np.max(abs(want)))
    assert np.all(factors(a.a)[1] > 0)
    for side in range(SIDES):
        assert a.solve(side) == pytest.approx(estimate[side], abs=rel)
    assert a.a.squares == pytest.approx(rest, rel=rel)


@pytest.mark.parametrize("distance", [1e-3, 1e-6, 1e-9, 1e-12, 0.0])
def test_columns_that_are_almost_equal(c: Library, distance: float) -> None:
    """GIVEN a column that two others almost make up, THEN predictions are as good as with exact
    arithmetic, and with priors so are the parameters: no pivot consists of rounding errors."""
    rng = np.random.default_rng(5)
    rows = rng.normal(size=(30, 4))
    rows[:, 3] = rows[:, 0] + rows[:, 1] + distance * rng.normal(size=30)
    y = rows @ np.array([1.0, -2.0, 3.0, 0.5]) + 0.1 * rng.normal(size=30)
    for precision, rel in ((1.0, 1e-9), (1e-9, 1e-3)):
        a = Information(c, 4, precision)
        for x, value in zip(rows, y, strict=True):
            a.take(x, np.array([0.0, value]), 1.0)
        exact = oracle.exact(rows)
        matrix = exact.T @ exact + np.diag(oracle.exact([precision] * 4))
        want = oracle.rounded(oracle.solve(matrix, exact.T @ oracle.exact(y)[:, None]))[:, 0]
        assert rows @ a.solve(Y) == pytest.approx(rows @ want, rel=rel, abs=rel)
        if precision == 1.0:
            assert a.solve(Y) == pytest.approx(want, rel=rel)
        assert np.all(factors(a.a)[1] > 0)
