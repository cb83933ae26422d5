"""Contents of a report from the table of a sweep."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from sigmahat.report.plots import COLORS, Contents, Panel, Table, Trace
from sigmahat.sweep import table
from sigmahat.sweep.figures import (
    abscissas,
    column,
    index_of,
    interval_at,
    is_drawn,
    log_bins,
    series,
)
from sigmahat.sweep.job import summary_rows
from sigmahat.sweep.table import INDICES, SweepTable


def sweep(folder: Path) -> Contents:
    """From what `sigmahat sweep` wrote."""
    read = table.read(folder / "sweep.parquet")
    head, *rows = summary_rows(read)
    runs = len(set(read.table["run"].to_pylist()))
    failed = len({r["run"] for r in read.table.to_pylist() if r["failure"] is not None})
    lines = [f"{runs} runs, {failed} of them failed"]
    lines += [f"drawn for each seed: {', '.join(read.drawn)}"] if read.drawn else []
    return Contents(
        f"Sweep: {folder.resolve().name}",
        lines,
        [Table("Mean and 95 % interval over the runs", head, rows)],
        [*_distributions(read), *_against(read)],
    )


def _distributions(read: SweepTable) -> Iterator[Panel]:
    for field, title in index_of(read).items():
        every = {name: column(part, INDICES[field]) for name, part in series(read).items()}
        edges = np.array(log_bins(np.concatenate([x[x > 0] for x in every.values()])))
        yield Panel(
            f"Distribution of {title.rpartition(' [')[0]}",
            title,
            "runs",
            [
                Trace(name, COLORS[i % len(COLORS)], edges, np.histogram(x, edges)[0], "steps")
                for i, (name, x) in enumerate(every.items())
            ],
            x_log=True,
            linked=False,
        )


def _against(read: SweepTable) -> Iterator[Panel]:
    for abscissa in abscissas(read):
        field, title = list(index_of(read).items())[-1]
        traces = []
        for i, (name, part) in enumerate(series(read).items()):
            color = COLORS[i % len(COLORS)]
            x, y = column(part, abscissa), column(part, INDICES[field])
            if is_drawn(read, abscissa):
                traces.append(Trace(name, color, x, y, "points"))
            else:
                at, mean, half = map(np.array, interval_at(x, y))
                traces.append(Trace(name, color, at, mean, "means", half))
        yield Panel(
            f"{title.rpartition(' [')[0]} over {abscissa.rpartition(' [')[0]}",
            abscissa,
            title,
            traces,
            y_log=True,
            linked=False,
        )
