"""The versions in requirements/ are those of pyproject.toml, and the same for every purpose."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import tomlkit

REPOSITORY = Path(__file__).parents[2]
REQUIREMENTS = REPOSITORY / "requirements"
PROJECT = tomlkit.parse((REPOSITORY / "pyproject.toml").read_text(encoding="utf-8")).unwrap()
GROUPS = PROJECT["dependency-groups"]


def pins(purpose: str) -> set[str]:
    """Lines of a file, each "name==version ; marker", without markers and hashes."""
    text = (REQUIREMENTS / f"{purpose}.txt").read_text(encoding="utf-8")
    return set(re.findall(r"^([\w.-]+==[\w.]+)", text, re.MULTILINE))


def named(requirements: list[str | dict[str, str]]) -> set[str]:
    """Names of packages that a list in pyproject.toml asks for, those of groups in it too."""
    names: set[str] = set()
    for each in requirements:
        if isinstance(each, dict):
            names |= named(GROUPS[each["include-group"]])
        else:
            names |= set(re.findall(r"^[\w.-]+", each))
    return names


@pytest.mark.parametrize("purpose", GROUPS)
def test_what_a_purpose_asks_for_is_pinned(purpose: str) -> None:
    asked = named(GROUPS[purpose])
    if purpose in ("docs", "test"):  # they import the whole package
        asked |= named(PROJECT["project"]["dependencies"])
    if purpose == "test":
        for extra in PROJECT["project"]["optional-dependencies"].values():
            asked |= named(extra)
    assert asked <= {pin.partition("==")[0] for pin in pins(purpose)}
    if purpose != "rivals":  # its engines are too large for every run of the tests
        assert pins(purpose) <= pins("test")


def test_the_rivals_have_the_versions_of_the_tests() -> None:
    names = {pin.partition("==")[0] for pin in pins("rivals") & pins("test")}
    others = {pin.partition("==")[0] for pin in pins("rivals") ^ pins("test")}
    assert {"numpy", "scipy"} <= names
    assert not names & others


def test_every_file_is_of_a_purpose() -> None:
    names = {path.stem for path in REQUIREMENTS.glob("*.txt")}
    assert names == {*GROUPS, "not-for-reproduce"}


def test_the_environment_of_the_build_of_the_package_is_that_of_reproduce() -> None:
    assert named(GROUPS["reproduce"]) == {*named(PROJECT["build-system"]["requires"]), "ninja"}
