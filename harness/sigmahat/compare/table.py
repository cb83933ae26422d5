"""The table of `sigmahat compare` (printed, as a file, for JSON), and its conditions in words."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sigmahat.compare.conditions import METHODS, REGRESSION, Case, Joint
from sigmahat.compare.job import MOTOR, Row
from sigmahat.files.tables import aligned, write_csv

_SIDES = {"": "device", "_1": "side 1", "_2": "side 2"}
_IN_FILE = {
    "msrep": "MSREP [%]",
    "sigma_std": "sigma_std [%]",
    "inside": "within 1.96 sigma_std [%]",
    "D_theta": "D_theta_hat [N.m.s/rad]",
    "B": "B_hat [kg.m2]",
    "tau_coulomb": "tau_coulomb_hat [N.m]",
}
"""Titles of the numbers of a row in the file, by their names in JSON."""


def group(row: Row) -> str:
    """Returns the heading of the group to which a row of the table belongs."""
    if not row.case.motor_errors:
        return "motor data exact, and taken as exact"
    if row.joint.lever_arm is None:
        return "antagonistic pair" if len(row.joint.parts) > 1 else "single transmission"
    friction = f", Coulomb friction {row.joint.coulomb:g} N.m" if row.joint.coulomb else ""
    return f"{lever_arm(row.joint)}{friction}"


def lever_arm(joint: Joint) -> str:
    return f"r(0) = {1e3 * (joint.lever_arm or 0.0):g} mm"


def motion(joint: Joint) -> str:
    """Describes a row by the scenario of the paper, or by the frequency of the motion."""
    return joint.scenario.name if joint.frequency is None else f"{joint.frequency:g} Hz"


def case(given: Case) -> str:
    """Describes the errors of the motor data that the estimators get."""
    errors = [f"{name} {100 * error:+.0f} %" for name, error in given.motor_errors.items()]
    if given.nominal_error is not None:
        errors.append(f"nominal curve {100 * given.nominal_error:+.0f} %")
    return ", ".join(errors) or "stiffness unknown"


def case_and_part(row: Row) -> str:
    """The case and, for a device with several stiffnesses, the stiffness."""
    words = case(row.case)
    return f"{words}, {_SIDES[row.part]}" if len(row.joint.parts) > 1 else words


def table(rows: Sequence[Row]) -> str:
    """Formats both methods side by side as text, by group of joints; "-": not defined.

    For FilteredRegression alone: sigma_std, the percentage of instants with an error of at most
    1.96 sigma_std, and the motor data at the end.
    """
    found = ("sigma_std [%]", "within [%]", "D_theta_hat", "B_hat", "tau_coulomb_hat")
    cells = [["", *(f"{method} [%]" for method in METHODS), *found]]
    for row in rows:
        regression = row.performance[REGRESSION]
        after = f", after {row.judged_from:g} s" if row.index.settled else ""
        cells.append(
            [
                f"  {motion(row.joint)}, {case_and_part(row)}{after}",
                *(f"{row.error(method):.3g}" for method in METHODS),
                f"{regression['sigma_std']:.2f}",
                f"{regression['inside']:.0f}",
                *("-" if math.isnan(regression[n]) else f"{regression[n]:.4g}" for n in MOTOR),
            ]
        )
    return with_headings(aligned(cells), list(map(group, rows)))


def with_headings(lines: Sequence[str], headings: Sequence[str]) -> str:
    """Yields the header, and then the lines of each group below the heading of the group."""
    text, above = [lines[0]], ""
    for line, heading in zip(lines[1:], headings, strict=True):
        if heading != above:
            text += ["", above := heading]
        text.append(line)
    return "\n".join(text)


def write(rows: Sequence[Row], seeds: int, path: Path) -> None:
    """Writes a line for every row and method, numbers with all digits."""
    head = ["group", "joint", "case", "method", "seeds", "judged from [s]", *_IN_FILE.values()]
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
    return group(row), motion(row.joint), case_and_part(row)


def _figures(row: Row, method: str) -> dict[str, float]:
    """The numbers of a row for a method, by their names in JSON."""
    found = {**row.performance[method], "msrep": row.error(method)}
    return {name: found[name] for name in _IN_FILE}
