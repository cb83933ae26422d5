"""The posterior: choice of columns, compensation of rounding in the column of the inertia, gain."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from c_library import Array, Estimator, Library, load
from c_regression import PLAIN, SIDES, coefficients, dense, factors

PRIOR_B = 0.1
VALUES = {"method": 2, "rls.n": 2, "rls.m": 1, "rls.symmetric": 1, "prior.B": PRIOR_B, **PLAIN}
GAIN, Y = 0, 1
dF = np.array([30.0, -5.0, 0.0, 0.0, 0.0])  # slopes of the columns: two of the basis, the motor's


@pytest.fixture(scope="module")
def c(build: Path) -> Library:
    return load(build)


class Posterior:
    """A posterior of two columns of the torque and three of the motor, b the last one."""

    def __init__(self, c: Library, weight: float = 1.0) -> None:
        self.c, self.weight = c, weight
        self.estimator = Estimator(c, VALUES)
        self.regression = c.ffi.addressof(self.estimator.state.method, "regression")
        assert [kind for kind, _ in coefficients(self.estimator)] == [
            *("BASIS", "BASIS", "VISCOUS", "COULOMB", "INERTIA")
        ]
        self.size = 5
        self.c_struct = c.new("sh_posterior")
        c.lib.sh_posterior_start(
            self.regression, self.estimator.parameters, self.c_struct, 0, weight
        )
        for i, slope in enumerate(dF):
            self.regression.work.dF[i] = slope

    def take(self, row: Array, w: float) -> float:
        memory = np.zeros(self.size + SIDES)
        share: float = self.c.lib.sh_posterior_take(
            self.regression, self.c_struct, self.c.pointer(row), w, self.c.pointer(memory)
        )
        return share

    def remove(self, information: float) -> None:
        self.c.lib.sh_posterior_remove(self.c_struct, information, PRIOR_B)

    def evaluate(self) -> tuple[Array, Any]:
        fit = self.c.lib.sh_posterior_evaluate(self.regression, self.c_struct)
        return np.array(list(self.regression.beta[0 : self.size])), fit


def rows(seed: int, samples: int = 60) -> Array:
    """Regressors and sides [size: samples x 7]. The column of b is strong."""
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(samples, 5 + SIDES))
    x[:, 4] *= 3.0
    return x


def normal_equations(x: Array, w: Array, weight: float) -> tuple[Array, Array]:
    """Information with the prior 1, and right-hand sides."""
    A = np.eye(5) + weight * (x[:, :5].T * w) @ x[:, :5]
    return A, weight * (x[:, :5].T * w) @ x[:, 5:]


@pytest.mark.parametrize("weight", [1.0, 0.2])
def test_estimate_variance_and_gain_without_rounding(c: Library, weight: float) -> None:
    posterior = Posterior(c, weight)
    x, w = rows(1), np.random.default_rng(2).uniform(0.1, 2, 60)
    for k in range(60):
        A, _ = normal_equations(x[:k], w[:k], weight)
        rho = x[k, :5] @ np.linalg.inv(A) @ x[k, :5] * weight * w[k]
        assert posterior.take(x[k], w[k]) == pytest.approx(1 / (1 + rho), rel=1e-9)
    A, right = normal_equations(x, w, weight)
    beta, fit = posterior.evaluate()
    assert beta == pytest.approx(np.linalg.solve(A, right[:, Y]), rel=1e-9)
    assert fit.variance == pytest.approx(dF @ np.linalg.solve(A, dF), rel=1e-9)
    assert fit.by_gain == pytest.approx(dF @ np.linalg.solve(A, right[:, GAIN]), rel=1e-9)


def test_the_removal_subtracts_from_the_sum_of_squares(c: Library) -> None:
    """GIVEN N of the information about b that is rounding, THEN N (b + 1)^2 is subtracted from the
    sum of squares, where b has the unit of its prior."""
    posterior = Posterior(c)
    x, w = rows(3), np.ones(60)
    for row in x:
        posterior.take(row, 1.0)
    A, right = normal_equations(x, w, 1.0)
    N = 100.0
    posterior.remove(30.0)
    posterior.remove(70.0)
    A[4, 4] -= N
    right[4, Y] += N / PRIOR_B
    matrix, sides = dense(posterior.c_struct.information)
    assert matrix == pytest.approx(A, rel=1e-9)
    assert sides == pytest.approx(right, rel=1e-9)
    assert (posterior.c_struct.surplus, posterior.c_struct.removed) == (0.0, N)


def test_the_removal_leaves_the_prior(c: Library) -> None:
    posterior = Posterior(c)
    for row in rows(4, 10):
        posterior.take(row, 1.0)
    posterior.remove(1e9)
    _, D, _ = factors(posterior.c_struct.information)
    assert D[4] == pytest.approx(1.0, rel=1e-9)
    assert posterior.c_struct.surplus + posterior.c_struct.removed == pytest.approx(1e9)
    beta, _ = posterior.evaluate()
    assert beta[4] == pytest.approx(0.0, abs=1e-6)  # the data say nothing about b


def expected(x: Array, N: float, Q: float) -> tuple[Array, float, float]:
    """Estimate, variance, and effect of the gain by the formulas of posterior.h: b has the
    information I^2 / (I + N + Q), and the other parameters their distribution for a given b."""
    A, right = normal_equations(x, np.ones(len(x)), 1.0)
    A[4, 4] -= N
    right[4, Y] += N / PRIOR_B
    P = np.linalg.inv(A)
    information = 1 / P[4, 4] - 1
    b = (P @ right)[4] / P[4, 4] / information  # by the data alone, for both sides
    weighed = information**2 / (information + N + Q + (0.05 * N / PRIOR_B) ** 2)
    variance = 1 / (1 + weighed)
    mean = weighed * b * variance
    along = P[:, 4] / P[4, 4]
    beta = P @ right + np.outer(along, mean - (P @ right)[4])
    covariance = P + np.outer(along, along) * (variance - P[4, 4])
    return beta[:, Y], float(dF @ covariance @ dF), float(dF @ beta[:, GAIN])


@pytest.mark.parametrize("N", [1.0, 50.0, 300.0])
@pytest.mark.parametrize("Q", [0.0, 300.0])
def test_the_weight_of_the_inertia_after_the_removal(c: Library, N: float, Q: float) -> None:
    x = rows(5)
    posterior = Posterior(c)
    for row in x:
        posterior.take(row, 1.0)
    posterior.remove(N)
    posterior.c_struct.spread = Q
    before = factors(posterior.c_struct.information)
    want = expected(x, N, Q)
    for _ in range(2):  # to evaluate changes nothing
        beta, fit = posterior.evaluate()
        assert beta == pytest.approx(want[0], rel=1e-8)
        assert (fit.variance, fit.by_gain) == pytest.approx(want[1:], rel=1e-8)
    for part, other in zip(before, factors(posterior.c_struct.information), strict=True):
        assert np.array_equal(part, other)


def test_the_effect_of_the_gain_is_the_derivative_of_the_stiffness(c: Library) -> None:
    """Also with rounding removed, and with little information about b left."""
    x = rows(6)
    stiffness = []
    for gain in (0.0, 1.0):
        posterior = Posterior(c)
        for row in x:
            changed = row.copy()
            changed[-1] += gain * changed[-2]
            posterior.take(changed, 1.0)
        posterior.remove(300.0)
        posterior.c_struct.spread = 100.0
        beta, fit = posterior.evaluate()
        stiffness.append(dF @ beta)
    assert fit.by_gain == pytest.approx(stiffness[1] - stiffness[0], rel=1e-9)


@pytest.mark.parametrize("excitation", [0.01, 0.1, 1.0])
def test_the_error_of_the_inertia_agrees_with_its_variance(c: Library, excitation: float) -> None:
    """GIVEN a column of b with noise of variance V that is part of y, too, and b drawn from its
    prior, WHEN the excitation is strong, weak or very weak, THEN b is within 1.96 standard
    deviations in about 95 % of all runs, and its mean error is a small part of a standard
    deviation."""
    rng = np.random.default_rng(int(excitation * 100))
    V, samples = 0.5, 1000
    errors = []
    for _ in range(200):
        b = PRIOR_B * rng.normal()
        X = excitation * np.sin(0.05 * np.arange(samples) + rng.uniform(0, 6))
        noise = np.sqrt(V) * rng.normal(size=samples)
        y = (X + noise) - (1 + b) * X + np.sqrt(1 - V) * rng.normal(size=samples)
        posterior = Posterior(c)
        for i in range(5):
            posterior.regression.work.dF[i] = float(i == 4)
        row = np.zeros(5 + SIDES)
        for k in range(samples):
            row[0], row[4], row[-1] = 1.0, -PRIOR_B * (X[k] + noise[k]), y[k]
            posterior.take(row, 1.0)
        N = PRIOR_B**2 * V
        # of white noise: the variance of its square is 2 V^2
        posterior.c_struct.spread = samples * 2 * (N / PRIOR_B) ** 2
        posterior.remove(samples * N)
        beta, fit = posterior.evaluate()
        errors.append((beta[4] - b / PRIOR_B) / np.sqrt(fit.variance))
    assert 0.9 < np.mean(np.abs(errors) < 1.96) <= 1.0
    assert abs(np.mean(errors)) < 4 / np.sqrt(200)


def test_the_variance_of_the_removal_is_that_of_its_effect_on_the_inertia(c: Library) -> None:
    """Six times the sum of the squares of what was removed, over prior.B, for every sample."""
    t = 1e-3 * np.arange(1000)
    z = np.zeros((len(t), 5))
    z[:, 0] = z[:, 1] = np.round((1 - np.cos(9 * t)) * 40000) / 40000
    estimator = Estimator(c, VALUES)
    surplus = [0.0]
    for sample in z:
        estimator.tick(sample)
        surplus.append(estimator.state.method.regression.surplus)
    regression = estimator.state.method.regression
    assert regression.spread == pytest.approx(6 * np.sum((np.diff(surplus) / PRIOR_B) ** 2))
    assert regression.live.spread == pytest.approx(regression.spread)
    assert regression.variance_factor == 1.0
    removed = regression.live.surplus + regression.live.removed
    assert removed == pytest.approx(surplus[-1])


def test_a_trial_puts_its_group_behind_all_other_columns(c: Library) -> None:
    estimator = Estimator(c, {**VALUES, "prior.power": 1.0})
    regression = c.ffi.addressof(estimator.state.method, "regression")
    names = coefficients(estimator)
    posterior = c.new("sh_posterior")
    used: dict[tuple[int, int], list[str]] = {}
    for is_used in (0, 1):
        regression.used[1] = is_used  # the group of more powers
        for trial in (0, 1):
            c.lib.sh_posterior_start(regression, estimator.parameters, posterior, trial, 1.0)
            columns = list(posterior.column[0 : posterior.information.size])
            used[is_used, trial] = [names[i][0] for i in columns]
            motor = used[is_used, trial].index("INERTIA")
            assert posterior.inertia == motor
            assert used[is_used, trial][posterior.coulomb] == "COULOMB"
    always = ["BASIS", "BASIS", "VISCOUS", "COULOMB", "INERTIA"]
    assert used[0, 0] == always
    assert used[1, 0] == [*always[:2], "POWER", "POWER", *always[2:]]
    assert used[0, 1] == used[1, 1] == [*always, "POWER", "POWER"]


def test_the_variance_of_a_combination(c: Library) -> None:
    posterior = Posterior(c)
    x = rows(7)
    for row in x:
        posterior.take(row, 1.0)
    A, _ = normal_equations(x, np.ones(len(x)), 1.0)
    memory = np.zeros(5)
    for combination in (*np.eye(5), np.arange(1.0, 6.0)):
        variance = c.lib.sh_posterior_variance(
            posterior.c_struct, c.pointer(combination), c.pointer(memory)
        )
        assert variance == pytest.approx(combination @ np.linalg.solve(A, combination), rel=1e-9)
