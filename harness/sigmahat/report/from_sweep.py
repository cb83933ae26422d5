"""The contents of a report from the table of a sweep."""

from __future__ import annotations

from pathlib import Path

from sigmahat.report.contents import Contents, TextTable
from sigmahat.sweep.panels import against_parameters, distributions
from sigmahat.sweep.summary import summary_columns
from sigmahat.sweep.table import FAILURE, RUN, Role, SweepTable, read, title


def from_sweep(folder: Path) -> Contents:
    """The summary, the distribution of the error, and the error against each parameter.

    Raises ValueError as sigmahat.sweep.table.read() does.
    """
    sweep = read(folder / "sweep.parquet")
    runs = dict(zip(sweep.values(RUN), sweep.values(FAILURE), strict=True))
    failed = sum(failure is not None for failure in runs.values())
    lines = [f"{len(runs)} runs, {failed} of them failed"]
    drawn = [title(column) for column in sweep.parameters(Role.DRAWN)]
    if drawn:
        lines.append(f"drawn for each seed: {', '.join(drawn)}")
    panels = [*distributions(sweep), *against_parameters(sweep)]
    return Contents(f"Sweep: {folder.resolve().name}", lines, [_summary(sweep)], panels)


def _summary(sweep: SweepTable) -> TextTable:
    columns = summary_columns(sweep)
    return TextTable(
        "Mean and 95 % interval over the runs",
        [column.title for column in columns],
        list(zip(*(column.cells for column in columns), strict=True)),
        [column.words for column in columns],
    )
