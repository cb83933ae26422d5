"""Torque and stiffness at any deformation, without learning."""

import math
from typing import Any

import numpy as np
import pytest

from c_library import Array, Estimator, Library
from oracle import SENSOR
from regression_joint import Joint

METHODS = [{"method": 1}, {"method": 2, "rls.n": 3}, {"method": 2, "modality": SENSOR}]
both = pytest.mark.parametrize("values", METHODS, ids=["Paper2011", "FilteredRegression", "Sensor"])
NAMES = ("tau_e", "tau_e_std", "sigma", "sigma_std", "sigma_per_gain")


def after(c: Library, values: dict[str, Any]) -> Estimator:
    """An estimator that has moved for two seconds."""
    estimator = Estimator(c, values)
    estimator.run(Joint(duration=2.0).measurements())
    return estimator


def evaluate(estimator: Estimator, phi: float, set_point: float) -> tuple[int, Array]:
    point = estimator.library.new("sh_point")
    lib = estimator.library.lib
    result = lib.sh_estimator_evaluate(estimator.state, estimator.parameters, phi, set_point, point)
    return result, np.array([getattr(point, name) for name in NAMES])


@both
def test_at_the_point_of_the_last_tick_it_gives_the_outputs(
    c: Library, values: dict[str, Any]
) -> None:
    """If a row has one sample, the standard deviations also belong to this tick."""
    estimator = after(c, {**values, "regression.decimation": 1})
    e, before = estimator.estimate, estimator.lasting()
    result, found = evaluate(estimator, e.phi, e.setPoint)
    assert result == 0
    assert found == pytest.approx([getattr(e, name) for name in NAMES], rel=1e-12)
    assert estimator.lasting() == before


@both
def test_the_stiffness_is_the_slope_of_the_torque(c: Library, values: dict[str, Any]) -> None:
    estimator, step = after(c, {**values, "prior.gap": 0.0}), 1e-6
    for phi in (-0.04, 0.0, 0.02):
        below, at, above = (
            evaluate(estimator, phi + shift, 75.0)[1] for shift in (-step, 0.0, step)
        )
        assert at[2] == pytest.approx((above[0] - below[0]) / (2 * step), rel=1e-6)


def test_torque_and_stiffness_are_less_certain_far_from_the_data(c: Library) -> None:
    estimator = after(c, {"method": 2, "rls.n": 3, "prior.torque_gain": 0.0})
    reached = np.max(np.abs(Joint(duration=2.0).motion[3]))
    _, near = evaluate(estimator, 0.5 * reached, 75.0)
    _, far = evaluate(estimator, 4.0 * reached, 75.0)
    assert near[1] < 0.05 * abs(near[0])
    assert far[1] > 10 * near[1]
    assert far[3] > 10 * near[3]


@both
@pytest.mark.parametrize(
    ("phi", "set_point"), [(math.nan, 75.0), (0.1, math.inf), (1e300, 75.0), (-1e300, 75.0)]
)
def test_what_is_not_finite_has_no_value(
    c: Library, values: dict[str, Any], phi: float, set_point: float
) -> None:
    result, found = evaluate(after(c, values), phi, set_point)
    assert result == 1
    assert np.all(found == math.inf)
