"""The results of the misfit study: printed table, CSV file, JSON, and panels."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sigmahat.experiments.scores import DANGEROUS_CLAIM, DANGEROUS_ERROR, SETTLED, Score
from sigmahat.files.tables import aligned, counted, title, with_headings, write_csv
from sigmahat.show.panel import Panel, Trace, TraceKind
from sigmahat.show.style import CYCLE
from sigmahat.studies.misfit_experiment import Condition, Group, JointKind

COLUMNS = ("error", "claim", "coverage", "dangerous", "confident", "wrong")
"""Numbers of a score in the table [%]."""
IN_FILE = {"wrong": "confident and over 20 % wrong"}  # titles in a file, if not the name
_COLORS = dict(zip(Group, CYCLE, strict=True))
_GREY = "#888888"
_LIMITS = 0.05, 100.0  # limits of both axes, wider if a row needs it [%]


@dataclass(frozen=True)
class MisfitRow:
    """The score of FilteredRegression on a kind of joint under a condition."""

    condition: Condition
    joint: JointKind
    score: Score  # over all instants of all seeds


def text(rows: Sequence[MisfitRow], seeds: int) -> str:
    """The table with its conditions; seeds: their number."""
    return (
        f"FilteredRegression on a catalogue of joints and misfits. Error, claim (sigma_std): RMS, "
        f"relative to the true\nstiffness. Coverage: fraction of instants with the truth within "
        f"1.96 sigma_std. Dangerous: over 10 % off while\nclaiming under 2 %. Wrong: "
        f"confident and over 20 % off. Instants after {SETTLED:g} s, outside of a dead zone, of\n"
        f"{counted(seeds, 'seed')}.\n\n{printed_table(rows)}"
    )


def printed_table(rows: Sequence[MisfitRow]) -> str:
    """Formats the rows as text by group; each group ends with the means by joint."""
    cells = [["", *(title(name, "%") for name in COLUMNS)]]
    headings: list[str] = []
    for group in Group:
        of_group = [row for row in rows if row.condition.group is group]
        cells += [
            [f"  {row.condition.name}, {row.joint.name}", *_cells(row.score.figures)]
            for row in of_group
        ]
        for joint in dict.fromkeys(row.joint.name for row in of_group):
            values = [row.score.figures for row in of_group if row.joint.name == joint]
            if len(values) > 1:
                means = {name: float(np.mean([v[name] for v in values])) for name in COLUMNS}
                cells.append([f"  mean of {len(values)} rows, {joint}", *_cells(means)])
        headings += [group.value] * (len(cells) - 1 - len(headings))
    return with_headings(aligned(cells), headings)


def write(rows: Sequence[MisfitRow], seeds: int, path: Path) -> None:
    """Writes a line for every row, numbers with all digits; seeds: their number."""
    head = ["class", "condition", "joint", "seeds", "prior of the torque gain [1]"]
    write_csv(
        path,
        [*head, *(title(IN_FILE.get(name, name), "%") for name in COLUMNS)],
        (
            [*_about(row).values(), seeds, row.condition.torque_gain, *_figures(row).values()]
            for row in rows
        ),
    )


def values(rows: Sequence[MisfitRow]) -> dict[str, Any]:
    """For JSON."""
    return {
        "units": dict.fromkeys(COLUMNS, "%"),
        "table": [{**_about(row), **_figures(row)} for row in rows],
    }


def panels(rows: Sequence[MisfitRow]) -> list[list[Panel]]:
    """RMS error against RMS of sigma_std by joint: a point for each row, a colour for each group.

    A row above the line of equal error and claim claims too much; rows in the corner behind the
    dotted line are dangerous.
    """
    points = [_figures(row)[name] for row in rows for name in ("claim", "error")]
    positive = [value for value in points if value > 0]
    low, high = min(_LIMITS[0], 0.8 * min(positive)), max(_LIMITS[1], 1.2 * max(positive))
    joints = dict.fromkeys(row.joint.name for row in rows)
    return [
        [_panel(joint, [row for row in rows if row.joint.name == joint], (low, high))]
        for joint in joints
    ]


def _panel(joint: str, rows: Sequence[MisfitRow], limits: tuple[float, float]) -> Panel:
    claim, error = 100 * DANGEROUS_CLAIM, 100 * DANGEROUS_ERROR
    low, high = limits
    ends = np.array(limits)
    corner = np.array([low, claim, claim]), np.array([error, error, high])
    curves = [
        Trace("error = claim", _GREY, ends, ends, width=0.8),
        Trace("dangerous", _GREY, *corner, dash=(1.0, 1.5)),
    ]
    for group in Group:
        of_group = [_figures(row) for row in rows if row.condition.group is group]
        if of_group:
            x = np.array([figures["claim"] for figures in of_group])
            y = np.array([figures["error"] for figures in of_group])
            curves.append(Trace(group.value, _COLORS[group], x, y, TraceKind.POINTS))
    return Panel(
        joint,
        "claim: RMS of sigma_std relative to the true stiffness [%]",
        "RMS error [%]",
        curves,
        x_log=True,
        y_log=True,
        linked=False,
        caption=f"{joint}; dangerous: over {error:g} % off, claim under {claim:g} %",
        y_range=limits,
    )


def _figures(row: MisfitRow) -> dict[str, float]:
    figures = row.score.figures
    return {name: figures[name] for name in COLUMNS}


def _about(row: MisfitRow) -> dict[str, str]:
    condition = row.condition
    return {"class": condition.group.value, "condition": condition.name, "joint": row.joint.name}


def _cells(figures: dict[str, float]) -> list[str]:
    digits = {"error": 2, "claim": 2}
    return [f"{figures[name]:.{digits.get(name, 1)}f}" for name in COLUMNS]
