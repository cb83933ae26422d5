"""Creates the panels of a sweep for the figures and the report."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sigmahat.experiments.metrics import INDICES, Index, mean_interval
from sigmahat.show.panel import COLORS, Panel, Trace, TraceKind
from sigmahat.studies.sweep_table import (
    ESTIMATION,
    FAILURE,
    SCENARIO,
    ParameterColumn,
    SweepTable,
    ValueSource,
    title,
)

_BINS = 40


def parts(sweep: SweepTable) -> dict[str, SweepTable]:
    """Groups the rows of successful runs by scenario and comparison."""
    good = sweep.where([failure is None for failure in sweep.values(FAILURE)])
    keys = list(zip(good.values(ESTIMATION), good.values(SCENARIO), strict=True))
    several = len({scenario for _, scenario in keys}) > 1
    return {
        ", ".join(key) if several else key[0]: good.where([each == key for each in keys])
        for key in dict.fromkeys(keys)
    }


def drawn_indices(sweep: SweepTable) -> list[Index]:
    """MSREP of the whole run and after start-up, or MSE if relative errors are not defined."""
    for fields in (("msrep", "msrep_settled"), ("mse", "mse_settled")):
        indices = [INDICES[field] for field in fields]
        if all(np.isfinite(sweep.numbers(index)).any() for index in indices):
            return indices
    return []


def time_of(index: Index) -> str:
    """Describes the part of the run for which a plotted index is computed."""
    return "after start-up" if index.settled else "of the whole run"


def abscissas(sweep: SweepTable) -> list[ParameterColumn]:
    """Columns for the x axis: errors of parameters, and other parameters with numbers."""
    errors = [column for column in sweep.parameters(ValueSource.ERROR) if _varies(sweep, column)]
    others = (*sweep.parameters(ValueSource.LISTED), *sweep.parameters(ValueSource.DRAWN))
    unlike = [column for column in others if not any(map(column.same_quantity, errors))]
    return [*errors, *(column for column in unlike if _varies(sweep, column))]


def _varies(sweep: SweepTable, column: ParameterColumn) -> bool:
    values = sweep.values(column)
    numbers = all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in values)
    return numbers and len(set(values)) > 1


def has_a_value_for_each_run(sweep: SweepTable, column: ParameterColumn) -> bool:
    """Returns whether a parameter is drawn for each seed; such a plot has points, not means."""
    return any(map(column.same_quantity, sweep.parameters(ValueSource.DRAWN)))


def log_bins(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Edges of bins of equal ratio around positive values."""
    if not len(values):
        return np.array([0.1, 1.0])
    low, high = np.log10(values.min()), np.log10(values.max())
    margin = 0.02 * max(high - low, 0.1)
    return np.logspace(low - margin, high + margin, _BINS + 1)


def distributions(sweep: SweepTable) -> list[Panel]:
    """Histograms of the error of all runs, with and without the start-up."""
    panels = []
    for index in drawn_indices(sweep):
        when = time_of(index)
        every = {label: rows.numbers(index) for label, rows in parts(sweep).items()}
        edges = log_bins(np.concatenate([x[x > 0] for x in every.values()]))
        curves = [
            Trace(label, COLORS[i % len(COLORS)], edges, np.histogram(x, edges)[0], TraceKind.STEPS)
            for i, (label, x) in enumerate(every.items())
        ]
        heading, x_label = f"Distribution of {index.name(when)}", index.title(when)
        panels.append(Panel(heading, x_label, "runs", curves, x_log=True, linked=False))
    return panels


def against_parameters(sweep: SweepTable) -> Iterator[Panel]:
    """Creates panels of the error after start-up by each parameter or parameter error."""
    for column in abscissas(sweep):
        index = drawn_indices(sweep)[-1]
        yield Panel(
            f"{index.name(time_of(index))} against {column.name}",
            title(column),
            index.title(time_of(index)),
            list(_curves(sweep, column, index)),
            y_log=True,
            linked=False,
            caption="" if has_a_value_for_each_run(sweep, column) else "mean and 95 % interval",
        )


def _curves(sweep: SweepTable, column: ParameterColumn, index: Index) -> Iterator[Trace]:
    for i, (label, rows) in enumerate(parts(sweep).items()):
        color = COLORS[i % len(COLORS)]
        x, y = rows.numbers(column), rows.numbers(index)
        if has_a_value_for_each_run(sweep, column):
            yield Trace(label, color, x, y, TraceKind.POINTS)
            continue
        at = np.unique(x)
        mean, half = np.array([mean_interval(y[x == value].tolist()) for value in at]).T
        half = np.nan_to_num(half)  # the interval of a single run is not defined
        # A logarithmic scale has no place for 0.
        band = np.maximum(mean - half, 1e-3 * mean), mean + half
        yield Trace(label, color, at, mean, TraceKind.MEANS, band)
