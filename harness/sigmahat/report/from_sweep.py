"""The contents of a report from the table of a sweep."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from sigmahat.report.contents import COLORS, Contents, Curve, Kind, Panel, TextTable
from sigmahat.runs.metrics import Index
from sigmahat.sweep.curves import (
    abscissas,
    drawn_indices,
    has_a_value_for_each_run,
    interval_at,
    log_bins,
    parts,
    time_of,
)
from sigmahat.sweep.summary import summary_columns
from sigmahat.sweep.table import FAILURE, RUN, ParameterColumn, Role, SweepTable, read, title


def from_sweep(folder: Path) -> Contents:
    """The summary, the distribution of the error, and the error over each parameter.

    Raises ValueError as sigmahat.sweep.table.read() does.
    """
    sweep = read(folder / "sweep.parquet")
    runs = dict(zip(sweep.values(RUN), sweep.values(FAILURE), strict=True))
    failed = sum(failure is not None for failure in runs.values())
    lines = [f"{len(runs)} runs, {failed} of them failed"]
    drawn = [title(column) for column in sweep.parameters(Role.DRAWN)]
    if drawn:
        lines.append(f"drawn for each seed: {', '.join(drawn)}")
    panels = [_distribution(sweep, index) for index in drawn_indices(sweep)]
    return Contents(
        f"Sweep: {folder.resolve().name}", lines, [_summary(sweep)], [*panels, *_against(sweep)]
    )


def _summary(sweep: SweepTable) -> TextTable:
    columns = summary_columns(sweep)
    return TextTable(
        "Mean and 95 % interval over the runs",
        [column.title for column in columns],
        list(zip(*(column.cells for column in columns), strict=True)),
        [column.words for column in columns],
    )


def _distribution(sweep: SweepTable, index: Index) -> Panel:
    every = {part.label: part.rows.numbers(index) for part in parts(sweep)}
    edges = np.array(log_bins(np.concatenate([x[x > 0] for x in every.values()])))
    curves = [
        Curve(label, COLORS[i % len(COLORS)], edges, np.histogram(x, edges)[0], Kind.STEPS)
        for i, (label, x) in enumerate(every.items())
    ]
    return Panel(
        f"Distribution of {index.name(time_of(index))}",
        index.title(time_of(index)),
        "runs",
        curves,
        x_log=True,
        linked=False,
    )


def _against(sweep: SweepTable) -> Iterator[Panel]:
    for column in abscissas(sweep):
        index = drawn_indices(sweep)[-1]
        yield Panel(
            f"{index.name(time_of(index))} over {column.name}",
            title(column),
            index.title(time_of(index)),
            list(_curves(sweep, column, index)),
            y_log=True,
            linked=False,
        )


def _curves(sweep: SweepTable, column: ParameterColumn, index: Index) -> Iterator[Curve]:
    for i, part in enumerate(parts(sweep)):
        color = COLORS[i % len(COLORS)]
        x, y = part.rows.numbers(column), part.rows.numbers(index)
        if has_a_value_for_each_run(sweep, column):
            yield Curve(part.label, color, x, y, Kind.POINTS)
        else:
            at, mean, half = map(np.array, interval_at(x, y))
            yield Curve(part.label, color, at, mean, Kind.MEANS, half)
