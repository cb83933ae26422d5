"""The table of misfits: printed, as a CSV file, and for JSON."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sigmahat.compare.misfits.conditions import Group
from sigmahat.compare.misfits.job import Row, Score
from sigmahat.compare.table import with_headings
from sigmahat.files.tables import aligned, title, write_csv

FIGURES = tuple(Score().figures)  # names of the numbers of a score [%]
IN_FILE = {"wrong": "confident and over 20 % wrong"}  # titles in a file, if not the name


def table(rows: Sequence[Row]) -> str:
    """Formats the rows as text by group; each group ends with the means by joint."""
    cells = [["", *(title(name, "%") for name in FIGURES)]]
    headings: list[str] = []
    for group in Group:
        own = [row for row in rows if row.condition.group is group]
        cells += [
            [f"  {row.condition.name}, {row.joint.name}", *_cells(row.score.figures)] for row in own
        ]
        for joint in dict.fromkeys(row.joint.name for row in own):
            values = [row.score.figures for row in own if row.joint.name == joint]
            if len(values) > 1:
                means = {name: float(np.mean([v[name] for v in values])) for name in FIGURES}
                cells.append([f"  mean of {len(values)} rows, {joint}", *_cells(means)])
        headings += [group.value] * (len(cells) - 1 - len(headings))
    return with_headings(aligned(cells), headings)


def write(rows: Sequence[Row], seeds: int, path: Path) -> None:
    """Writes a line for every row, numbers with all digits."""
    head = ["class", "condition", "joint", "seeds", "prior of the torque gain [1]"]
    write_csv(
        path,
        [*head, *(title(IN_FILE.get(name, name), "%") for name in FIGURES)],
        (
            [*_about(row).values(), seeds, row.condition.torque_gain, *row.score.figures.values()]
            for row in rows
        ),
    )


def as_dicts(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """For JSON."""
    return [{**_about(row), **row.score.figures} for row in rows]


def _about(row: Row) -> dict[str, str]:
    condition = row.condition
    return {"class": condition.group.value, "condition": condition.name, "joint": row.joint.name}


def _cells(values: dict[str, float]) -> list[str]:
    digits = {"error": 2, "claim": 2}
    return [f"{value:.{digits.get(name, 1)}f}" for name, value in values.items()]
