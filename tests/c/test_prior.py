"""Standard deviation of the stiffness before the first sample, against the closed form."""

from __future__ import annotations

import math

import pytest

from c_library import Estimator, Library
from oracle import CONSTANT_FACTOR, ENHANCED, STANDARD


@pytest.mark.parametrize("kind", [ENHANCED, STANDARD, CONSTANT_FACTOR])
def test_paper2011_scales_P_with_the_noise(c: Library, kind: int) -> None:
    estimate = Estimator(c, {"rls.kind": kind, "rls.P_0": 1e20, "rls.c": 1e-18}).estimate
    noise = 50.0 * 3.2e-3  # of gamma r_e [N.m]
    weight = 1e-18 if kind == ENHANCED else 1.0
    derivative = [1.0, 100.0, 100.0**2]  # derivative of l^j phi at l = 100
    want = noise * math.sqrt(weight * 1e20 * sum(d * d for d in derivative))
    assert estimate.sigma_std == pytest.approx(want, rel=1e-12)


def test_filtered_regression_scales_the_prior_with_the_ranges(c: Library) -> None:
    values = {"method": 2, "setPoint.offset": 70.0}
    r = 0.7  # set-point relative to range.setPoint
    want = 45.0 / 0.3 * math.sqrt(1.0 + r**2 + r**4)
    assert Estimator(c, values).estimate.sigma_std == pytest.approx(want, rel=1e-12)
