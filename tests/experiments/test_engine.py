"""Tests of the engine with a plan of a user: records, files, failures, order of the runs."""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from sigmahat.experiments.engine import all_outcomes, computed_table, study
from sigmahat.experiments.job import Job, Outcome
from sigmahat.experiments.metrics import mean_interval
from sigmahat.experiments.records import NAME, Records
from sigmahat.files.tables import write_csv
from sigmahat.show.panel import FigureRows, Panel, Trace, TraceKind

DONE: list[tuple[float, int]] = []
"""Runs of this process: entry and seed."""


def squared(entry: float, seed: int) -> Outcome:
    DONE.append((entry, seed))
    if entry < 0:
        return Outcome({}, {"square": "expected a positive number"})
    return Outcome({"square": {"value": entry**2 + seed, "undefined": float("nan")}})


@dataclass(frozen=True)
class Squares:
    """A plan: the square of each entry, with a disturbance that depends on the seed."""

    entries: Sequence[float]
    seeds: Sequence[int]

    name = "squares"

    @property
    def jobs(self) -> list[Job]:
        return [
            Job(partial(squared, entry, seed), fmus=(), about=(entry, seed), effort=entry)
            for entry in self.entries
            for seed in self.seeds
        ]

    def table(self, outcomes: Sequence[Outcome]) -> list[tuple[float, float]]:
        rows = iter(outcomes)
        means = []
        for _ in self.entries:
            of_entry = [next(rows).rows.get("square", {"value": 0.0}) for _ in self.seeds]
            means.append(mean_interval([numbers["value"] for numbers in of_entry]))
        return means

    def write(self, table: list[tuple[float, float]], folder: Path) -> None:
        write_csv(folder / "squares.csv", ["mean", "half width"], table)

    def figures(self, table: list[tuple[float, float]]) -> dict[str, FigureRows]:
        x, (mean, half) = np.array(self.entries), np.array(table).T
        curve = Trace("squares", "#000000", x, mean, TraceKind.MEANS, (mean - half, mean + half))
        return {"squares": [[Panel("squares", "x", "y", [curve])]]}

    def text(self, table: list[tuple[float, float]]) -> str:
        return f"{table}"

    def values(self, table: list[tuple[float, float]]) -> object:
        return table


def test_a_study_writes_table_figures_and_records_and_repeats_nothing(tmp_path: Path) -> None:
    done: list[int] = []
    table = study(Squares([1.0, 2.0], [1, 3]), tmp_path, processes=1, progress=done.append)
    assert [mean for mean, _ in table] == [3.0, 6.0]
    files = {"squares.csv", "squares.png", "squares.svg", NAME}
    assert {path.name for path in tmp_path.iterdir()} == files
    assert sum(done) == 4
    # WHEN the plan grows by an entry of one seed, only this run is done, here in this process.
    DONE.clear()
    with closing(Records(tmp_path / NAME)) as records:
        outcomes = all_outcomes(Squares([5.0, 1.0], [3]).jobs, records=records)
    assert DONE == [(5.0, 3)]
    assert [outcome.rows["square"]["value"] for outcome in outcomes] == [28.0, 4.0]
    assert np.isnan(outcomes[1].rows["square"]["undefined"])


def test_the_longest_runs_are_first_and_the_outcomes_in_the_order_of_the_plan(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    in_this_process = "sigmahat.experiments.engine.spread"
    monkeypatch.setattr(in_this_process, lambda jobs, _: ((i, job()) for i, job in enumerate(jobs)))
    DONE.clear()
    outcomes = all_outcomes(Squares([1.0, 3.0, 2.0], [1]).jobs)
    assert [entry for entry, _ in DONE] == [3.0, 2.0, 1.0]
    assert [outcome.rows["square"]["value"] for outcome in outcomes] == [2.0, 10.0, 5.0]


def test_a_run_that_fails_is_not_recorded(tmp_path: Path) -> None:
    with closing(Records(tmp_path / NAME)) as records:
        (outcome,) = all_outcomes(Squares([-1.0], [1]).jobs, records=records)
        assert outcome.failures == {"square": "expected a positive number"}
        assert records.outcome(Squares([-1.0], [1]).jobs[0]) is None
    assert not (tmp_path / NAME).exists()
    with pytest.raises(ValueError, match="every run failed; message of the first: expected a pos"):
        computed_table(Squares([-1.0], [1]))
