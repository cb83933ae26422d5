"""The report of `sigmahat compare`: figure and tables in one file."""

import base64
from pathlib import Path

import pytest
from PIL import Image

from browser import ROWS, opened
from sigmahat.cli import main
from sigmahat.compare.conditions import JOINTS
from sigmahat.compare.job import compare
from sigmahat.compare.table import write


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A comparison of one joint, with a figure of one pixel."""
    folder = tmp_path_factory.mktemp("comparison")
    (joint,) = [each for each in JOINTS if each.scenario.name == "single-linear"]
    write(compare([joint], [1], processes=1), 1, folder / "compare.csv")
    Image.new("RGB", (1, 1)).save(folder / "compare.png")
    assert main(["report", str(folder), "--quiet"]) == 0
    return folder


@pytest.mark.parametrize("width", [400, 1400])
def test_the_report_has_the_numbers_of_the_file(width: int, folder: Path) -> None:
    lines = (folder / "compare.csv").read_text().splitlines()[1:]
    with opened(folder / "report.html", width=width) as page:
        assert page.complaints() == []
        assert page.requests() == [(folder / "report.html").as_uri()]
        assert page.run("return document.documentElement.scrollWidth") <= width
        rows = page.run(ROWS, "single transmission")
        picture = page.run("return document.querySelector('img').src")
    assert picture.endswith(base64.b64encode((folder / "compare.png").read_bytes()).decode())
    assert len(rows) == len(lines) == 4
    for row, line in zip(rows, lines, strict=True):
        group, joint, case, method, seeds, _, msrep, *_ = line.split(",")
        assert (group, seeds) == ("single transmission", "1")
        assert row.startswith(f"{joint} {case} {method}")
        assert f" {float(msrep):.4g} " in row
