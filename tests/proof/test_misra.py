"""MISRA C:2012: the table of docs/proof/misra.md has all that does not follow a rule."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import pytest

from gate import missing
from misra_findings import Finding, addon_findings, dump, findings, version

PAGE = Path(__file__).parents[2] / "docs" / "proof" / "misra.md"
FOLDERS = ("c", "fmu_src")
ANY = "any"
slow = pytest.mark.slow("the addon of cppcheck, a Python program, reads all files, twice")


@dataclass(frozen=True)
class Deviation:
    """A row of the table."""

    rule: str
    category: str
    places: dict[str, str]
    """Number in each folder, or ANY."""
    reason: str


def deviations() -> list[Deviation]:
    rows = re.findall(r"^\| (\d+\.\d+) \|(.*)\|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    table = []
    for rule, rest in rows:
        _, category, *places, reason = (cell.strip() for cell in rest.split(" | "))
        table.append(Deviation(rule, category, dict(zip(FOLDERS, places, strict=True)), reason))
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
        if ANY in row.places.values():
            assert row.category == "advisory", row.rule


@slow
def test_every_finding_is_of_a_rule_in_the_table(found: set[Finding]) -> None:
    known = {row.rule for row in deviations()}
    new = {finding for finding in found if finding.rule not in known}
    assert not new, "\n".join(sorted(f"rule {place.rule}: {listing({place})}" for place in new))


@slow
def test_the_table_has_the_number_of_places(found: set[Finding]) -> None:
    wrong = []
    for row in deviations():
        by_folder = {
            folder: {p for p in found if p.rule == row.rule and p.file.startswith(f"{folder}/")}
            for folder in FOLDERS
        }
        if not any(by_folder.values()):
            wrong.append(f"rule {row.rule}: no finding any more")
        for folder, places in by_folder.items():
            told = row.places[folder]
            if not (bool(places) if told == ANY else len(places) == int(told)):
                wrong.append(
                    f"rule {row.rule} in {folder}/: {len(places)} places, and not {told}:\n"
                    f"{listing(places)}"
                )
    assert not wrong, "\n".join(wrong)


def test_two_rules_broken_in_one_line_are_both_found(tmp_path: Path) -> None:
    """An octal number, and an `if` without braces."""
    (tmp_path / "broken.c").write_text("int f(int a) {\n if (a > 0) a = 012; return a; }\n")
    dump(tmp_path, [Path("broken.c")], [], ["SH_REAL=double"])
    assert {"7.1", "15.6"} <= {place.rule for place in addon_findings(tmp_path) if place.line == 2}
