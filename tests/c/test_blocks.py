"""Blocks: their variance is that of the noise, and the misfit is measured by it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from c_library import Array, Estimator, Library, load
from c_regression import PLAIN, dense
from dense_regression import window

VALUES = {
    **{"method": 2, "rls.n": 1, "rls.m": 1, **PLAIN},
    **{"prior.D_theta": 0.0, "prior.tau_coulomb": 0.0},
}
GAMMA, B, D, T = 50.0, 2.3e-5, 1e-3, 1e-3
LENGTH = 50


@pytest.fixture(scope="module")
def c(build: Path) -> Library:
    return load(build)


def regression_of(estimator: Estimator) -> Any:
    return estimator.library.ffi.addressof(estimator.state.method, "regression")


def chi_square(estimator: Estimator) -> float:
    """Mean square of the blocks of y over their variances."""
    library, blocks = estimator.library, regression_of(estimator).blocks
    zero, information = np.zeros(blocks.all.size), library.ffi.addressof(blocks, "all")
    squares = library.lib.sh_information_squares(information, library.pointer(zero))
    return float(squares / blocks.count)


@pytest.mark.parametrize("bandwidth", [50.0, 350.0, 1500.0])
@pytest.mark.parametrize("modality", [1, 2])
def test_the_variance_of_a_block_is_that_of_the_noise_of_the_torque(
    c: Library, bandwidth: float, modality: int
) -> None:
    """GIVEN white noise of the torque and nothing else, THEN the blocks' mean square over their
    variance is 1 within chance."""
    rng = np.random.default_rng(1)
    z = np.zeros((30_000, 5))
    z[:, 3] = 0.01 * rng.normal(size=len(z))
    z[:, 4] = 0.3 * rng.normal(size=len(z))
    values = {"noise.tau": 0.01, "noise.tau_e": 0.3, "modality": modality, "encoder.theta": 0.0}
    estimator = Estimator(c, {**VALUES, **values, "regression.bandwidth": bandwidth})
    estimator.run(z)
    N = regression_of(estimator).blocks.count
    assert pytest.approx(600, rel=0.02) == N
    assert abs(chi_square(estimator) - 1) < 3 * np.sqrt(2 / N)


def turning(seed: int) -> tuple[Array, Array, Array]:
    """Position, velocity and acceleration of a motor that does not repeat its motion."""
    rng = np.random.default_rng(seed)
    t = T * np.arange(30_000)
    theta, first, second = np.zeros((3, len(t)))
    for _ in range(8):
        w, phase = 2 * np.pi * rng.uniform(0.2, 1.5), rng.uniform(0, 6)
        size = rng.uniform(0.2, 1.0) / w
        theta += size * (np.sin(w * t + phase) - np.sin(phase))
        first += size * w * np.cos(w * t + phase)
        second -= size * w**2 * np.sin(w * t + phase)
    return theta, first, second


@pytest.mark.parametrize("noise", [1e-3, 4e-3])
@pytest.mark.parametrize("counts", [10000.0, 40000.0])
def test_the_variance_of_a_block_contains_the_rounding_of_theta(
    c: Library, noise: float, counts: float
) -> None:
    theta, first, second = turning(3)  # mostly fast enough that rounding is white
    count = 2 * np.pi / counts
    z = np.zeros((len(theta), 5))
    z[:, 0] = z[:, 1] = np.round(theta / count) * count
    z[:, 3] = GAMMA * (B * second + D * first)
    z[:, 3] += noise * np.random.default_rng(2).normal(size=len(z))
    values = {"noise.tau": noise, "encoder.theta": counts, "encoder.q": counts}
    estimator = Estimator(c, {**VALUES, **values})
    estimator.run(z)
    assert 0.75 < chi_square(estimator) < 1.25


def fill(estimator: Estimator, blocks: int, y: float, last: float) -> None:
    regression = regression_of(estimator)
    row = np.zeros(regression.size + 2)
    row[-1] = y
    for _ in range(blocks * LENGTH):
        estimator.library.lib.sh_blocks_take(
            regression, estimator.parameters, estimator.library.pointer(row), 4.0, last
        )


def test_the_row_of_a_block_is_its_weighted_mean(c: Library) -> None:
    rng = np.random.default_rng(4)
    estimator = Estimator(c, VALUES)
    regression = regression_of(estimator)
    assert regression.blocks.length == LENGTH
    x, w = rng.normal(size=(LENGTH, regression.size + 2)), rng.uniform(0.5, 2, LENGTH)
    for k in range(LENGTH):
        assert regression.blocks.count == 0.0
        row = x[k].copy()
        c.lib.sh_blocks_take(regression, estimator.parameters, c.pointer(row), w[k], 1.0)
    h = window(np.arange(LENGTH), LENGTH)
    mean = (h * w) @ x / (h @ w)
    # no rounding, as theta has not moved
    variance = (h**2 @ w) / (h @ w) ** 2 * regression.blocks.energy
    matrix, right = dense(regression.blocks.all)
    n = regression.size
    assert matrix == pytest.approx(np.outer(mean[:n], mean[:n]) / variance, rel=1e-6)
    assert right == pytest.approx(np.outer(mean[:n], mean[n:]) / variance, rel=1e-6)
    assert regression.blocks.count == pytest.approx(1.0)


def test_samples_with_the_same_error_count_as_fewer_blocks(c: Library) -> None:
    estimator = Estimator(c, VALUES)
    fill(estimator, 10, 1.0, 4.0)
    assert regression_of(estimator).blocks.count == pytest.approx(2.5)
    assert regression_of(estimator).blocks.recent_count == pytest.approx(2.5)


def test_a_gap_ends_the_present_block(c: Library) -> None:
    estimator = Estimator(c, VALUES)
    regression = regression_of(estimator)
    fill(estimator, 1, 1.0, 1.0)
    row = np.zeros(regression.size + 2)
    c.lib.sh_blocks_take(regression, estimator.parameters, c.pointer(row), 1.0, 1.0)
    assert regression.blocks.samples == 1
    c.lib.sh_blocks_interrupt(c.ffi.addressof(regression, "blocks"), regression.size)
    assert regression.blocks.samples == 0
    fill(estimator, 1, 1.0, 1.0)
    assert regression.blocks.count == pytest.approx(2.0)


def test_no_more_than_the_last_minutes_are_remembered(c: Library) -> None:
    estimator = Estimator(c, VALUES)
    fill(estimator, 1990, 0.0, 1.0)
    assert regression_of(estimator).blocks.count == pytest.approx(1990)
    fill(estimator, 20, 0.0, 1.0)
    assert regression_of(estimator).blocks.count == pytest.approx(2000)


@pytest.mark.parametrize("N", [20.0, 100.0, 2000.0])
def test_the_threshold_is_three_standard_deviations_of_chance(c: Library, N: float) -> None:
    assert c.lib.sh_blocks_threshold(N) == pytest.approx(N * (1 + 3 * np.sqrt(2 / N)))


@pytest.mark.parametrize("memory", [0.0, 20.0])
def test_the_factor_of_the_variances(c: Library, memory: float) -> None:
    """1 for too few blocks or without a misfit; else as if five blocks were one."""
    for blocks, q in ((19, 9.0), (40, 0.5), (40, 1.5), (40, 9.0), (400, 9.0)):
        estimator = Estimator(c, {**VALUES, "regression.memory": memory})
        regression = regression_of(estimator)
        h = window(np.arange(LENGTH), LENGTH)
        variance = np.sum(h**2) / np.sum(h) ** 2 / 4.0 * regression.blocks.energy
        fill(estimator, blocks, np.sqrt(q * variance), 1.0)
        c.lib.sh_blocks_judge(regression, estimator.parameters)
        if blocks < 20:
            assert (regression.q, regression.variance_factor) == (1.0, 1.0)
            continue
        measured = q * blocks / (blocks - 1)  # one column, which has no data
        assert regression.q == pytest.approx(measured, rel=0.03)
        t = 1 + 3 * np.sqrt(2 / blocks)
        want = max(1.0, regression.q)
        if regression.q > t:
            want = max(want, 1 + (regression.q - t) * max(1, blocks / 5))
        assert regression.variance_factor == pytest.approx(want if memory else 1.0, rel=0.2)
