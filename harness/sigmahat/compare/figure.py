"""The figure of `sigmahat compare`: error against the frequency of the motion."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from sigmahat.compare.conditions import METHODS, PAPER2011, REGRESSION
from sigmahat.compare.job import Row
from sigmahat.compare.table import case, lever_arm
from sigmahat.show.style import BLUE, VERMILION

_COLORS = {PAPER2011: VERMILION, REGRESSION: BLUE}
_MARKERS = "ovsD^"


def draw(rows: Sequence[Row]) -> Figure:
    """MSREP of both methods against frequency of the motion, for the AwAS with wrong motor data.

    Right: with Coulomb friction, too.
    """
    figure = Figure(figsize=(9.0, 5.0), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True).tolist()
    curves = curves_over_frequency(rows)
    handles: list[Line2D] = []
    for method in METHODS:
        for curve, marker in zip(curves, _MARKERS, strict=False):
            handles += _plot(panels[curve[0].joint.coulomb > 0], curve, method, marker)
    for axes, with_friction in zip(panels, (False, True), strict=True):
        shown = [curve[0] for curve in curves if (curve[0].joint.coulomb > 0) is with_friction]
        if shown:
            axes.set_title(_title(shown[0]), fontsize=9)
        axes.set(xscale="log", yscale="log", xlabel="frequency of the motor torque [Hz]")
    panels[0].set_ylabel("MSREP [%]")
    figure.legend(handles=handles, loc="outside lower center", ncols=2, fontsize=8)
    return figure


def curves_over_frequency(rows: Sequence[Row]) -> list[list[Row]]:
    """Rows of the AwAS with wrong motor data that differ in nothing but the frequency."""
    curves: dict[tuple[object, ...], list[Row]] = {}
    for row in rows:
        if row.joint.frequency is not None:
            errors = tuple(row.case.motor_errors.items())
            curves.setdefault((row.joint.lever_arm, row.joint.coulomb, errors), []).append(row)
    return list(curves.values())


def _plot(axes: Axes, curve: Sequence[Row], method: str, marker: str) -> list[Line2D]:
    first = curve[0]
    condition = "Coulomb friction" if first.joint.coulomb else lever_arm(first.joint)
    return axes.plot(
        [row.joint.frequency or 0.0 for row in curve], [row.error(method) for row in curve],
        color=_COLORS[method], marker=marker, markersize=4,
        linestyle="-" if first.case.motor_errors == {"D_theta": 0.1} else "--",
        label=f"{method}: {condition}, {case(first.case)}",
    )  # fmt: skip


def _title(row: Row) -> str:
    """Formats the title of a panel from the properties that all rows of the panel share."""
    if not row.joint.coulomb:
        return f"all {row.joint.scenario.duration:g} s"
    friction = rf"Coulomb friction {row.joint.coulomb:g} N$\cdot$m"
    return f"{friction}, {lever_arm(row.joint)}, after {row.judged_from:g} s"
