"""Torque and stiffness at any deformation, without learning."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from c_library import Array, Estimator, Library
from oracle import SENSOR, STANDARD
from regression_joint import Joint

METHODS = [{"method": 1}, {"method": 2, "rls.n": 3}, {"method": 2, "modality": SENSOR}]
both = pytest.mark.parametrize("values", METHODS, ids=["Paper2011", "FilteredRegression", "Sensor"])
NAMES = ("tau_e", "tau_e_std", "sigma", "sigma_std")


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
    estimator = after(c, values)
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


def test_the_deviations_of_paper2011_are_those_of_least_squares(c: Library) -> None:
    """One coefficient: its variance is the noise's over 1 / P_0 plus the sum of phi^2."""
    noise, P_0 = 0.05, 1e4
    values = {"method": 1, "modality": SENSOR, "rls.kind": STANDARD, "rls.n": 1, "rls.m": 1}
    estimator = Estimator(c, {**values, "rls.P_0": P_0, "noise.tau_e": noise})
    phi = 0.02 * np.sin(np.arange(200) / 7)
    for each in phi:
        estimator.tick([0.0, each, 0.0, 0.0, 300 * each])
    e, information = estimator.estimate, 1 / P_0 + np.sum(phi**2)
    assert e.sigma_std == pytest.approx(noise / math.sqrt(information), rel=1e-9)
    assert e.tau_e_std == pytest.approx(abs(phi[-1]) * e.sigma_std, rel=1e-9)
    assert e.misfit == 1
