"""Data travel as data: other words in labels and titles change no plot of a sweep."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pictures
from sigmahat.files import tables
from sigmahat.report import from_sweep as report_of_sweep
from sigmahat.runs.metrics import INDICES, Index
from sigmahat.sweep import curves, figures, summary
from sigmahat.sweep.table import (
    ESTIMATION,
    FAILURE,
    RUN,
    SCENARIO,
    SEED,
    Column,
    ParameterColumn,
    Role,
    SweepTable,
    from_columns,
    read,
    write,
)

LISTED = ParameterColumn(Role.LISTED, "estimator", "model.k_s", "N/m")
OTHER = ParameterColumn(Role.LISTED, "estimator", "residual.K_I", "1/s")
DRAWN = ParameterColumn(Role.DRAWN, "plant", "motor.B", "kg.m2")
ERRORS = [ParameterColumn(Role.ERROR, "estimator", name, "%") for name in ("model.k_s", "motor.B")]


def made_up() -> SweepTable:
    """Two comparisons of two scenarios, 2 x 2 listed values, 3 seeds; one run failed."""
    rows: list[dict[Column, Any]] = []
    runs = itertools.product(("table1", "experiment"), (1.0, 2.0), (3, 4), (1, 2, 3))
    for number, (scenario, k_s, K_I, seed) in enumerate(runs):
        for estimation in ("RESIDUAL", "MODEL"):
            rng = np.random.default_rng([number, len(estimation)])
            failed = number == 5
            rows.append(
                {
                    **{RUN: number, SCENARIO: scenario, SEED: seed, LISTED: k_s, OTHER: K_I},
                    **{DRAWN: float(seed), ERRORS[0]: 10 * k_s, ERRORS[1]: 5.0 * seed},
                    ESTIMATION: estimation,
                    **{i: np.nan if failed else float(rng.random()) for i in INDICES.values()},
                    FAILURE: "refused" if failed else None,
                }
            )
    return from_columns({column: [row[column] for row in rows] for column in rows[0]})


def other_words(monkeypatch: pytest.MonkeyPatch) -> None:
    """Replaces the words of every label, title and name."""
    monkeypatch.setattr(tables, "title", lambda name, unit: f"({unit}) {name[::-1]}")
    monkeypatch.setattr(Index, "name", lambda index, when="": f"{when}{index.field}!")
    monkeypatch.setattr(
        ParameterColumn, "name", property(lambda c: f"{c.role}{c.parameter}{c.owner}")
    )
    monkeypatch.setattr(curves, "time_of", lambda index: "Hz, Coulomb, error of [x] y")
    for module in (figures, report_of_sweep):
        monkeypatch.setattr(module, "time_of", curves.time_of)


def shown(sweep: SweepTable, folder: Path) -> list[Any]:
    """Figures, report and means of a sweep, without words."""
    write(sweep, folder / "sweep.parquet")
    return [
        pictures.of_figure(figures.distributions(sweep)),
        pictures.of_figure(figures.against_parameters(sweep)),
        pictures.of_report(report_of_sweep.from_sweep(folder).panels),
        summary.means(sweep),
    ]


def test_other_words_change_no_plot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = shown(made_up(), tmp_path)
    assert [len(panels) for panels in before[:3]] == [2, 3, 5]
    assert (tmp_path / "sweep.parquet").exists()
    other_words(monkeypatch)
    # The file was written with the words of before.
    assert shown(read(tmp_path / "sweep.parquet"), tmp_path) == before
    assert shown(made_up(), tmp_path) == before


def test_a_parameter_is_drawn_once_whoever_owns_it() -> None:
    sweep = made_up()
    assert curves.abscissas(sweep) == [*ERRORS, OTHER]
    points = [curves.has_a_value_for_each_run(sweep, c) for c in curves.abscissas(sweep)]
    assert points == [False, True, False]


def test_the_file_keeps_rows_and_what_columns_are(tmp_path: Path) -> None:
    sweep = made_up()
    write(sweep, tmp_path / "sweep.parquet")
    again = read(tmp_path / "sweep.parquet")
    assert list(again.columns) == list(sweep.columns)
    assert again.table.column_names == sweep.table.column_names
    for column in sweep.columns:
        np.testing.assert_array_equal(again.values(column), sweep.values(column))
