"""posterior.c: prior and data, and the noise in columns that is removed from their information."""

from typing import Any

import pytest

from c_library import Library
from c_parts import estimate, normal_equations, posterior_of_prior


def variance(c: Library, posterior: Any, *combination: float, prior_B: float = 0.0) -> float:
    """Variance of a linear combination of the coefficients."""
    first, count = list(combination), len(combination)
    found = c.lib.sh_posterior_variances(posterior, prior_B, first, [0.0] * count, count)
    return float(found.first)


def test_a_sample_updates_one_coefficient_by_the_rule_of_bayes(c: Library) -> None:
    """Prior N(0, 1), and y = 3 = 2 beta of the weight 2, which counts half: the precision is
    1 + 1 * 2^2 = 5, beta = 1 * 2 * 3 / 5, and with a gain of 5 instead of 3 it is 2. Before, the
    prediction has rho = 2^2 times the variance of the sample: 1 / (1 + rho) = 1/5."""
    posterior = posterior_of_prior(c, 1, weight=0.5)
    share = c.lib.sh_posterior_take(posterior, [2.0, 5.0, 3.0], 1, 2.0)
    assert share == pytest.approx(0.2)
    beta, per_gain = estimate(c, posterior, 1)
    assert (beta[0], per_gain[0]) == pytest.approx((1.2, 2.0))
    assert variance(c, posterior, 1.0) == pytest.approx(0.2)


def test_variances_of_two_coefficients(c: Library) -> None:
    """The sample beta_0 + beta_1 = 3: the information ((2, 1), (1, 2)) has the inverse
    ((2, -1), (-1, 2)) / 3. The sum of both has the variance 2/3, and their difference 2."""
    posterior = posterior_of_prior(c, 2)
    c.lib.sh_posterior_take(posterior, [1.0, 1.0, 0.0, 3.0], 2, 1.0)
    assert estimate(c, posterior, 2)[0] == pytest.approx([1.0, 1.0])
    assert variance(c, posterior, 1.0, 1.0) == pytest.approx(2 / 3)
    assert variance(c, posterior, 1.0, -1.0) == pytest.approx(2.0)


def test_a_posterior_has_its_own_order_of_columns(c: Library) -> None:
    """Column 2 of the data, then 0, without 1: y = 4 = 2 beta_2 gives 2 * 4 / (1 + 2^2)."""
    posterior = posterior_of_prior(c, 2)
    posterior.column[0], posterior.column[1] = 2, 0
    c.lib.sh_posterior_take(posterior, [0.0, 7.0, 2.0, 0.0, 4.0], 3, 1.0)
    copy = c.new("sh_posterior")
    c.lib.sh_posterior_copy(copy, posterior)
    for each in (posterior, copy):
        assert estimate(c, each, 3)[0] == pytest.approx([0.0, 0.0, 1.6])
        assert variance(c, each, 0.0, 9.0, 1.0) == pytest.approx(0.2)


PRIOR_B = 0.5


def with_inertia(c: Library, N: float) -> Any:
    """The sample beta = 2 of weight 4 for the inertia: 1 + 4 = 5, of which N is rounding."""
    posterior = posterior_of_prior(c, 1)
    c.lib.sh_posterior_take(posterior, [1.0, 0.0, 2.0], 1, 4.0)
    c.lib.sh_posterior_count_noise(posterior, N, 0.99)
    c.lib.sh_posterior_remove(posterior, PRIOR_B)
    return posterior


def test_rounding_is_removed_from_the_information_about_the_inertia(c: Library) -> None:
    """5 - 1, and the right-hand side 8 gets N / prior.B = 2, as rounding looks like b = -1."""
    posterior = with_inertia(c, 1.0)
    information, right = normal_equations(posterior.information)
    assert (information[0, 0], right[0, 1]) == pytest.approx((4.0, 10.0))
    assert (posterior.surplus, posterior.removed) == (0.0, 1.0)


def test_what_is_left_counts_less(c: Library) -> None:
    """I = 3 is left, and Q = 0.99 + (0.05 / 0.5)^2 = 1: 1 + 3^2 / (3 + 1 + 1) = 2.8."""
    posterior = with_inertia(c, 1.0)
    assert variance(c, posterior, 1.0, prior_B=PRIOR_B) == pytest.approx(1 / 2.8)
    assert estimate(c, posterior, 1, PRIOR_B)[0] == pytest.approx([0.6 * 10.0 / 2.8])


def test_the_inertia_stays_as_certain_as_its_prior(c: Library) -> None:
    """Of 6, only 4 can be removed; 2 wait for later samples."""
    posterior = with_inertia(c, 6.0)
    assert normal_equations(posterior.information)[0][0, 0] == pytest.approx(1.0)
    assert (posterior.surplus, posterior.removed) == pytest.approx((2.0, 4.0))


def test_noise_of_the_torque_is_removed_from_its_column(c: Library) -> None:
    """D = 1 + I + N = 9, I = N = 4, with a right-hand side 9 for y and 18 for the gain, of which
    G = 10 is noise. Q = (0.2 G)^2 = 4, and I / (I + N + Q) = 1/3 of all is left: 1 + 4/3, 9/3 and
    (18 - 10)/3."""
    posterior = posterior_of_prior(c, 1)
    c.lib.sh_posterior_take(posterior, [1.0, 18 / 8, 9 / 8], 1, 8.0)
    noise = c.new("sh_column_noise", information=4.0, gain=10.0)
    c.lib.sh_posterior_remove_noise(posterior, PRIOR_B, 0, noise)
    information, right = normal_equations(posterior.information)
    assert information[0, 0] == pytest.approx(7 / 3)
    assert right[0] == pytest.approx([8 / 3, 3.0])
