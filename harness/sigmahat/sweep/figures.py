"""The figures of a sweep: how the error is distributed, and how it depends on parameters."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sigmahat.plotting.style import cycle
from sigmahat.sweep.curves import (
    abscissas,
    drawn_indices,
    has_a_value_for_each_run,
    interval_at,
    log_bins,
    parts,
    time_of,
)
from sigmahat.sweep.table import SweepTable, title


def distributions(sweep: SweepTable) -> Figure:
    """Histogram of the error of all runs, with and without the start-up."""
    indices = drawn_indices(sweep)
    figure = Figure(figsize=(7.2, 1.0 + 2.6 * len(indices)), layout="constrained")
    panels: Sequence[Axes] = figure.subplots(len(indices), squeeze=False)[:, 0].tolist()
    every = parts(sweep)
    for axes, index in zip(panels, indices, strict=True):
        errors = [part.rows.numbers(index) for part in every]
        positive = [x[x > 0] for x in errors]
        bins = log_bins(np.concatenate(positive))
        for part, x, color in zip(every, positive, cycle(len(every)), strict=True):
            axes.hist(x, bins, histtype="stepfilled", alpha=0.25, color=color)
            axes.hist(x, bins, histtype="step", linewidth=1.2, color=color, label=part.label)
        axes.set_xscale("log")
        axes.set_xlabel(index.title(time_of(index)))
        axes.set_ylabel("runs")
        _legend(axes, len(every))
    return figure


def against_parameters(sweep: SweepTable) -> Figure:
    """Error after start-up over each parameter, or over the error of that parameter."""
    columns = abscissas(sweep)
    index = drawn_indices(sweep)[-1]
    label = index.title(time_of(index))
    figure = Figure(figsize=(7.2, 0.8 + 2.8 * len(columns)), layout="constrained")
    panels: Sequence[Axes] = figure.subplots(len(columns), squeeze=False)[:, 0].tolist()
    every = parts(sweep)
    for axes, column in zip(panels, columns, strict=True):
        points = has_a_value_for_each_run(sweep, column)
        for part, color in zip(every, cycle(len(every)), strict=True):
            x, y = part.rows.numbers(column), part.rows.numbers(index)
            if points:
                axes.plot(x, y, ".", markersize=4, alpha=0.6, color=color, label=part.label)
            else:
                at, mean, half = interval_at(x, y)
                low = np.minimum(half, 0.999 * np.array(mean))  # the scale has no place for 0
                axes.errorbar(
                    at, mean, np.array([low, half]), color=color, marker="o", markersize=4,
                    capsize=3, linewidth=1.2, label=part.label,
                )  # fmt: skip
        axes.set_yscale("log")
        axes.set_xlabel(title(column))
        axes.set_ylabel(label if points else f"{label},\nmean and 95 % interval")
        _legend(axes, len(every))
    return figure


def _legend(axes: Axes, entries: int) -> None:
    """Above the panel, where it hides nothing."""
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=min(entries, 3), frameon=False)
