"""The summary of a sweep: means over the seeds, printed, as a CSV file, and for JSON."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sigmahat.experiments.metrics import INDICES, Index, mean_interval
from sigmahat.files import tables
from sigmahat.paper.scenarios import SCENARIOS
from sigmahat.studies.sweep_grid import Grid
from sigmahat.studies.sweep_table import (
    ESTIMATION,
    FAILURE,
    SCENARIO,
    ParameterColumn,
    SweepColumn,
    SweepTable,
    ValueSource,
    title,
)

RUNS, FAILED = "runs", "failed"
"""Columns of a summary that the table of a sweep does not have."""
_ROWS = 30  # rows of a printed summary; summary.csv has all rows


@dataclass(frozen=True)
class SettingMean:
    """The means of a comparison over the seeds of one setting."""

    about: Mapping[SweepColumn, Any]
    """Scenario, listed values, comparison, and the numbers of runs and of failed runs."""
    means: Mapping[Index, tuple[float, float]]
    """Mean and half width of the 95 % interval, over the runs that did not fail."""


@dataclass(frozen=True)
class SummaryColumn:
    """A column of the printed summary."""

    title: str
    words: bool  # whether its cells are words and not numbers
    cells: list[str]


def means(sweep: SweepTable) -> list[SettingMean]:
    """Computes the mean of each group of runs, in the order of the table."""
    keys: list[SweepColumn] = [SCENARIO, *sweep.parameters(ValueSource.LISTED), ESTIMATION]
    groups: dict[tuple[Any, ...], list[int]] = {}
    for row, key in enumerate(zip(*(sweep.values(column) for column in keys), strict=True)):
        groups.setdefault(key, []).append(row)
    failures = sweep.values(FAILURE)
    indices = {index: sweep.values(index) for index in INDICES.values()}
    result = []
    for key, rows in groups.items():
        good = [row for row in rows if failures[row] is None]
        about = dict(zip(keys, key, strict=True))
        about |= {RUNS: len(rows), FAILED: len(rows) - len(good)}
        of_runs = {index: mean_interval([x[row] for row in good]) for index, x in indices.items()}
        result.append(SettingMean(about, of_runs))
    return result


def summary_columns(sweep: SweepTable) -> list[SummaryColumn]:
    """Formats the summary as text: mean +- half width of the 95 % interval.

    The columns are the indices in the tables of the scenarios.
    """
    settings = means(sweep)
    columns = {column: [each.about[column] for each in settings] for column in settings[0].about}
    names = set(columns[SCENARIO])
    fields = {f for name in names for table in SCENARIOS[name].tables for f in table}
    if len(names) == 1:
        del columns[SCENARIO]
    if not any(columns[FAILED]):
        del columns[FAILED]
    conditions_of_settings = [
        SummaryColumn(
            title(column),
            any(isinstance(value, (str, bool)) for value in column_values),
            [_value(value) for value in column_values],
        )
        for column, column_values in columns.items()
    ]
    return conditions_of_settings + [
        SummaryColumn(
            index.title("after start-up" if index.settled else ""),
            False,
            [_cell(*setting.means[index]) for setting in settings],
        )
        for field, index in INDICES.items()
        if field in fields
    ]


def summary(sweep: SweepTable) -> str:
    """The summary as a text of one screen."""
    columns = summary_columns(sweep)
    rows = list(zip(*(column.cells for column in columns), strict=True))
    left = [i for i, column in enumerate(columns) if column.title == ESTIMATION]
    table = tables.aligned([[column.title for column in columns], *rows[:_ROWS]], left)
    lines = [line.rstrip() for line in table]
    if len(rows) > _ROWS:
        lines.append(f"... {len(rows) - _ROWS} more rows in summary.csv")
    failures = [each for each in sweep.values(FAILURE) if each]
    if failures:
        lines.append(f"\nfailed; message of the first: {failures[0]}")
    return "\n".join(lines)


def write(sweep: SweepTable, path: Path) -> None:
    """Writes every mean and half width with all digits."""
    titles = []
    for index in INDICES.values():
        titles += [title(index), tables.title(f"{index.field} 95 % half width", index.unit)]
    settings = means(sweep)
    rows = [
        [
            *setting.about.values(),
            *(None if math.isnan(x) else x for pair in setting.means.values() for x in pair),
        ]
        for setting in settings
    ]
    tables.write_csv(path, [*map(title, settings[0].about), *titles], rows)


def values(sweep: SweepTable) -> dict[str, object]:
    """The means for JSON, with the units of their columns."""
    listed = sweep.parameters(ValueSource.LISTED)
    units = {column.name: column.unit for column in listed}
    units |= {index.field: index.unit for index in INDICES.values()}
    return {"units": units, "table": [_row(setting) for setting in means(sweep)]}


def _row(setting: SettingMean) -> dict[str, object]:
    about: dict[str, object] = {
        column.name if isinstance(column, ParameterColumn) else str(column): value
        for column, value in setting.about.items()
    }
    return about | {
        index.field: {"mean": mean, "half_width": half}
        for index, (mean, half) in setting.means.items()
    }


def conditions(grid: Grid) -> str:
    """Describes the number of runs of a grid in one line."""
    seeds = tables.counted(grid.seeds, "seed")
    names = f"; {', '.join(grid.parameters)}" if grid.parameters else ""
    return f"{', '.join(grid.scenarios)}: {grid.count} runs, {seeds}{names}"


def _value(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _cell(mean: float, half: float) -> str:
    if math.isnan(mean):
        return "-"
    return f"{mean:.4g}" if math.isnan(half) else f"{mean:.4g} +- {half:.2g}"
