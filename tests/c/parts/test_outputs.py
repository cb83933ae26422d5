"""report.c: the outputs that are coefficients of the regression, in their units."""

from collections.abc import Mapping
from typing import Any

import pytest

from c_library import Library
from c_parts import columns


def outputs(
    c: Library, listed: Any, beta: list[float], parameters: Mapping[str, Any], **point: Any
) -> Any:
    """The `sh_estimate *` of the coefficients beta. The stiffness is 100, d is -0.2, and b 0.5."""
    estimate = c.new("sh_estimate", sigma=100.0)
    found = c.new("sh_coefficients", beta=beta, viscous=-0.2, inertia=0.5)
    at = c.new("sh_joint_point", **point)
    c.lib.sh_report_coefficients(listed, found, c.parameters(parameters), at, estimate)
    return estimate


def test_outputs_are_coefficients_times_priors(c: Library) -> None:
    """The once-per-turn error is sqrt(3^2 + 4^2) / 100. Damping is 2 l with l = 3 at this point."""
    priors = {"BIAS": 2.0, "SIN_Q": 3.0, "COS_Q": 4.0, "HYSTERESIS": 5.0, "DAMPING": 2.0}
    priors |= {"DELAY": 6.0, "LOAD": 7.0, "DRIVE": 0.5, "COULOMB": 8.0}
    listed = columns(c, priors)
    listed.column[4].j = 1
    p = {"motor.D_theta": 10.0, "motor.B": 2.0, "prior.tau_e": 1.0, "range.setPoint_center": 0.0}
    found = outputs(c, listed, [-1.0] + [1.0] * 8, p, l=[1.0, 3.0])
    assert (found.bias_hat, found.hysteresis_hat, found.delay_hat) == (-2.0, 5.0, 6.0)
    assert (found.damping_hat, found.load_friction_hat, found.tau_coulomb_hat) == (6.0, 7.5, 8.0)
    assert found.eccentric_hat == pytest.approx(0.05)
    assert (found.D_theta_hat, found.B_hat) == pytest.approx((8.0, 3.0))


def test_powers_of_the_set_point_are_around_its_center(c: Library) -> None:
    """5 + 3 (s - 2) + 1 (s - 2)^2 = 3 - s + s^2, each in the unit 2."""
    listed = c.new("sh_columns", size=3)
    for j in range(3):
        column = listed.column[j]
        column.kind, column.j, column.prior, column.unit = c.lib.SH_COLUMN_POWER, j, 0.5, 4.0
    p = {"prior.tau_e": 1.0, "range.setPoint_center": 2.0}
    found = outputs(c, listed, [5.0, 3.0, 1.0], p)
    assert list(found.eta[0])[:4] == [2 * 3.0, 2 * -1.0, 2 * 1.0, 0.0]


def test_the_nominal_curve_is_scaled(c: Library) -> None:
    """By 1 + 0.5 * 0.4 = 1.2; a column of the same power adds to it if there is one."""
    listed = columns(c, {"POWER": 3.0, "NOMINAL": 0.5}, has_nominal=1)
    for tau_e, want in ((0.0, 12.0), (1.0, 15.0)):
        p: dict[str, Any] = {"prior.tau_e": tau_e, "rls.eta_0": [[10.0]]}
        p |= {"range.setPoint_center": 0.0, "rls.n": 1, "rls.m": 1}
        assert outputs(c, listed, [1.0, 0.4], p).eta[0][0] == pytest.approx(want)
