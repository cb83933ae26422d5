"""The methods on a joint that is as its equation says; scores and table against values by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from closed_form_joint import COUNTS, closed_form_log
from regression_joint import D_THETA, GAMMA, B, T
from rivals.methods import METHODS
from rivals.records import Estimate, JointLog, Known
from rivals.score import COLUMNS, QUANTILE, Result, page, score

ERRORS = {"FilteredRegression": 0.5, "least_squares": 0.1}
"""Largest root mean square error of the stiffness [%]."""
KNOWN = Known(
    gamma=GAMMA,
    B=B,
    D_theta=D_THETA,
    relative_std_B=0.05,
    relative_std_D_theta=0.2,
    relative_std_gain=0.0,
    tau_coulomb=0.02,
    noise_tau=1e-3,
    counts_theta=COUNTS,
    counts_q=COUNTS,
    range_phi=0.1,
    range_tau_e=20.0,
)


def ideal(tau_coulomb: float) -> JointLog:
    """A joint with a linear spring, whose data sheet is right."""
    log = closed_form_log("series_elastic", tau_coulomb)
    return JointLog(T, log["theta"], log["q"], log["tau"], log["stiffness"], KNOWN)


@pytest.mark.parametrize("method", ERRORS)
def test_the_stiffness_of_an_ideal_joint_is_found(method: str) -> None:
    log = ideal(tau_coulomb=0.01)
    found = score(log, METHODS[method](log))
    assert found["error"] < ERRORS[method]
    assert (found["confident"], found["wrong"]) == (100, 0)


def test_paper2011_finds_the_stiffness_of_a_joint_without_coulomb_friction() -> None:
    log = ideal(tau_coulomb=0.0)
    estimate = METHODS["Paper2011"](log)
    found = score(log, estimate)
    assert found["error"] < 5
    assert not estimate.confident.any()
    assert np.isnan([found["width"], found["coverage"], found["interval_score"]]).all()


SHORT = JointLog(0.5, np.zeros(8), np.zeros(8), np.zeros(8), np.full(8, 100.0), KNOWN)
"""A log of 4 s, every half second; four samples are judged."""


def estimate(stiffness: list[float], std: list[float], confident: list[bool]) -> Estimate:
    """An estimate of the last four samples; before that it is nonsense."""
    return Estimate(
        np.array([np.nan] * 4 + stiffness),
        np.array([np.nan] * 4 + std),
        np.array([True] * 4 + confident),
        0.1,
    )


def test_a_score_is_of_the_samples_after_two_seconds_and_relative_to_the_truth() -> None:
    found = score(SHORT, estimate([110, 100, 130, 90], [10, 5, 10, 1], [True, True, True, False]))
    assert found["error"] == pytest.approx(100 * np.sqrt((0.1**2 + 0.3**2 + 0.1**2) / 4))
    assert found["width"] == pytest.approx(2 * QUANTILE * (10 + 5 + 10 + 1) / 4)
    outside = (30 - QUANTILE * 10) + (10 - QUANTILE * 1)
    assert found["interval_score"] == pytest.approx(found["width"] + 40 * outside / 4)
    assert [found[name] for name in ("coverage", "confident", "wrong")] == [50, 75, 25]


def test_where_the_spring_is_not_engaged_nothing_is_judged() -> None:
    slack = replace(SHORT, stiffness=np.where(np.arange(8) == 6, 0.0, 100.0))
    found = score(slack, estimate([110, 110, 1e9, 110], [1.0] * 4, [True] * 4))
    assert found["error"] == pytest.approx(10)


def test_a_row_of_the_table_has_medians_and_means_over_the_joints() -> None:
    def result(method: str, seed: int, interval_score: float, wrong: float = 0.0) -> Result:
        values = (2.0 * seed, 5.0, 90.0, interval_score, 0.0, 0.5, 100.0, wrong)
        found = dict(zip(COLUMNS, values, strict=True))
        return {"seed": seed, "method": method, **found}

    table = page(
        [
            result("FilteredRegression", 1, 8.0),
            result("Paper2011", 1, float("nan")),
            result("least_squares", 1, 9.0),
            result("FilteredRegression", 2, 6.0),
            result("Paper2011", 2, float("nan")),
            result("least_squares", 2, 4.0, wrong=25.0),
        ]
    )
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()]
    assert rows[2:] == [
        ["FilteredRegression", "3", "5", "90", "7", "50", "0.5", "100", "0"],
        ["Paper2011", "3", "5", "90", "-", "0", "0.5", "100", "0"],
        ["least_squares", "3", "5", "90", "6.5", "50", "0.5", "100", "12.5"],
    ]
