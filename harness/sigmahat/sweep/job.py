"""The job of `sigmahat sweep`: does the runs of a plan that are not done, and sums up."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Sequence
from pathlib import Path

from sigmahat.paper import results
from sigmahat.paper.scenarios import SCENARIOS
from sigmahat.sweep import table
from sigmahat.sweep.plan import Plan
from sigmahat.sweep.records import records
from sigmahat.sweep.table import INDICES, Mean, SweepTable
from sigmahat.sweep.workers import cluster, local

_ROWS = 30
"""Rows of a printed summary; summary.csv has all of them."""
_TITLES = {
    "mse": "MSE [(N.m/rad)2]",
    "msrep": "MSREP [%]",
    "error": "mean error [%]",
    "mse_settled": "MSE after start-up [(N.m/rad)2]",
    "msrep_settled": "MSREP after start-up [%]",
    "error_settled": "mean error after start-up [%]",
}


def run(
    plan: Plan,
    out: Path,
    scheduler: str | None = None,
    progress: Callable[[int], object] = lambda runs: None,
) -> SweepTable:
    """Does what is not done of a sweep, here or on a Dask cluster, and writes all files into out.

    progress is called with the number of runs done since the last call, first with those that
    an earlier, interrupted call had done.

    Raises ValueError for records that do not fit and if every run failed, WorkerError for workers
    that are not there or lost, OSError for files that cannot be written.
    """
    with records(out, plan) as known:
        progress(len(known.outcomes))
        left = [each for each in plan.runs() if each.number not in known.outcomes]
        if left:
            for outcome in cluster(left, scheduler) if scheduler else local(left):
                known.add(outcome)
                progress(1)
        failures = [o.failure for _, o in sorted(known.outcomes.items()) if o.failure]
        if len(failures) == len(plan):
            known.outcomes.clear()  # nothing is worth keeping
            raise ValueError(f"every run failed, the first with: {failures[0]}")
        sweep = table.build(plan, known.outcomes)
        with results.folder(out) as folder:
            table.write(sweep, folder / "sweep.parquet")
            _write_summary(sweep, folder / "summary.csv")
            _draw(sweep, folder)
    return sweep


def _draw(sweep: SweepTable, folder: Path) -> None:
    from sigmahat.paper.figures import save
    from sigmahat.sweep import figures

    save(figures.distributions, sweep, folder / "distributions")
    if figures.abscissas(sweep):
        save(figures.against_parameters, sweep, folder / "parameters")


def _write_summary(sweep: SweepTable, path: Path) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        head = ["scenario", *sweep.listed, "estimation", "runs", "failed"]
        for title in INDICES.values():
            head += [title, title.replace(" [", " 95 % half width [")]
        writer.writerow(head)
        for mean in table.means(sweep):
            cells = [x for pair in mean.indices.values() for x in pair]
            writer.writerow(
                [mean.scenario, *mean.listed.values(), mean.estimation, mean.runs, mean.failed]
                + ["" if math.isnan(x) else x for x in cells]
            )


def summary_rows(sweep: SweepTable) -> list[list[str]]:
    """Head and rows of the summary as text: mean +- half width of the 95 % interval."""
    means = table.means(sweep)
    names = {each.scenario for each in means}
    fields = list(dict.fromkeys(f for n in names for t in SCENARIOS[n].tables for f in t))
    fields = [f for f in _TITLES if f in fields]
    failed = any(each.failed for each in means)
    head = ["scenario"] if len(names) > 1 else []
    head += [*sweep.listed, "estimation", "runs", *(["failed"] if failed else [])]
    rows = [head + [_TITLES[f] for f in fields]]
    for each in means:
        row = [each.scenario] if len(names) > 1 else []
        row += [_value(v) for v in each.listed.values()]
        row += [each.estimation, str(each.runs), *([str(each.failed)] if failed else [])]
        rows.append(row + [_cell(*each.indices[f]) for f in fields])
    return rows


def summary(sweep: SweepTable) -> str:
    """One screen."""
    head, *rows = summary_rows(sweep)
    shown = [head, *rows[:_ROWS]]
    widths = [max(map(len, column)) for column in zip(*shown, strict=True)]
    text = [head.index("estimation")]
    lines = [
        "  ".join(
            cell.ljust(width) if i in text else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in shown
    ]
    if len(rows) > _ROWS:
        lines.append(f"... {len(rows) - _ROWS} more rows in summary.csv")
    failures = [each for each in sweep.table["failure"].to_pylist() if each]
    if failures:
        lines.append(f"\nfailed, the first with: {failures[0]}")
    return "\n".join(lines)


def as_dict(sweep: SweepTable) -> list[dict[str, object]]:
    """The means for JSON; units are in the names."""
    return [_as_dict(mean) for mean in table.means(sweep)]


def _as_dict(mean: Mean) -> dict[str, object]:
    return {
        "scenario": mean.scenario,
        **mean.listed,
        "estimation": mean.estimation,
        "runs": mean.runs,
        "failed": mean.failed,
        **{
            INDICES[field]: {"mean": value, "95 % half width": half}
            for field, (value, half) in mean.indices.items()
        },
    }


def _value(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _cell(mean: float, half: float) -> str:
    if math.isnan(mean):
        return "-"
    return f"{mean:.4g}" if math.isnan(half) else f"{mean:.4g} +- {half:.2g}"


def conditions(plan: Plan, names: Sequence[str]) -> str:
    """What was run, in one line."""
    seeds = f"{plan.seeds} seed{'s' if plan.seeds > 1 else ''}"
    what = f"; {', '.join(names)}" if names else ""
    return f"{', '.join(plan.scenarios)}: {len(plan)} runs, {seeds}{what}"
