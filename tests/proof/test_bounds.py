"""Instructions and stack of a tick: bounds from counted paths, and the table of the page."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from arm_stack import Stack
from controllers import REPOSITORY
from tick_bounds import (
    LARGEST,
    METHODS,
    Analysis,
    build_ticks,
    frames,
    longest_measured,
    rows,
)

PAGE = REPOSITORY / "docs" / "proof" / "bounds.md"


def table(column: str) -> dict[tuple[str, str], float]:
    """A column of the table of the page, by the first two cells of the rows."""
    lines = re.findall(r"^\|(.*)\|$", PAGE.read_text(encoding="utf-8"), re.M)
    cells = [[cell.strip() for cell in line.split("|")] for line in lines]
    (header,) = (row for row in cells if column in row)
    place = header.index(column)
    return {
        (row[0], row[1]): float(row[place])
        for row in cells
        if len(row) == len(header) and row[-1].isdigit()
    }


# A Cortex-M4F computes double in software, which QEMU takes a minute to measure, and the code of a
# Cortex-M7 for float is that of a Cortex-M4F but for the order of the instructions.
@pytest.mark.slow("a library is built, disassembled, and run in QEMU")
@pytest.mark.parametrize(("name", "real"), [("Cortex-M4F", "float"), ("Cortex-M7", "double")])
def test_no_tick_is_longer_than_its_bound(
    name: str, real: str, build: Path, tmp_path: Path
) -> None:
    tree = build_ticks(name, real, build / "venv" / "bin" / "ninja", tmp_path)
    analysis = Analysis.of(tree, real)
    measured = longest_measured(tree)
    found = {(row[0], row[1]): float(row[2]) for row in rows(analysis, measured)}
    for label, quantity in found:
        if quantity == "longest measured":
            longest, bound = found[label, quantity], found[label, "at most, small angles"]
            assert longest <= bound <= found[label, "at most"]
            # Else the bound would be of little use: a loop is counted too often.
            assert bound < 3 * longest, label
    # Another compiler may differ a little.
    assert table(f"{name}, {real}") == pytest.approx(found, rel=0.1)
    # The depths come from the instructions; the compiler knows those of single functions.
    compiler = frames(tree)
    for method in METHODS:
        stack = Stack(analysis.functions(method, LARGEST[method], small=False))
        stack.depth(analysis.program.address("sh_estimator_tick"))
        names = {analysis.program.names.get(it, ""): own for it, (own, _) in stack.known.items()}
        same = names.keys() & compiler.keys()
        assert len(same) > 15
        assert {it: names[it] for it in same} == {it: compiler[it] for it in same}
