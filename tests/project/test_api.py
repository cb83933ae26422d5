"""The whole public API is on its page, documented and typed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import sigmahat

REPOSITORY = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def page(site: Path) -> str:
    return (site / "api.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", sorted({*sigmahat.__all__} - {"__version__"}))
def test_a_public_name_is_on_the_page(name: str, page: str) -> None:
    assert f'id="sigmahat.{name}"' in page


def test_all_public_names_are_imported_lazily_and_listed() -> None:
    """They are listed in the stub alone, which lazy_loader and type checkers read."""
    stub = (REPOSITORY / "harness" / "sigmahat" / "__init__.pyi").read_text(encoding="utf-8")
    lazy = re.findall(r"^from \..* import (\w+) as \1$", stub, re.MULTILINE)
    assert sorted([*lazy, "__version__"]) == sorted(sigmahat.__all__)
    assert dir(sigmahat) == sorted(sigmahat.__all__)


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'estimator'"):
        sigmahat.estimator  # type: ignore[attr-defined]  # noqa: B018


def test_an_unknown_fmu_is_an_error_that_lists_the_existing_ones() -> None:
    with pytest.raises(FileNotFoundError, match=r"no Stiffness\.fmu in .*StiffnessEstimator"):
        sigmahat.fmu("Stiffness")
