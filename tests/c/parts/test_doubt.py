"""report.c: the reason why an estimate is not confident."""

from collections.abc import Mapping

import pytest

from c_library import Library

Values = Mapping[str, float]
LIMITS = {
    **{"limit.relative_std": 0.2, "range.phi": 0.1, "rls.symmetric": 1, "rls.n": 3},
    **{"prior.D_theta": 0.1, "prior.B": 0.1, "regression.memory": 10.0},
}


def doubt(c: Library, variance: float = 0.0, **changes: Values) -> str:
    """The doubt of an estimate that is confident without changes of its numbers: 'MISFIT'."""
    start: dict[str, Values] = {
        "sh_estimate": {"sigma": 10.0, "sigma_std": 1.99},
        "sh_coefficients": {"viscous_std": 0.5},
        "sh_bank": {"count": 1000.0},
        "sh_misfit": {"square": 1.0, "variance_factor": 1.0, "usual": 1.0, "judged": 300.0},
    }
    estimate, coefficients, bank, misfit = (
        c.new(struct, **{**values, **changes.get(struct, {})}) for struct, values in start.items()
    )
    found = c.lib.sh_report_doubt(
        estimate, coefficients, variance, bank, misfit, c.parameters(LIMITS)
    )
    names = [name for name in dir(c.lib) if name.startswith("SH_DOUBT_")]
    return next(name[9:] for name in names if getattr(c.lib, name) == found)


def test_the_estimate_is_confident(c: Library) -> None:
    """sigma_std = 1.99 is less than 0.2 * 10."""
    assert doubt(c) == "NONE"


@pytest.mark.parametrize(
    ("reason", "struct", "values"),
    [
        ("NOT_EXCITED", "sh_estimate", {"sigma_std": 2.01}),
        ("OUT_OF_RANGE", "sh_estimate", {"phi": -0.201}),  # of two ranges
        ("FRICTION", "sh_coefficients", {"viscous": 0.301}),  # of three priors
        ("FRICTION", "sh_coefficients", {"viscous": -1.001, "viscous_std": 0.0}),  # below 0
        ("INERTIA", "sh_coefficients", {"inertia": -0.301}),
        ("NEGATIVE_STIFFNESS", "sh_estimate", {"sigma": -10.0}),
        ("CHANGE", "sh_bank", {"evidence": 20.1}),
        ("CHANGE", "sh_bank", {"following": 1}),
        ("CHANGE", "sh_misfit", {"square": 1.71**2}),  # of 1.7 times the usual misfit
    ],
)
def test_one_number_is_the_doubt(c: Library, reason: str, struct: str, values: Values) -> None:
    assert doubt(c, 0.0, **{struct: values}) == reason


@pytest.mark.parametrize(
    ("struct", "values"),
    [
        ("sh_estimate", {"phi": -0.199}),
        ("sh_coefficients", {"viscous": 0.299}),
        ("sh_coefficients", {"inertia": 0.299}),
        ("sh_bank", {"evidence": 19.9}),
        ("sh_misfit", {"square": 1.69**2}),
    ],
)
def test_a_number_below_its_limit_is_no_doubt(c: Library, struct: str, values: Values) -> None:
    assert doubt(c, 0.0, **{struct: values}) == "NONE"


def test_an_uncertain_estimate_with_a_misfit_is_a_misfit(c: Library) -> None:
    uncertain = {"sigma_std": 2.01}
    assert doubt(c, sh_estimate=uncertain, sh_misfit={"variance_factor": 1.51}) == "MISFIT"
    assert doubt(c, sh_estimate=uncertain, sh_misfit={"variance_factor": 1.49}) == "NOT_EXCITED"


def test_few_blocks_have_a_limit_of_the_misfit(c: Library) -> None:
    """A misfit of 1.5^2 = 2.25 is too large before columns have been tried, up to 35 blocks."""
    misfit = {"square": 2.26}
    assert doubt(c, sh_bank={"count": 34.9}, sh_misfit=misfit) == "MISFIT"
    assert doubt(c, sh_bank={"count": 35.1}, sh_misfit=misfit) == "NONE"


def test_few_blocks_make_the_estimate_uncertain(c: Library) -> None:
    """1 + 3 * 10 / N < (0.2 * 10)^2 holds for more than 10 blocks."""
    certain = {"sigma_std": 1.0}
    assert doubt(c, 3.0, sh_estimate=certain, sh_bank={"count": 9.9}) == "NOT_EXCITED"
    assert doubt(c, 3.0, sh_estimate=certain, sh_bank={"count": 10.1}) == "NONE"


def test_the_last_reason_is_reported(c: Library) -> None:
    wrong = {"sigma": -10.0, "phi": 0.3}
    assert doubt(c, sh_estimate=wrong) == "NEGATIVE_STIFFNESS"
    assert doubt(c, sh_estimate=wrong, sh_bank={"following": 1}) == "CHANGE"
