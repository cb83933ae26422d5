"""The methods on a joint that is as its equation says; scores and table against values by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from regression_joint import D_THETA, GAMMA, B, HardeningJoint, MisfitJoint, T
from rivals.methods import METHODS
from rivals.plan import SCORES, Result, Rivals, best, judged, page
from rivals.records import JointLog, RivalEstimate
from sigmahat.experiments.scores import QUANTILE

ERRORS = {"FilteredRegression": 0.5, "least_squares": 0.1}
"""Largest root mean square error of the stiffness [%]."""
COUNTS = 1 << 18
KNOWN = {
    **{"motor.gamma": GAMMA, "motor.B": B, "motor.D_theta": D_THETA, "prior.tau_coulomb": 0.02},
    **{"noise.tau": 1e-3, "encoder.theta": float(COUNTS), "encoder.q": float(COUNTS)},
    **{"range.phi": 0.1, "prior.tau_e": 20.0},
}


JOINTS = {"series_elastic": MisfitJoint, "variable_stiffness": HardeningJoint}


def score(log: JointLog, estimated: RivalEstimate) -> dict[str, float]:
    return estimated.score(log).figures


def ideal(kind: str, tau_coulomb: float = 0.01) -> JointLog:
    """A joint whose data sheet is right."""
    joint = JOINTS[kind](counts=COUNTS, noise=KNOWN["noise.tau"], tau_coulomb=tau_coulomb)
    theta, q, theta_c, tau, tau_e = joint.measurements().T
    return JointLog(kind, 1, T, theta, q, tau, theta_c, tau_e, joint.sigma, KNOWN)


@pytest.mark.parametrize("kind", JOINTS)
def test_the_stiffness_of_an_ideal_joint_is_found(kind: str) -> None:
    log = ideal(kind)
    for method, error in ERRORS.items():
        found = score(log, METHODS[method](log))
        assert found["error"] < error
        assert (found["confident"], found["wrong"]) == (100, 0)


def test_paper2011_finds_the_stiffness_of_a_joint_without_coulomb_friction() -> None:
    log = ideal("series_elastic", tau_coulomb=0.0)
    estimate = METHODS["Paper2011"](log)
    found = score(log, estimate)
    assert found["error"] < 5
    assert all(math.isnan(found[name]) for name in ("width", "coverage", "interval_score"))
    assert not estimate.confident.any()


def short_log() -> JointLog:
    """A log of 4 s, every half second; four samples are judged."""
    zero, true = np.zeros(8), np.full(8, 100.0)
    return JointLog("arm", 1, 0.5, zero, zero, zero, zero, zero, true, KNOWN)


def estimate(stiffness: list[float], std: list[float], confident: list[bool]) -> RivalEstimate:
    """Estimates for the last four samples; earlier estimates are meaningless."""
    return RivalEstimate(
        np.array([np.nan] * 4 + stiffness),
        np.array([np.nan] * 4 + std),
        np.array([True] * 4 + confident),
        0.1,
    )


def test_a_score_is_of_the_samples_after_two_seconds_and_relative_to_the_truth() -> None:
    of = estimate([110, 100, 130, 90], [10, 5, 10, 1], [True, True, True, False])
    found = score(short_log(), of)
    assert found["error"] == pytest.approx(100 * np.sqrt((0.1**2 + 0.3**2 + 0.1**2) / 4))
    assert found["width"] == pytest.approx(2 * QUANTILE * (10 + 5 + 10 + 1) / 4)
    outside = (30 - QUANTILE * 10) + (10 - QUANTILE * 1)
    assert found["interval_score"] == pytest.approx(found["width"] + 40 * outside / 4)
    assert [found[name] for name in ("coverage", "confident", "wrong")] == [50, 75, 25]


def test_where_the_spring_is_not_engaged_nothing_is_judged() -> None:
    slack = replace(short_log(), stiffness=np.where(np.arange(8) == 6, 0.0, 100.0))
    found = score(slack, estimate([110, 110, 1e9, 110], [1.0] * 4, [True] * 4))
    assert found["error"] == pytest.approx(10)


def test_a_method_that_fails_or_is_not_finite_has_a_row_with_its_reason() -> None:
    def raises(log: JointLog) -> RivalEstimate:
        raise ZeroDivisionError("no motion")

    def not_finite(log: JointLog) -> RivalEstimate:
        return estimate([110, np.nan, 1, 110], [1.0] * 4, [True] * 4)

    for method, words in (
        (raises, "ZeroDivisionError: no motion"),
        (not_finite, "ValueError: not finite at 1 instants"),
    ):
        outcome = judged(short_log(), {"Paper2011": method})
        (result,) = Rivals(["arm"], [1], ["Paper2011"]).table([outcome])
        assert math.isnan(result.pop("seconds"))
        assert result == {"kind": "arm", "seed": 1, "method": "Paper2011", "remark": words}


def of(method: str, seed: int, interval_score: float, wrong: float = 0.0) -> Result:
    values = (2.0 * seed, 5.0, 90.0, interval_score, 100.0, wrong)
    found = dict(zip(SCORES, values, strict=True))
    return {"kind": "arm", "seed": seed, "method": method, "seconds": 0.5, **found}


def test_a_row_has_medians_and_means_over_the_logs() -> None:
    results = [
        of("FilteredRegression", 1, 8.0),
        of("Paper2011", 1, 9.0),
        of("FilteredRegression", 2, 6.0),
        of("Paper2011", 2, 4.0, wrong=25.0),
        of("least_squares", 1, float("nan")),
        {"kind": "arm", "seed": 2, "method": "least_squares", "seconds": math.nan},
    ]
    assert best(results) == {("arm", 1): "FilteredRegression", ("arm", 2): "Paper2011"}
    rows = {}
    for line in page(results).splitlines()[4:]:
        _, method, *cells = (cell.strip() for cell in line.strip("|").split("|"))
        rows[method] = cells
    assert rows["FilteredRegression"] == ["2 of 2", "3", "5", "90", "7", "50", "0.5", "100", "0"]
    assert rows["least_squares"][:5] == ["1 of 2", "2", "5", "90", "-"]
    assert rows["Paper2011"][-1] == "12.5"
