"""The whole public API is on its page, documented and typed."""

from __future__ import annotations

from pathlib import Path

import pytest

import sigmahat


@pytest.fixture(scope="module")
def page(site: Path) -> str:
    return (site / "api.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", sorted({*sigmahat.__all__} - {"__version__"}))
def test_a_public_name_is_on_the_page(name: str, page: str) -> None:
    assert f'id="sigmahat.{name}"' in page


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'estimator'"):
        sigmahat.estimator  # type: ignore[attr-defined]  # noqa: B018


def test_an_unknown_fmu_is_an_error_that_lists_the_existing_ones() -> None:
    with pytest.raises(FileNotFoundError, match=r"no Stiffness\.fmu in .*StiffnessEstimator"):
        sigmahat.fmu("Stiffness")
