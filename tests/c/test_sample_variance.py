"""Variance of a sample: noise of the torque, rounding, friction of unknown sign, jitter."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from c_library import Estimator, Library, load
from c_regression import PLAIN

GAMMA, NOISE, B, COULOMB = 50.0, 2e-3, 2.3e-5, 0.02
COUNT, COUNT_Q = 1e-4, 3e-4
VALUES = {
    **{"method": 2, "rls.n": 1, "rls.m": 1, "noise.tau": NOISE, "prior.B": 0.1, **PLAIN},
    **{"encoder.theta": 2 * np.pi / COUNT, "encoder.q": 2 * np.pi / COUNT_Q},
}
T = 1e-3


@pytest.fixture(scope="module")
def c(build: Path) -> Library:
    return load(build)


class Sample:
    """A state whose members the tests set."""

    def __init__(self, c: Library, **values: float) -> None:
        self.c = c
        self.estimator = Estimator(c, {**VALUES, **values})
        self.p = self.estimator.parameters
        self.regression: Any = c.ffi.addressof(self.estimator.state.method, "regression")
        self.white = 3 / 16 * self.regression.design.w * T  # share of white noise after the filter

    def variance(self) -> tuple[float, float]:
        variance = self.c.lib.sh_sample_variance_of(self.regression, self.p)
        return variance.R, variance.last


@pytest.mark.parametrize("sigma", [0.0, 1e3, -1e5])
@pytest.mark.parametrize("modality", [1, 2])
def test_a_sample_at_rest(c: Library, sigma: float, modality: int) -> None:
    """The k-th sample at rest has the variance R (1 + k c / R)^2, with R of torque noise and
    rounding, and c of the rounding, whose error is the same in all samples."""
    sample = Sample(c, modality=modality)
    sample.regression.sigma = sigma
    rounding = sigma**2 * (COUNT**2 + COUNT_Q**2) / 12
    R = rounding + ((GAMMA * NOISE) ** 2 if modality == 1 else 0.032**2)
    for k in range(5):
        sample.regression.history.resting = k
        last = (1 + k * rounding / R) ** 2
        assert sample.variance() == pytest.approx((R * last, last), rel=1e-12)


def test_friction_of_unknown_sign(c: Library) -> None:
    """It enters with the variance of its whole size; while the motor creeps it lasts."""
    sample = Sample(c)
    unknown, estimate, unsure = 0.3, 0.7, 5.0
    sample.regression.unknown.input = unknown
    place = sample.regression.live.column[sample.regression.live.coulomb]
    sample.regression.beta[place] = estimate
    R = (GAMMA * NOISE) ** 2
    friction = (GAMMA * COULOMB * unknown) ** 2 * (estimate**2 + 1)  # 1: variance of the prior
    assert sample.variance() == pytest.approx((R + friction / sample.white, 1.0), rel=1e-12)
    sample.regression.history.unsure = unsure
    last = (1 + unsure * friction / (R + friction / sample.white)) ** 2
    assert sample.variance()[1] == pytest.approx(last, rel=1e-12)


def test_jitter_increases_the_variance_by_a_share_of_the_excess(c: Library) -> None:
    sample = Sample(c)
    sample.regression.history.excess = 11.0
    assert sample.variance()[0] == pytest.approx((GAMMA * NOISE) ** 2 * (1 + 0.3 * 10), rel=1e-12)


@pytest.mark.parametrize("noise", [0.0, 1e-4, 1e-3])
def test_the_excess_is_measured_from_the_positions(c: Library, noise: float) -> None:
    """GIVEN positions with white noise instead of rounding, THEN the excess is the noise that is
    left by the filter, over that of torque and rounding."""
    theta = noise * np.random.default_rng(1).normal(size=40000)
    sample = Sample(c)
    of_theta = (GAMMA**2 * B) ** 2 * sample.regression.gain_second
    of_torque = sample.white * (GAMMA * NOISE) ** 2
    excess = []
    for k in range(4, 8000):
        for i in range(5):
            sample.regression.theta_before[i] = theta[k - i]
        c.lib.sh_sample_variance_watch(sample.regression, sample.p)
        excess.append(sample.regression.history.excess)
    want = (of_torque + of_theta * noise**2) / (of_torque + of_theta * COUNT**2 / 12)
    assert np.mean(excess[1000:]) == pytest.approx(max(1.0, want), rel=0.05)
    assert sample.regression.history.excess_mean == pytest.approx(
        1 + (max(1.0, want) - 1) * (1 - np.exp(-8000 * T / 5)), rel=0.05
    )


@pytest.mark.parametrize(("rough", "theta"), [(0.0, COUNT**2 / 12), (1e-6, 1e-6)])
def test_the_share_of_the_error_that_is_of_the_torque(
    c: Library, rough: float, theta: float
) -> None:
    """The other share is that of theta: its noise, or its rounding if that is more."""
    sample = Sample(c)
    sample.regression.history.rough = rough
    of_theta = (GAMMA**2 * B) ** 2 * sample.regression.gain_second * theta
    of_torque = sample.white * (GAMMA * NOISE) ** 2
    share = c.lib.sh_sample_variance_of_torque(sample.regression, sample.p)
    assert share == pytest.approx(of_torque / (of_torque + of_theta), rel=1e-12)


def test_the_information_about_the_inertia_that_is_rounding(c: Library) -> None:
    """The measured noise of theta, and in motion what fourth differences miss of its rounding."""
    sample = Sample(c)
    of_theta = (GAMMA**2 * B * 0.1) ** 2 * sample.regression.gain_second

    def information() -> float:
        return float(c.lib.sh_sample_variance_of_inertia(sample.regression, sample.p))

    sample.regression.theta_before[2] = 1e-4
    measured = (6e-4) ** 2 / 70
    assert information() == pytest.approx(of_theta * measured, rel=1e-12)
    sample.regression.theta_before = [1e-4, 0.0, 0.0, 0.0, 0.0]  # the last sample has moved
    rounding = 0.056 * sample.regression.count**2 / 12
    assert information() == pytest.approx(of_theta * (1e-8 / 70 + rounding), rel=1e-12)
    for values in ({"prior.B": 0.0}, {"modality": 2}):
        other = Sample(c, **values)
        other.regression.theta_before[2] = 1e-4
        assert c.lib.sh_sample_variance_of_inertia(other.regression, other.p) == 0.0
