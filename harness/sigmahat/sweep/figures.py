"""The pictures of a sweep: how the error is distributed, and what it owes to a parameter."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pyarrow.compute as pc
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from sigmahat.paper.metrics import mean_interval
from sigmahat.sweep.table import ERROR, INDICES, SweepTable

Column = NDArray[np.float64]

# Okabe and Ito, in an order that keeps neighbours apart.
COLORS = ("#0072B2", "#D55E00", "#009E73", "#E69F00", "#56B4E9", "#CC79A7", "#000000")
AFTER, ALL = "msrep_settled", "msrep"
_BINS = 40


def series(sweep: SweepTable) -> dict[str, SweepTable]:
    """Rows that did not fail by what the legend calls them: comparison, and scenario if several."""
    table = sweep.table.filter(pc.is_null(sweep.table["failure"]))
    several = len(pc.unique(table["scenario"])) > 1
    names = [
        f"{row['estimation']}, {row['scenario']}" if several else row["estimation"]
        for row in table.select(["estimation", "scenario"]).to_pylist()
    ]
    order = list(dict.fromkeys(names))
    where = np.array(names)
    return {
        name: SweepTable(table.filter(where == name), sweep.listed, sweep.drawn) for name in order
    }


def column(sweep: SweepTable, title: str) -> Column:
    """A column as floats."""
    return np.asarray(sweep.table[title].to_numpy(), dtype=np.float64)


def index_of(sweep: SweepTable) -> dict[str, str]:
    """What is drawn, title by field: MSREP, or MSE where relative errors are not defined."""
    for fields in ((ALL, AFTER), ("mse", "mse_settled")):
        if all(np.isfinite(column(sweep, INDICES[f])).any() for f in fields):
            return {
                field: f"{field.partition('_')[0].upper()} {time} {INDICES[field].split(' ')[1]}"
                for field, time in zip(fields, ("of the whole run", "after start-up"), strict=True)
            }
    return {}


def distributions(sweep: SweepTable) -> Figure:
    """Histogram of the error of all runs, with and without the start-up."""
    drawn = index_of(sweep)
    figure = Figure(figsize=(7.2, 1.0 + 2.6 * len(drawn)), layout="constrained")
    panels: Sequence[Axes] = figure.subplots(len(drawn), squeeze=False)[:, 0].tolist()
    for axes, (field, title) in zip(panels, drawn.items(), strict=True):
        every = {name: column(part, INDICES[field]) for name, part in series(sweep).items()}
        positive = {name: x[x > 0] for name, x in every.items()}
        bins = log_bins(np.concatenate(list(positive.values())))
        for (name, x), color in zip(positive.items(), _cycle(len(positive)), strict=True):
            axes.hist(x, bins, histtype="stepfilled", alpha=0.25, color=color)
            axes.hist(x, bins, histtype="step", linewidth=1.2, color=color, label=name)
        axes.set_xscale("log")
        axes.set_xlabel(title)
        axes.set_ylabel("runs")
        _legend(axes, len(positive))
    return figure


def log_bins(values: Column) -> list[float]:
    """Edges of bins of equal ratio around positive values."""
    if not len(values):
        return [0.1, 1.0]
    low, high = np.log10(values.min()), np.log10(values.max())
    margin = 0.02 * max(high - low, 0.1)
    edges: list[float] = np.logspace(low - margin, high + margin, _BINS + 1).tolist()
    return edges


def abscissas(sweep: SweepTable) -> list[str]:
    """What the error is drawn against: errors of parameters, and other parameters with numbers."""
    errors = [title for title in sweep.errors if _varies(sweep, title)]
    covered = {_symbol(title) for title in errors}
    others = [
        title
        for title in (*sweep.listed, *sweep.drawn)
        if _symbol(title) not in covered and _varies(sweep, title)
    ]
    return [*errors, *others]


def _symbol(title: str) -> str:
    """The end of a parameter's name, the same for plant, estimators and error of it."""
    return title.removeprefix(ERROR).split(" ")[0].split(".")[-1]


def _varies(sweep: SweepTable, title: str) -> bool:
    values = sweep.table[title].to_pylist()
    numbers = all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in values)
    return numbers and len(set(values)) > 1


def against_parameters(sweep: SweepTable) -> Figure:
    """Error after start-up over each parameter, or over the error of that parameter."""
    titles = abscissas(sweep)
    field, title = list(index_of(sweep).items())[-1]
    figure = Figure(figsize=(7.2, 0.8 + 2.8 * len(titles)), layout="constrained")
    panels: Sequence[Axes] = figure.subplots(len(titles), squeeze=False)[:, 0].tolist()
    for axes, abscissa in zip(panels, titles, strict=True):
        every = series(sweep)
        for (name, part), color in zip(every.items(), _cycle(len(every)), strict=True):
            x, y = column(part, abscissa), column(part, INDICES[field])
            if is_drawn(sweep, abscissa):
                axes.plot(x, y, ".", markersize=4, alpha=0.6, color=color, label=name)
            else:
                at, mean, half = interval_at(x, y)
                low = np.minimum(half, 0.999 * np.array(mean))  # the scale has no place for 0
                axes.errorbar(
                    at, mean, np.array([low, half]), color=color, marker="o", markersize=4,
                    capsize=3, linewidth=1.2, label=name,
                )  # fmt: skip
        axes.set_yscale("log")
        axes.set_xlabel(abscissa)
        points = is_drawn(sweep, abscissa)
        axes.set_ylabel(title if points else f"{title},\nmean and 95 % interval")
        _legend(axes, len(every))
    return figure


def is_drawn(sweep: SweepTable, title: str) -> bool:
    """Whether each run has its own value, shown as a point; others are shown as means."""
    return _symbol(title) in {_symbol(each) for each in sweep.drawn}


def interval_at(x: Column, y: Column) -> tuple[list[float], list[float], list[float]]:
    """Different x, and for each the mean of y and half the width of its 95 % interval, 0 of one."""
    at = np.unique(x).tolist()
    pairs = [mean_interval(y[x == value].tolist()) for value in at]
    return at, [mean for mean, _ in pairs], [0.0 if np.isnan(half) else half for _, half in pairs]


def _cycle(count: int) -> list[str]:
    return [COLORS[i % len(COLORS)] for i in range(count)]


def _legend(axes: Axes, entries: int) -> None:
    """Above the panel, where it hides nothing."""
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=min(entries, 3), frameon=False)
