"""Passes: after each, the posterior is the prior and all data, weighted by the misfit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from c_library import Estimator, Library, load
from c_regression import dense
from regression_joint import GAMMA, Joint

VALUES = {"method": 2, "rls.n": 2, "rls.m": 1}


@pytest.fixture(scope="module")
def c(build: Path) -> Library:
    return load(build)


@pytest.mark.parametrize("misfit", [0.0, 0.1])
def test_after_a_pass_the_posterior_is_prior_and_weighted_data(c: Library, misfit: float) -> None:
    joint = Joint(duration=4.0)
    z = joint.measurements()
    z[:, 2] = 0.0  # a single transmission
    z[:, 3] += (joint.tau_e - 140 * joint.motion[3]) / GAMMA
    z[:, 3] += misfit * np.sin(5 * GAMMA * joint.motion[0])
    estimator = Estimator(c, VALUES)
    regression = estimator.state.method.regression
    n = regression.size
    ended: list[int] = []
    tried: list[int] = []
    factors: list[float] = []
    for k, sample in enumerate(z):
        row, trial = regression.row, regression.trial
        estimator.tick(sample)
        if not (row == n and regression.row == n + 1):
            continue
        (tried if trial else ended).append(k)
        if trial:
            assert trial == regression.last_trial or regression.trial == 0
            continue
        own = list(regression.live.column[0 : regression.live.information.size])
        data, sides = dense(regression.data)
        weight = regression.live.weight
        factors.append(1 / weight)
        matrix, right = dense(regression.live.information)
        want = np.eye(len(own)) + weight * data[np.ix_(own, own)]
        assert matrix == pytest.approx(want, abs=1e-9 * np.max(want))
        want = weight * sides[own]
        assert right == pytest.approx(want, abs=1e-9 * np.max(np.abs(want)))
    # two ticks for each row, and for the four steps between two passes
    assert np.all(np.diff(sorted(ended + tried)) == 2 * (n + 3) + 2)
    # no trial in the first second, then every second pass is one
    assert tried[0] > 1000
    assert np.all(np.diff(tried) == 2 * (2 * (n + 3) + 2))
    assert (max(factors) > 1.5) == (misfit > 0)
    assert min(factors) == 1.0
    # no group has evidence where the model holds
    assert misfit > 0 or not any(regression.used)


def test_every_group_is_tried_in_turn(c: Library) -> None:
    estimator = Estimator(c, VALUES)
    regression = estimator.state.method.regression
    tried = []
    for sample in Joint(duration=4.0, deformation=0.2).measurements():
        before = regression.trial
        estimator.tick(sample)
        if regression.trial and regression.trial != before:
            tried.append(regression.trial)
    groups = [1, 3, 4, 5]  # group 2 has no columns: rls.m is 1
    assert tried == [groups[i % 4] for i in range(len(tried))]
    assert len(tried) > 8


def test_samples_between_passes_are_taken_by_the_estimate(c: Library) -> None:
    """From the first sample on: the estimate is that of all samples at any time."""
    z = Joint(duration=0.4).measurements()
    estimator = Estimator(c, VALUES)
    regression = estimator.state.method.regression
    for sample in z:
        estimator.tick(sample)
        own = list(regression.live.column[0 : regression.live.information.size])
        data, _ = dense(regression.data)
        matrix, _ = dense(regression.live.information)
        want = np.eye(len(own)) + data[np.ix_(own, own)]
        assert matrix == pytest.approx(want, abs=1e-8 * np.max(want))
