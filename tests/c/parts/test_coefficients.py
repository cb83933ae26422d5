"""coefficients.c: the estimate, and what it says about the motor."""

import pytest

from c_library import Library
from c_parts import columns, posterior_of_prior


def test_coefficients_are_in_units_of_their_priors(c: Library) -> None:
    """y = 2 = beta_0 and y = -4 = beta_1 of weight 1, beside the prior: beta = (1, -2). Viscous
    friction with the prior 0.3 is 0.3 off, and the inertia with 0.1 is -0.2 off. The variance of
    beta_0 is 1/2."""
    motor, posterior = columns(c, {"VISCOUS": 0.3, "INERTIA": 0.1}), posterior_of_prior(c, 2)
    c.lib.sh_posterior_take(posterior, [1.0, 0.0, 6.0, 2.0], 2, 1.0)
    c.lib.sh_posterior_take(posterior, [0.0, 1.0, 0.0, -4.0], 2, 1.0)
    found, p = c.new("sh_coefficients"), c.parameters({"prior.D_theta": 0.3})
    c.lib.sh_coefficients_start(found, p)
    assert found.viscous_std == 0.3
    c.lib.sh_coefficients_solve(found, posterior, motor, p)
    assert list(found.beta[0:2]) == pytest.approx([1.0, -2.0])
    assert list(found.per_gain[0:2]) == pytest.approx([3.0, 0.0])
    assert (found.viscous, found.inertia) == pytest.approx((0.3, -0.2))
    c.lib.sh_coefficients_judge_viscous(found, posterior, motor, p)
    assert found.viscous_std == pytest.approx(0.3 / 2**0.5)


def test_a_motor_that_is_known_exactly_has_no_columns(c: Library) -> None:
    spring, posterior = columns(c, {"POWER": 1.0}), posterior_of_prior(c, 1)
    c.lib.sh_posterior_take(posterior, [1.0, 0.0, 2.0], 1, 1.0)
    found, p = c.new("sh_coefficients", viscous_std=0.5), c.parameters({})
    c.lib.sh_coefficients_solve(found, posterior, spring, p)
    c.lib.sh_coefficients_judge_viscous(found, posterior, spring, p)
    assert (found.viscous, found.inertia, found.viscous_std) == (0.0, 0.0, 0.5)
