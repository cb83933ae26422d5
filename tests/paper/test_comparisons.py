"""What `sigmahat compare` finds, and how it says it. Bounds are those asked of MatchedFilter."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import pytest

import calibration
from sigmahat.cli import main
from sigmahat.paper import comparisons as comparison
from sigmahat.paper import results
from sigmahat.paper.comparisons import JOINTS, METHODS, Line, compare
from sigmahat.paper.figures import comparison as draw
from sigmahat.paper.figures import save

MATCHED = "MatchedFilter"
FRICTION = "r(0) = 70 mm, Coulomb friction 0.02 N.m"
BOUNDS = {  # MSREP [%] by group and case, for 0.1, 0.3, 1, 3, 8 and 20 Hz
    ("r(0) = 70 mm", "D_theta +10 %"): (5.0, 2.0, 0.5, 0.4, 0.3, 0.4),
    ("r(0) = 70 mm", "D_theta -10 %"): (5.0, 2.0, 0.5, 0.4, 0.3, 0.4),
    (FRICTION, "D_theta +10 %"): (3.0, 1.0, 1.0, 1.0, 1.0, 3.0),
    (FRICTION, "D_theta +10 %, B +10 %"): (math.inf, math.inf, 3.0, 1.0, 1.0, 3.0),
    ("r(0) = 130 mm", "D_theta +10 %"): (4.0, 0.7, 0.25, 0.2, 0.2, 0.2),
}
FREQUENCIES = ("0.1 Hz", "0.3 Hz", "1 Hz", "3 Hz", "8 Hz", "20 Hz")


@pytest.fixture(scope="module")
def runs() -> list[list[Line]]:
    """The table of seed 1, and that of seed 2."""
    return [compare(JOINTS, [seed], processes=2) for seed in (1, 2)]


def mean(runs: list[list[Line]], k: int, method: str) -> float:
    """MSREP of a line over the runs [%]."""
    return float(np.mean([run[k].found[method].msrep for run in runs]))


def test_asked_rows_and_columns_are_met(runs: list[list[Line]]) -> None:
    met = set()
    for k, line in enumerate(runs[0]):
        if (line.group, line.case) in BOUNDS:
            bound = BOUNDS[line.group, line.case][FREQUENCIES.index(line.joint)]
            assert mean(runs, k, MATCHED) <= bound, line
            assert line.after == (1.0 if line.group == FRICTION else 0.0)
            met.add((line.group, line.case, line.joint))
    assert len(met) == len(BOUNDS) * len(FREQUENCIES)


def test_better_than_the_paper_in_every_row_with_wrong_motor_data(runs: list[list[Line]]) -> None:
    for k, line in enumerate(runs[0]):
        if line.joint != "table1":
            assert mean(runs, k, MATCHED) < mean(runs, k, "Paper2011"), line


def test_finds_the_error_of_the_friction(runs: list[list[Line]]) -> None:
    """From 0.3 Hz on within 10 % of the error, on the AwAS."""
    for line in (line for run in runs for line in run):
        if line.joint in FREQUENCIES[1:]:
            assert line.found[MATCHED].D_theta == pytest.approx(1e-3, abs=0.1 * 1e-4), line


def test_start_up_with_exact_motor_data() -> None:
    table1 = [joint for joint in JOINTS if joint.name == "table1"]
    unknown, nominal = compare(table1, range(1, 21), processes=2)
    assert unknown.found[MATCHED].msrep <= 0.30
    assert nominal.found[MATCHED].msrep <= 0.06


@pytest.mark.parametrize("with_inertia", [False, True])
def test_says_how_sure_it_is(with_inertia: bool) -> None:
    """The truth lies within 1.96 sigma_std for 90 to 99 % of the time, as far as 20 runs can tell.

    The share differs from run to run, and instants of one run are not independent: what can be told
    is the interval of the mean over runs.
    """
    share, half_width = calibration.share(range(20), with_inertia)
    assert half_width < 8.0
    assert share + half_width >= 90.0
    assert share - half_width <= 99.0


def test_printed_table(runs: list[list[Line]]) -> None:
    lines = runs[0]
    head, *rows = results.comparison_table(lines).splitlines()
    assert head.split()[:4] == ["Paper2011", "[%]", "MatchedFilter", "[%]"]
    assert [row for row in rows if row and not row.startswith(" ")] == list(
        dict.fromkeys(line.group for line in lines)
    )
    of_joints = [row for row in rows if row.startswith(" ")]
    for line, row in zip(lines, of_joints, strict=True):
        name, *cells = [cell for cell in row.split("  ") if cell]
        found = [line.found[method] for method in METHODS]
        assert name.startswith(f"{line.joint}, {line.case}")
        assert ("after" in name) == (line.after > 0)
        assert [float(cell) for cell in cells[:2]] == pytest.approx(
            [each.msrep for each in found], rel=0.005
        )
        assert float(cells[2]) == pytest.approx(found[1].sigma_std, abs=0.005)
        assert float(cells[3]) == pytest.approx(found[1].inside, abs=0.5)
        motors = [found[1].D_theta, found[1].B, found[1].tau_coulomb]
        for cell, value in zip(cells[4:], motors, strict=True):
            assert (
                cell.strip() == "-"
                if math.isnan(value)
                else float(cell) == pytest.approx(value, rel=1e-3)
            )


def test_figure(runs: list[list[Line]], tmp_path: Path) -> None:
    lines = runs[0]
    figure = draw(lines)
    shown = [each for axes in figure.axes for each in axes.get_lines()]
    assert len(shown) == len(METHODS) * len(BOUNDS)
    for axes in figure.axes:
        assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
        assert "[Hz]" in axes.get_xlabel()
    assert "[%]" in figure.axes[0].get_ylabel()
    (legend,) = figure.legends
    labels = [text.get_text() for text in legend.get_texts()]
    assert sorted(labels) == sorted(str(each.get_label()) for each in shown)
    assert len(set(labels)) == len(labels)
    (curve,) = [s for s in shown if s.get_label() == "MatchedFilter: r(0) = 130 mm, D_theta +10 %"]
    np.testing.assert_array_equal(np.asarray(curve.get_xdata()), [0.1, 0.3, 1, 3, 8, 20])
    expected = [line.found[MATCHED].msrep for line in lines if line.group == "r(0) = 130 mm"]
    np.testing.assert_array_equal(np.asarray(curve.get_ydata()), expected)
    save(draw, lines, tmp_path / "compare")
    assert {path.name for path in tmp_path.iterdir()} == {"compare.png", "compare.svg"}


def test_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Means over seeds do not depend on the number of processes, and the file has all digits."""
    joints = [JOINTS[2], JOINTS[-1]]
    monkeypatch.setattr(comparison, "JOINTS", joints)
    out = tmp_path / "out"
    assert main(["compare", "--seeds", "2", "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    lines = compare(joints, [1, 2], processes=1)
    assert results.comparison_table(lines) in printed
    assert "2 seeds" in printed and str(out) in printed
    assert {path.name for path in out.iterdir()} == {"compare.png", "compare.svg", "compare.csv"}
    with (out / "compare.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(METHODS) * len(lines)
    for row, (line, method) in zip(
        rows, ((line, method) for line in lines for method in METHODS), strict=True
    ):
        assert (row["joint"], row["case"], row["method"]) == (line.joint, line.case, method)
        assert float(row["MSREP [%]"]) == line.found[method].msrep
        D_theta = line.found[method].D_theta
        assert row["D_theta_hat [N.m.s/rad]"] == ("" if math.isnan(D_theta) else str(D_theta))
