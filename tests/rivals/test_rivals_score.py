"""Scores against values computed by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from closed_form_joint import closed_form_log
from rivals.records import Estimate, JointLog
from rivals.score import QUANTILE, score, winkler


def test_the_interval_score_is_the_width_and_40_times_what_is_outside() -> None:
    true = np.array([10.0, 10.0, 10.0])
    low, high = np.array([9.0, 10.5, 5.0]), np.array([11.0, 12.0, 9.9])
    np.testing.assert_allclose(winkler(true, low, high), [2.0, 1.5 + 20.0, 4.9 + 4.0])


def log() -> JointLog:
    """A log of 4 s, every half second; four samples are judged."""
    zero, true = np.zeros(8), np.full(8, 100.0)
    known = closed_form_log("series_elastic").known
    return JointLog("arm", 1, 0.5, zero, zero, zero, zero, zero, true, known)


def estimate(stiffness: list[float], std: list[float], confident: list[bool]) -> Estimate:
    """What is said of the last four samples; before that it is nonsense."""
    return Estimate(
        np.array([np.nan] * 4 + stiffness),
        np.array([np.nan] * 4 + std),
        np.array([True] * 4 + confident),
        0.1,
    )


def test_a_score_is_of_the_samples_after_two_seconds_and_relative_to_the_truth() -> None:
    found = score(log(), estimate([110, 100, 130, 90], [10, 5, 10, 1], [True, True, True, False]))
    assert found.error == pytest.approx(100 * np.sqrt((0.1**2 + 0.3**2 + 0.1**2) / 4))
    assert found.width == pytest.approx(2 * QUANTILE * (10 + 5 + 10 + 1) / 4)
    assert found.coverage == 50
    outside = (30 - QUANTILE * 10) + (10 - QUANTILE * 1)
    assert found.interval_score == pytest.approx(found.width + 40 * outside / 4)
    assert (found.confident, found.wrong) == (75, 25)


def test_without_a_standard_deviation_there_is_no_interval() -> None:
    found = score(log(), estimate([110, 100, 130, 90], [np.nan] * 4, [False] * 4))
    assert np.isnan([found.width, found.coverage, found.interval_score]).all()
    assert found.error > 0


def test_where_the_spring_is_not_engaged_nothing_is_judged() -> None:
    every = log()
    slack = replace(every, stiffness=np.where(np.arange(8) == 6, 0.0, 100.0))
    found = score(slack, estimate([110, 110, 1e9, 110], [1.0] * 4, [True] * 4))
    assert found.error == pytest.approx(10)


def test_an_estimate_that_is_not_finite_has_no_score() -> None:
    with pytest.raises(ValueError, match="1 instants"):
        score(log(), estimate([110, np.nan, 1, 110], [1.0] * 4, [True] * 4))
