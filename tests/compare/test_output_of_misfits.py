"""What `sigmahat compare --misfits` prints, writes and draws."""

import csv
import math
from itertools import product
from pathlib import Path

import pytest
from lxml import etree
from PIL import Image

from command_line import Shell
from sigmahat.compare.misfits import conditions
from sigmahat.compare.misfits.conditions import CONDITIONS
from sigmahat.compare.misfits.experiment import AWAS, JOINTS
from sigmahat.compare.misfits.job import Row, compare
from sigmahat.compare.misfits.table import FIGURES, IN_FILE, table

NAMES = ("none", "uneven Coulomb friction 20 %", "n = 1, too small")


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    """Seven rows: two conditions of all joints, and one of the AwAS."""
    chosen = [each for each in CONDITIONS if each.name in NAMES]
    return compare(chosen, JOINTS, [1], processes=2)


def test_rows_are_judged(rows: list[Row]) -> None:
    *of_all, of_awas = NAMES
    expected = [*product(of_all, JOINTS), (of_awas, AWAS)]
    assert [(row.condition.name, row.joint) for row in rows] == expected
    assert {row.score.instants for row in rows} == {18000}
    both = [row for row in rows if row.joint is AWAS and row.condition.name in NAMES[:2]]
    clean, uneven = (row.score.figures for row in both)
    assert clean["error"] < 1.0 and clean["coverage"] > 80 and clean["confident"] == 100
    assert uneven["error"] != clean["error"]


def test_printed_table(rows: list[Row]) -> None:
    head, *lines = table(rows).splitlines()
    assert head.split() == [word for name in FIGURES for word in (name, "[%]")]
    groups = [line for line in lines if line and not line.startswith(" ")]
    assert groups == ["clean", "class 1", "class 2"]
    printed = [line for line in lines if line.startswith("  ") and "mean of" not in line]
    for row, line in zip(rows, printed, strict=True):
        assert line.startswith(f"  {row.condition.name}, {row.joint.name} ")
        cells = [float(cell) for cell in line.split()[-len(FIGURES) :]]
        assert cells == pytest.approx(list(row.score.figures.values()), abs=0.05)


@pytest.mark.slow("the fixture runs seven rows, the command two in processes of its own")
def test_command(rows: list[Row], shell: Shell, monkeypatch: pytest.MonkeyPatch) -> None:
    few = rows[-1:]
    monkeypatch.setattr(conditions, "CONDITIONS", [row.condition for row in few])
    out = Path("out").absolute()
    command = f"compare --misfits --seeds 1 --jobs 1 --out {out}"
    printed = shell.run(command)
    assert table(few) in printed
    assert "1 seed." in printed and str(out) in printed
    assert {path.name for path in out.iterdir()} == {"misfits.png", "misfits.svg", "misfits.csv"}
    with (out / "misfits.csv").open(newline="") as file:
        lines = list(csv.DictReader(file))
    for row, line in zip(few, lines, strict=True):
        assert (line["condition"], line["joint"]) == (row.condition.name, row.joint.name)
        assert line["class"] == row.condition.group.value
        for name, value in row.score.figures.items():
            assert float(line[f"{IN_FILE.get(name, name)} [%]"]) == value
    with Image.open(out / "misfits.png") as image:
        assert image.width > 800 and len(image.convert("RGB").getcolors(10**6)) > 10
    svg = etree.parse(out / "misfits.svg").getroot()
    assert svg.tag.endswith("svg")

    values = shell.json(command)
    assert [value["error"] for value in values] == [row.score.figures["error"] for row in few]
    assert not any(math.isnan(value["claim"]) for value in values)
