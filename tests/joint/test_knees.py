"""A curve with knees, as the nearest polynomial."""

from __future__ import annotations

import numpy as np
import pytest

from sigmahat.joint.sheet import Polynomial, start_of, with_knees

CUBIC = Polynomial(
    powers_of_phi=[0, 1, 2, 3],
    powers_of_set_point=[0, 1],
    eta=[[0.5, 0.0], [100.0, 3.0], [20.0, 0.0], [-40.0, 0.0]],
    units=[["N.m"] * 2, ["N.m/rad"] * 2, ["N.m/rad2"] * 2, ["N.m/rad3"] * 2],
    phi=None,
    set_point=None,
)
PHI = np.linspace(-0.2, 0.3, 101)
SET_POINT = np.linspace(1.0, 2.0, 101)
SIGMA = 100 + 3 * SET_POINT + 40 * PHI - 120 * PHI**2


def test_without_knees_it_stays_as_it_is() -> None:
    assert with_knees(CUBIC, PHI, SET_POINT, SIGMA) is CUBIC


def test_more_powers_come_near_a_knee() -> None:
    knee = np.where(PHI > 0.1, 30.0, 0.0)
    found = with_knees(CUBIC, PHI, SET_POINT, SIGMA + knee)
    slope = [found.at(np.array([x]), s)[1][0] for x, s in zip(PHI, SET_POINT, strict=True)]
    # The least squares of a polynomial of seven powers, by another function
    powers = np.polynomial.Polynomial.fit(PHI, knee, 6)
    np.testing.assert_allclose(slope - SIGMA, powers(PHI), rtol=0, atol=1e-6)
    assert found.powers_of_phi == list(range(8))
    assert found.eta[0] == CUBIC.eta[0] and found.eta[1][1] == 3.0
    torque, _ = found.at(np.array([0.0]), 1.0)
    assert torque[0] == pytest.approx(0.5)


def test_the_start_values_are_the_curve() -> None:
    start = start_of(CUBIC)
    assert (start["rls.n"], start["rls.m"]) == (4, 2)
    assert start["rls.eta_0[1,1]"] == 3.0
