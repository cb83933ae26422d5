"""The study of misfits can be built, and its prototype is right on a joint without a misfit."""

from __future__ import annotations

from pathlib import Path

from controllers import HOST, cross_build, run

COVERAGE = 2  # column of a joint in the table of `score`, after error and claim


def test_the_study_builds_and_the_claim_covers_the_error(build: Path, tmp_path: Path) -> None:
    ninja = build / "venv" / "bin" / "ninja"
    tree = cross_build("tests/studies/misfit", HOST, "double", ninja, tmp_path)
    table = run(str(tree / "score"), *["101", "102", "-c", "1", "-r", "none", "-j", "1"])
    (row,) = (line for line in table.splitlines() if line.startswith("1 none"))
    values = [float(value) for value in row.removeprefix("1 none").split("|")[0].split()]
    assert values[COVERAGE] >= 85, table
