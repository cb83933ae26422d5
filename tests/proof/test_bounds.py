"""Instructions of the longest tick that was found, and the table of the page."""

import re
from pathlib import Path

import pytest

from c_sources import REPOSITORY
from controllers import TARGETS, cross_build, run

PAGE = REPOSITORY / "docs" / "proof" / "bounds.md"
METHODS = {"1": "Paper2011", "2": "FilteredRegression"}


def table(processor: str) -> dict[str, float]:
    """The column of a processor in the table of the page."""
    lines = re.findall(r"^\|(.*)\|$", PAGE.read_text(encoding="utf-8"), re.M)
    header, _, *rows = ([cell.strip() for cell in line.split("|")] for line in lines)
    return {row[0]: float(row[header.index(processor)]) for row in rows}


# A Cortex-M4F computes double in software, which QEMU takes a minute to measure.
@pytest.mark.slow("a library is built, and run in QEMU")
@pytest.mark.parametrize(
    ("name", "real"),
    [pytest.param("Cortex-M4F", "float", marks=pytest.mark.complete), ("Cortex-M7", "double")],
)
def test_the_longest_ticks_are_those_of_the_page(
    name: str, real: str, build: Path, tmp_path: Path
) -> None:
    tree = cross_build("tests/proof/ticks", TARGETS[name], real, tmp_path)
    emulator = [part for part in (tree / "emulator.txt").read_text().split(";") if part]
    text = run(*emulator, str(tree / "ticks"))
    found = {}
    for line in text.splitlines():
        method, n, m, columns, longest = line.split()
        of = f", {columns} columns" if columns != "0" else ""
        found[f"{METHODS[method]}, {n} x {m}{of}"] = 1.5 * float(longest)
    # Another compiler may differ a little.
    assert table(f"{name}, {real}") == pytest.approx(found, rel=0.1)
