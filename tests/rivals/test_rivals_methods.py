"""Every method of the comparison finds the stiffness of a joint that is as its equation says."""

from __future__ import annotations

import numpy as np
import pytest

from closed_form_joint import closed_form_log
from rivals.methods import METHODS
from rivals.records import JointLog
from rivals.score import score

KINDS = ("series_elastic", "variable_stiffness")
ERRORS = {
    "FilteredRegression": 0.5,
    "least_squares": 0.1,
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


def test_paper2011_finds_the_stiffness_of_a_joint_without_coulomb_friction() -> None:
    log = closed_form_log("series_elastic", tau_coulomb=0.0)
    estimate = METHODS["Paper2011"](log)
    assert score(log, estimate).error < 5
    assert np.isnan(estimate.std).all()
    assert not estimate.confident.any()
