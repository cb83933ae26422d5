"""MISRA C:2012: the table of docs/proof/misra.md has all that does not follow a rule."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import pytest

from gate import missing
from misra_findings import Finding, findings, version

PAGE = Path(__file__).parents[2] / "docs" / "proof" / "misra.md"
FOLDERS = ("c", "fmu_src")
slow = pytest.mark.slow("the addon of cppcheck, a Python program, reads all files, twice")


@dataclass(frozen=True)
class Deviation:
    """A row of the table."""

    rule: str
    category: str
    folders: set[str]
    """Where it is not followed."""
    reason: str


def deviations() -> list[Deviation]:
    rows = re.findall(r"^\| (\d+\.\d+) \|(.*)\|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    table = []
    for rule, rest in rows:
        _, category, *places, reason = (cell.strip() for cell in rest.split(" | "))
        folders = {name for name, told in zip(FOLDERS, places, strict=True) if told == "yes"}
        table.append(Deviation(rule, category, folders, reason))
    return table


@pytest.fixture(scope="module", autouse=True)
def cppcheck() -> None:
    """The version that the page names: another one finds other places."""
    named = re.search(r"cppcheck (\d+\.\d+)", PAGE.read_text(encoding="utf-8"))
    assert named
    if version() != named[1]:
        missing(f"cppcheck {named[1]}", f"apt-get install cppcheck; there is {version()}")


@pytest.fixture(scope="module")
def found(build: Path, tmp_path_factory: pytest.TempPathFactory) -> set[Finding]:
    return findings(tmp_path_factory.mktemp("misra"), build)


def listing(places: set[Finding]) -> str:
    return "\n".join(sorted(f"{place.file}:{place.line}:{place.column}" for place in places))


def test_the_table_is_in_order() -> None:
    table = deviations()
    numbers = [tuple(map(int, row.rule.split("."))) for row in table]
    assert numbers == sorted(set(numbers))
    for row in table:
        assert row.category in ("required", "advisory"), row.rule  # mandatory: no deviation
        assert row.reason
        assert row.folders


@slow
def test_the_table_has_the_rules_that_are_not_followed(found: set[Finding]) -> None:
    """In each folder: no rule is missing, and none is in the table without a finding."""
    table = {(row.rule, folder) for row in deviations() for folder in row.folders}
    places: dict[tuple[str, str], set[Finding]] = {}
    for place in found:
        places.setdefault((place.rule, place.file.partition("/")[0]), set()).add(place)
    wrong = {rule: listing(places.get(rule, set())) for rule in table ^ places.keys()}
    assert not wrong, wrong
