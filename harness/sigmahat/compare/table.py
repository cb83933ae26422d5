"""The table of `sigmahat compare`: printed, as a CSV file, and for JSON."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sigmahat.compare import labels
from sigmahat.compare.conditions import METHODS, REGRESSION
from sigmahat.compare.job import Row
from sigmahat.compare.performance import Performance
from sigmahat.files.tables import aligned, write_csv


def table(rows: Sequence[Row]) -> str:
    """Both methods side by side, as text, a part for each group of joints; "-": not defined.

    For FilteredRegression alone: sigma_std, the percentage of instants with an error of at most
    1.96 sigma_std, and the motor data at the end.
    """
    cells = [
        [
            "",
            *(f"{method} [%]" for method in METHODS),
            "sigma_std [%]",
            "within [%]",
            "D_theta_hat",
            "B_hat",
            "tau_coulomb_hat",
        ]
    ]
    for row in rows:
        regression = row.performance[REGRESSION]
        motor = (regression.D_theta, regression.B, regression.tau_coulomb)
        after = f", after {row.judged_from:g} s" if row.index.settled else ""
        cells.append(
            [
                f"  {labels.motion(row.joint)}, {labels.case_and_part(row)}{after}",
                *(f"{row.error(method):.3g}" for method in METHODS),
                f"{regression.sigma_std:.2f}",
                f"{regression.inside:.0f}",
                *("-" if math.isnan(value) else f"{value:.4g}" for value in motor),
            ]
        )
    head, *lines = aligned(cells)
    text, above = [head], ""
    for row, line in zip(rows, lines, strict=True):
        if labels.group(row) != above:
            text += ["", above := labels.group(row)]
        text.append(line)
    return "\n".join(text)


def write(rows: Sequence[Row], seeds: int, path: Path) -> None:
    """Writes a line for every row and method, numbers with all digits."""
    head = [
        "group",
        "joint",
        "case",
        "method",
        "seeds",
        "judged from [s]",
        "MSREP [%]",
        "sigma_std [%]",
        "within 1.96 sigma_std [%]",
        "D_theta_hat [N.m.s/rad]",
        "B_hat [kg.m2]",
        "tau_coulomb_hat [N.m]",
    ]
    lines = [
        [*_words(row), method, seeds, row.judged_from]
        + [None if math.isnan(value) else value for value in _figures(row, method).values()]
        for row in rows
        for method in METHODS
    ]
    write_csv(path, head, lines)


def as_dicts(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """For JSON."""
    return [
        {
            **dict(zip(("group", "joint", "case"), _words(row), strict=True)),
            "after": row.judged_from,
            "found": {method: _figures(row, method) for method in METHODS},
        }
        for row in rows
    ]


def _words(row: Row) -> tuple[str, str, str]:
    return labels.group(row), labels.motion(row.joint), labels.case_and_part(row)


def _figures(row: Row, method: str) -> dict[str, float]:
    """The numbers of a row for a method, by their names in JSON."""
    own: Performance = row.performance[method]
    return {
        "msrep": row.error(method),
        "sigma_std": own.sigma_std,
        "inside": own.inside,
        "D_theta": own.D_theta,
        "B": own.B,
        "tau_coulomb": own.tau_coulomb,
    }
