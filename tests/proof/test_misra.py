"""MISRA C:2012: the table of docs/proof/misra.md has all that does not follow a rule."""

import re
from pathlib import Path

import pytest

from gate import missing
from misra_findings import findings, version

PAGE = Path(__file__).parents[2] / "docs" / "proof" / "misra.md"
FOLDERS = ("c", "fmu_src")


def deviations() -> list[list[str]]:
    """The rows of the table: rule, category, "yes" or not for each of FOLDERS, reason."""
    rows = re.findall(r"^\| (\d+\.\d+ \|.*)\|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    table = [[cell.strip() for cell in row.split(" | ")] for row in rows]
    return [[rule, *rest] for rule, _, *rest in table]


@pytest.fixture(scope="module", autouse=True)
def cppcheck() -> None:
    """The version that the page names: another one finds other places."""
    named = re.search(r"cppcheck (\d+\.\d+)", PAGE.read_text(encoding="utf-8"))
    assert named
    if version() != named[1]:
        missing(f"cppcheck {named[1]}", f"apt-get install cppcheck; there is {version()}")


def test_the_table_is_in_order() -> None:
    table = deviations()
    numbers = [tuple(map(int, rule.split("."))) for rule, *_ in table]
    assert numbers == sorted(set(numbers))
    for rule, category, *places, reason in table:
        assert category in ("required", "advisory"), rule  # mandatory: no deviation
        assert "yes" in places and reason, rule


@pytest.mark.complete
@pytest.mark.slow("the addon of cppcheck, a Python program, reads all files, twice")
def test_the_table_has_the_rules_that_are_not_followed(build: Path, tmp_path: Path) -> None:
    """In each folder: no rule is missing, and none is in the table without a finding."""
    table = {
        (rule, folder)
        for rule, _, *places, _ in deviations()
        for folder, told in zip(FOLDERS, places, strict=True)
        if told == "yes"
    }
    places: dict[tuple[str, str], list[str]] = {}
    for at in findings(tmp_path, build):
        place = f"{at.file}:{at.line}:{at.column}"
        places.setdefault((at.rule, at.file.partition("/")[0]), []).append(place)
    wrong = {rule: sorted(places.get(rule, [])) for rule in table ^ places.keys()}
    assert not wrong, wrong
