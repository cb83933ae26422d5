"""Every method of the comparison finds the stiffness of a joint that is as its equation says."""

from __future__ import annotations

import numpy as np
import pytest

from closed_form_joint import LINEAR, closed_form_log
from rivals.methods import METHODS, least_squares
from rivals.records import JointLog
from rivals.score import score

KINDS = ("series_elastic", "variable_stiffness")
ERRORS = {
    "FilteredRegression": 0.5,
    "least_squares": 0.1,
    "kalman": 1.0,
}
"""Largest root mean square error of the stiffness [%]."""


@pytest.fixture(scope="module", params=KINDS)
def log(request: pytest.FixtureRequest) -> JointLog:
    return closed_form_log(request.param)


@pytest.mark.parametrize("method", ERRORS)
def test_the_stiffness_of_an_ideal_joint_is_found(method: str, log: JointLog) -> None:
    found = score(log, METHODS[method](log))
    assert found.error < ERRORS[method]
    assert found.confident == 100
    assert found.wrong == 0


@pytest.mark.parametrize("method", ["FilteredRegression", "kalman"])
def test_on_line_intervals_hold_the_truth(method: str, log: JointLog) -> None:
    assert score(log, METHODS[method](log)).coverage > 90


@pytest.mark.slow("the logs of 40 seeds")
def test_the_error_off_line_is_as_large_as_its_standard_deviation() -> None:
    ratios = []
    for seed in range(40):
        log = closed_form_log("series_elastic", noise_tau=0.01, seed=seed)
        found = least_squares.estimate(log)
        ratios.append((found.stiffness[5000] - LINEAR) / found.std[5000])
    # The mean square of 40 numbers of variance 1 is within 0.55 and 1.55 with 99 %.
    assert 0.55 < np.mean(np.square(ratios)) < 1.55


def test_paper2011_finds_the_stiffness_of_a_joint_without_coulomb_friction() -> None:
    log = closed_form_log("series_elastic", tau_coulomb=0.0)
    estimate = METHODS["Paper2011"](log)
    assert score(log, estimate).error < 5
    assert np.isnan(estimate.std).all()
    assert not estimate.confident.any()


def test_the_data_sheet_decides_where_the_data_say_nothing() -> None:
    log = closed_form_log("series_elastic")
    rows = least_squares.regression(log)
    X = rows.X.copy()
    X[:, 0] = 1e-3 * X[:, 4]  # inertia and stiffness look the same
    beta, covariance = least_squares.solve(X, rows.y, log.known)
    assert beta[0] == pytest.approx(log.known.B, rel=1e-3)
    assert np.sqrt(covariance[0, 0]) == pytest.approx(0.05 * log.known.B, rel=1e-2)


def test_the_frequency_of_the_dynamics_is_that_of_the_fastest_motion() -> None:
    log = closed_form_log("series_elastic")
    f = least_squares.dynamics(log)
    assert f == pytest.approx(2.3, abs=0.2)
    # What passes the decimation is below 0.8 times the new Nyquist frequency.
    T = log.sample_period
    assert 2 * f <= 0.8 / T / least_squares.decimation(T, f) / 2
