"""Bias compensation for a parameter whose regressor is noisy, and the variance that results."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from c_library import Array, Library, load

AT = 1


@pytest.fixture(scope="module")
def c(build: Path) -> Library:
    return load(build)


def start(c: Library, prior: Array) -> Any:
    rls = c.new("sh_least_squares")
    c.lib.sh_least_squares_start(rls, len(prior), c.ffi.NULL, 1.0)
    for i, variance in enumerate(prior):
        c.lib.sh_ud_factor_set_variance(c.ffi.addressof(rls, "P"), i, variance)
    return rls


def weigh(c: Library, rls: Any, w: float, F: Array, y: float) -> None:
    assert c.lib.sh_least_squares_weigh(rls, w, c.pointer(F), y, c.new("sh_innovation"))


def covariance(c: Library, rls: Any) -> Array:
    P, at = c.ffi.addressof(rls, "P"), c.lib.sh_ud_factor_entry
    return np.array([[at(P, i, j) for j in range(P.size)] for i in range(P.size)])


def test_the_compensation_subtracts_from_the_sum_of_squares(c: Library) -> None:
    rng = np.random.default_rng(1)
    prior = np.array([4.0, 0.01, 2.0])
    F, y = rng.normal(size=(50, 3)), rng.normal(size=50)
    rls = start(c, prior)
    for k in range(50):
        weigh(c, rls, 1.0, F[k].copy(), y[k])
    bias = c.new("sh_rounding_bias", surplus=20.0)
    c.lib.sh_rounding_bias_remove(bias, rls, AT, prior[AT])
    # minimum of |eta|^2 / prior + sum (y - F' eta)^2 - 20 (1 + b)^2
    unit = np.eye(3)[AT]
    information = np.diag(1 / prior) + F.T @ F - 20 * np.outer(unit, unit)
    want = np.linalg.solve(information, F.T @ y + 20 * unit)
    assert (bias.surplus, bias.removed) == (0.0, 20.0)
    assert np.allclose(covariance(c, rls), np.linalg.inv(information), rtol=1e-9)
    assert np.allclose(list(rls.eta)[:3], want, rtol=1e-9)


def test_no_variance_becomes_larger_than_the_prior(c: Library) -> None:
    prior = np.array([4.0, 0.01])
    rls = start(c, prior)
    weigh(c, rls, 1.0, np.array([1.0, 3.0]), 0.5)
    bias = c.new("sh_rounding_bias", surplus=1e6)
    c.lib.sh_rounding_bias_remove(bias, rls, AT, prior[AT])
    assert covariance(c, rls)[AT, AT] == pytest.approx(prior[AT], rel=1e-9)
    assert np.all(np.linalg.eigvalsh(covariance(c, rls)) > 0)
    assert bias.surplus + bias.removed == pytest.approx(1e6)


def test_a_parameter_without_prior_variance_stays_zero(c: Library) -> None:
    rls = start(c, np.array([1.0, 0.0]))
    weigh(c, rls, 1.0, np.array([1.0, 3.0]), 0.5)
    bias = c.new("sh_rounding_bias", surplus=3.0)
    c.lib.sh_rounding_bias_remove(bias, rls, AT, 1e-300)
    eta, dF = np.zeros(2), np.array([0.0, 1.0])
    got = c.lib.sh_rounding_bias_estimate(bias, rls, AT, 1e-300, c.pointer(dF), c.pointer(eta))
    assert (got, eta[AT], bias.removed) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("excitation", [0.01, 0.1, 1.0])
def test_the_error_agrees_with_the_variance(c: Library, excitation: float) -> None:
    """GIVEN a column x with noise of variance V that is part of y, too, and b drawn from its prior,
    WHEN the excitation is strong, weak or very weak, THEN b is within 1.96 standard deviations in
    about 95 % of all runs, and its mean error is a small part of a standard deviation."""
    rng = np.random.default_rng(int(excitation * 100))
    V, samples, prior = 0.5, 1000, np.array([1.0, 0.01])
    errors = []
    for _ in range(300):
        b = 0.1 * rng.normal()
        x = excitation * np.sin(0.05 * np.arange(samples) + rng.uniform(0, 6))
        noise = np.sqrt(V) * rng.normal(size=samples)
        # y with the nominal parameter (x + noise) minus the true torque; see matched_regression.h
        y = (x + noise) - (1 + b) * x + np.sqrt(1 - V) * rng.normal(size=samples)
        rls = start(c, prior)
        bias = c.new("sh_rounding_bias")
        for k in range(samples):
            weigh(c, rls, 1.0, np.array([1.0, -(x[k] + noise[k])]), y[k])
            bias.surplus += V
            c.lib.sh_rounding_bias_remove(bias, rls, AT, prior[AT])
        eta, dF = np.zeros(2), np.array([0.0, 1.0])
        variance = c.lib.sh_rounding_bias_estimate(
            bias, rls, AT, prior[AT], c.pointer(dF), c.pointer(eta)
        )
        errors.append((eta[AT] - b) / np.sqrt(variance))
    assert 0.9 < np.mean(np.abs(errors) < 1.96) <= 1.0
    assert abs(np.mean(errors)) < 4 / np.sqrt(300)
