"""The summary of a sweep: means over the seeds, printed, as a CSV file, and for JSON."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sigmahat.experiments.metrics import INDICES, Index, mean_interval
from sigmahat.files import tables
from sigmahat.paper.scenarios import SCENARIOS
from sigmahat.sweep.plan import Plan
from sigmahat.sweep.table import (
    ESTIMATION,
    FAILURE,
    SCENARIO,
    Column,
    Role,
    SweepTable,
    title,
)

_ROWS = 30  # rows of a printed summary; summary.csv has all rows


Mean = tuple[dict[str, Any], dict[Index, tuple[float, float]]]
"""A scenario with listed values and a comparison, by title, with the numbers of runs and of failed
runs. For each index: mean and half width of the 95 % interval, over runs that did not fail.
"""


@dataclass(frozen=True)
class SummaryColumn:
    """A column of the printed summary."""

    title: str
    words: bool  # whether its cells are words and not numbers
    cells: list[str]


def means(sweep: SweepTable) -> list[Mean]:
    """Computes the mean of each group of runs, in the order of the table."""
    keys: list[Column] = [SCENARIO, *sweep.parameters(Role.LISTED), ESTIMATION]
    groups: dict[tuple[Any, ...], list[int]] = {}
    for row, key in enumerate(zip(*(sweep.values(column) for column in keys), strict=True)):
        groups.setdefault(key, []).append(row)
    failures = sweep.values(FAILURE)
    indices = {index: sweep.values(index) for index in INDICES.values()}
    result = []
    for key, rows in groups.items():
        good = [row for row in rows if failures[row] is None]
        about = dict(zip(map(title, keys), key, strict=True))
        about |= {"runs": len(rows), "failed": len(rows) - len(good)}
        found = {index: mean_interval([x[row] for row in good]) for index, x in indices.items()}
        result.append((about, found))
    return result


def summary_columns(sweep: SweepTable) -> list[SummaryColumn]:
    """Formats the summary as text: mean +- half width of the 95 % interval.

    The columns are the indices in the tables of the scenarios.
    """
    every = means(sweep)
    columns = {name: [about[name] for about, _ in every] for name in every[0][0]}
    names = set(columns[SCENARIO])
    fields = {f for name in names for table in SCENARIOS[name].tables for f in table}
    if len(names) == 1:
        del columns[SCENARIO]
    if not any(columns["failed"]):
        del columns["failed"]
    found = [
        SummaryColumn(name, any(isinstance(v, (str, bool)) for v in own), [_value(v) for v in own])
        for name, own in columns.items()
    ]
    return found + [
        SummaryColumn(
            index.title("after start-up" if index.settled else ""),
            False,
            [_cell(*by_index[index]) for _, by_index in every],
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


def write_summary(sweep: SweepTable, path: Path) -> None:
    """Writes every mean and half width with all digits."""
    titles = []
    for index in INDICES.values():
        titles += [title(index), tables.title(f"{index.field} 95 % half width", index.unit)]
    every = means(sweep)
    rows = [
        [*about.values(), *(None if math.isnan(x) else x for pair in found.values() for x in pair)]
        for about, found in every
    ]
    tables.write_csv(path, [*every[0][0], *titles], rows)


def as_dicts(sweep: SweepTable) -> list[dict[str, object]]:
    """Returns the means as dictionaries for JSON; keys contain units."""
    return [
        about
        | {title(i): {"mean": mean, "95 % half width": half} for i, (mean, half) in found.items()}
        for about, found in means(sweep)
    ]


def conditions(plan: Plan) -> str:
    """Describes the number of runs of a plan in one line."""
    seeds = f"{plan.seeds} seed{'s' if plan.seeds > 1 else ''}"
    names = f"; {', '.join(plan.parameters)}" if plan.parameters else ""
    return f"{', '.join(plan.scenarios)}: {plan.count} runs, {seeds}{names}"


def _value(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _cell(mean: float, half: float) -> str:
    if math.isnan(mean):
        return "-"
    return f"{mean:.4g}" if math.isnan(half) else f"{mean:.4g} +- {half:.2g}"
