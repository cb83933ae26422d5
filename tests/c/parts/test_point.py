"""point.c: torque and stiffness at a point, and their std deviations."""

import pytest

from c_library import Library

VARIANCES = {"first": 4.0, "second": 9.0}
"""Of the torque and of the stiffness, by the covariance of the coefficients."""
CERTAIN = {"prior.torque_gain": 0.0, "prior.eccentric": 0.0}


def evaluate(
    c: Library, parameters: dict[str, float], **errors: float
) -> tuple[float, float, float, float, float]:
    """tau_e and sigma, their std deviations, and the relative change of sigma with the gain.

    The coefficients 5 and -1 have the columns 2 and 0 in the torque, 3 and 0 in the stiffness. With
    the nominal curve, the torque is 1 + 2 * 5, and the stiffness is 10 + 3 * 5.
    """
    at = c.new("sh_joint_point", F=[2.0], dF=[3.0], tau_nominal=1.0, sigma_nominal=10.0)
    coefficients = c.new("sh_coefficients", beta=[5.0, -1.0], per_gain=[1.0, 7.0])
    point, p = c.new("sh_point"), c.parameters({**CERTAIN, **parameters})
    variances, of_phi = c.new("sh_variances", **VARIANCES), c.new("sh_phi_errors", **errors)
    per_gain = c.lib.sh_point_evaluate(point, coefficients, p, at, 2, variances, of_phi)
    assert per_gain == 3.0
    return point.tau_e, point.sigma, point.tau_e_std, point.sigma_std, point.sigma_per_gain


def test_torque_and_stiffness_have_the_variances_of_the_coefficients(c: Library) -> None:
    assert evaluate(c, {}) == pytest.approx((11.0, 25.0, 2.0, 3.0, 3 / 25))


def test_the_gain_of_the_torque_is_uncertain(c: Library) -> None:
    """It changes the torque by 2 * 1, and the stiffness by 3 * 1; with the std deviation 4/3, these
    are 8/3 and 4: sqrt(2^2 + (8/3)^2) = 10/3, and sqrt(3^2 + 4^2) = 5."""
    _, _, tau_e_std, sigma_std, _ = evaluate(c, {"prior.torque_gain": 4 / 3})
    assert (tau_e_std, sigma_std) == pytest.approx((10 / 3, 5.0))


def test_rounding_of_the_deformation_makes_both_too_small(c: Library) -> None:
    """By the share 1/9 * 9 V_phi = 0.16: 0.16 * 25 = 4 and 0.16 * 11 = 1.76."""
    _, _, tau_e_std, sigma_std, _ = evaluate(c, {}, weights=1 / 9, rounding=0.16)
    assert (tau_e_std, sigma_std) == pytest.approx(((4.0 + 1.76**2) ** 0.5, 5.0))


def test_harmonics_pull_by_at_most_two_std_deviations(c: Library) -> None:
    """As before with V_phi = (0.035 eccentric)^2 = 0.16. A large one adds at most (2 * 3)^2."""
    for eccentric, want in ((0.4 / 0.035, 5.0), (100.0, 45.0**0.5)):
        found = evaluate(c, {"prior.eccentric": eccentric}, weights=1 / 9)
        assert found[3] == pytest.approx(want)


def test_beside_a_knee_the_slope_is_uncertain(c: Library) -> None:
    """sqrt(3^2 + 16) = 5; the torque is as certain as before."""
    _, _, tau_e_std, sigma_std, _ = evaluate(c, {}, knees=16.0)
    assert (tau_e_std, sigma_std) == pytest.approx((2.0, 5.0))


@pytest.mark.parametrize(("n", "ranges"), [(1, 32.0), (2, 32.0 ** (1 / 3)), (3, 2.0), (8, 2.0)])
def test_the_curve_is_known_where_its_highest_power_is_not_too_large(
    c: Library, n: int, ranges: float
) -> None:
    """Up to 32 times the power at range.phi: with phi^5, 2 ranges, which are known in any case."""
    p = c.parameters({"rls.symmetric": 1, "rls.n": n, "range.phi": 0.1})
    assert c.lib.sh_largest_deformation(p) == pytest.approx(0.1 * ranges)
