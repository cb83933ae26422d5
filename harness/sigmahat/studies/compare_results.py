"""The results of `sigmahat compare`: its cases in words, printed table, CSV file, JSON, panels."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sigmahat.experiments.metrics import MSREP_IN_WORDS
from sigmahat.files.tables import (
    aligned,
    counted,
    name_and_unit,
    with_headings,
    write_csv,
)
from sigmahat.show.panel import Panel, Trace
from sigmahat.show.style import BLUE, VERMILION
from sigmahat.studies.compare_joint import (
    CALIBRATED,
    METHODS,
    MOTOR,
    PAPER2011,
    REGRESSION,
    TRUE,
    ComparisonRow,
    GivenData,
    MovingJoint,
)

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


def group(row: ComparisonRow) -> str:
    """Returns the heading of the group to which a row of the table belongs."""
    if not row.case.motor_errors:
        return "motor data exact, and taken as exact"
    if row.joint.lever_arm is None:
        return "antagonistic pair" if len(row.joint.parts) > 1 else "single transmission"
    friction = f", Coulomb friction {row.joint.coulomb:g} N.m" if row.joint.coulomb else ""
    return f"{lever_arm(row.joint)}{friction}"


def lever_arm(joint: MovingJoint) -> str:
    return f"r(0) = {1e3 * (joint.lever_arm or 0.0):g} mm"


def motion(joint: MovingJoint) -> str:
    """Describes a row by the scenario of the paper, or by the frequency of the motion."""
    return joint.scenario.name if joint.frequency is None else f"{joint.frequency:g} Hz"


def case(given: GivenData) -> str:
    """Describes the errors of the motor data that the estimators get."""
    errors = [f"{name} {100 * error:+.0f} %" for name, error in given.motor_errors.items()]
    if given.nominal_error is not None:
        errors.append(f"nominal curve {100 * given.nominal_error:+.0f} %")
    return ", ".join(errors) or "stiffness unknown"


def case_and_part(row: ComparisonRow) -> str:
    """The case and, for a device with several stiffnesses, the stiffness."""
    words = case(row.case)
    return f"{words}, {_SIDES[row.part]}" if len(row.joint.parts) > 1 else words


def text(rows: Sequence[ComparisonRow], seeds: int) -> str:
    """The table with its conditions; seeds: their number."""
    return (
        f"MSREP [%] of both methods. FilteredRegression from {CALIBRATED:g} s on: sigma_std\n"
        "relative to the true stiffness, and fraction of the time in which the error is below\n"
        "1.96 sigma_std. Estimated motor data at the end; the true ones are "
        f"{TRUE['D_theta']:g} N.m.s/rad\nand {TRUE['B']:g} kg.m2. "
        f"Mean over {counted(seeds, 'seed')}. {MSREP_IN_WORDS}.\n\n{printed_table(rows)}"
    )


def printed_table(rows: Sequence[ComparisonRow]) -> str:
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


def write(rows: Sequence[ComparisonRow], seeds: int, path: Path) -> None:
    """Writes a line for every row and method, numbers with all digits."""
    head = ["group", "joint", "case", "method", "seeds", "judged from [s]", *_IN_FILE.values()]
    lines = [
        [*_words(row), method, seeds, row.judged_from]
        + [None if math.isnan(value) else value for value in _figures(row, method).values()]
        for row in rows
        for method in METHODS
    ]
    write_csv(path, head, lines)


def values(rows: Sequence[ComparisonRow]) -> dict[str, Any]:
    """For JSON; nan becomes null."""
    units = {name: name_and_unit(title)[1] for name, title in _IN_FILE.items()}
    return {
        "units": {"after": "s", **units},
        "table": [
            {
                **dict(zip(("group", "joint", "case"), _words(row), strict=True)),
                "after": row.judged_from,
                "found": {method: _figures(row, method) for method in METHODS},
            }
            for row in rows
        ],
    }


def _words(row: ComparisonRow) -> tuple[str, str, str]:
    return group(row), motion(row.joint), case_and_part(row)


def _figures(row: ComparisonRow, method: str) -> dict[str, float]:
    """The numbers of a row for a method, by their names in JSON."""
    found = {**row.performance[method], "msrep": row.error(method)}
    return {name: found[name] for name in _IN_FILE}


_COLORS = {PAPER2011: VERMILION, REGRESSION: BLUE}
_DASHES = ((), (5.0, 2.0), (1.0, 1.5))  # of the curves of a method in a panel


def panels(rows: Sequence[ComparisonRow]) -> list[list[Panel]]:
    """MSREP of both methods against frequency of the motion, for the AwAS with wrong motor data.

    Bands are 95 % intervals over the seeds. Below: with Coulomb friction, too.
    """
    return [
        [_panel(curves)]
        for with_friction in (False, True)
        if (
            curves := [
                curve
                for curve in curves_over_frequency(rows)
                if (curve[0].joint.coulomb > 0) is with_friction
            ]
        )
    ]


def curves_over_frequency(rows: Sequence[ComparisonRow]) -> list[list[ComparisonRow]]:
    """FigureRows of the AwAS with wrong motor data that differ in nothing but the frequency."""
    curves: dict[tuple[object, ...], list[ComparisonRow]] = {}
    for row in rows:
        if row.joint.frequency is not None:
            errors = tuple(row.case.motor_errors.items())
            curves.setdefault((row.joint.lever_arm, row.joint.coulomb, errors), []).append(row)
    return list(curves.values())


def _panel(curves: Sequence[Sequence[ComparisonRow]]) -> Panel:
    """Draws curves over frequency of joints that all have Coulomb friction, or none."""
    first = curves[0][0]
    conditions = f"all {first.joint.scenario.duration:g} s"
    if first.joint.coulomb:
        friction = f"Coulomb friction {first.joint.coulomb:g} N·m"
        conditions = f"{friction}, {lever_arm(first.joint)}, after {first.judged_from:g} s"
    return Panel(
        conditions,
        "frequency of the motor torque [Hz]",
        "MSREP [%]",
        [
            _curve(curve, method, dash)
            for method in METHODS
            for curve, dash in zip(curves, _DASHES, strict=False)
        ],
        x_log=True,
        y_log=True,
        linked=False,
        caption=conditions,
    )


def _curve(rows: Sequence[ComparisonRow], method: str, dash: tuple[float, ...]) -> Trace:
    joint, given = rows[0].joint, rows[0].case
    what = case(given) if joint.coulomb else f"{lever_arm(joint)}, {case(given)}"
    mean = np.array([row.error(method) for row in rows])
    half_width = np.array([row.half_width[method] for row in rows])
    band = None
    if np.isfinite(half_width).all():
        # A logarithmic scale has no place for 0.
        band = np.maximum(mean - half_width, 1e-3 * mean), mean + half_width
    frequencies = np.array([row.joint.frequency for row in rows], np.float64)
    return Trace(f"{method}: {what}", _COLORS[method], frequencies, mean, band=band, dash=dash)
