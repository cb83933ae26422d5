"""The figure of misfits: the error of each row against its uncertainty sigma_std."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from sigmahat.compare.misfits.conditions import Group
from sigmahat.compare.misfits.experiment import JOINTS
from sigmahat.compare.misfits.job import DANGEROUS_CLAIM, DANGEROUS_ERROR, Row
from sigmahat.show.style import CYCLE

_MARKERS = dict(zip((joint.name for joint in JOINTS), "o^s", strict=True))
_COLORS = dict(zip(Group, CYCLE, strict=True))
_GREY = "#888888"
_LIMITS = 0.05, 100.0  # limits of both axes, wider if a row needs it [%]


def draw(rows: Sequence[Row]) -> Figure:
    """RMS error against RMS of sigma_std, a point for each row, and the dangerous corner."""
    figure = Figure(figsize=(8.0, 6.5), layout="constrained")
    axes = figure.subplots()
    points = [(row.score.figures["claim"], row.score.figures["error"]) for row in rows]
    values = [value for point in points for value in point if value > 0]
    limits = min(_LIMITS[0], 0.8 * min(values)), max(_LIMITS[1], 1.2 * max(values))
    axes.set(xscale="log", yscale="log", xlim=limits, ylim=limits)
    axes.set_xlabel("claim: RMS of sigma_std relative to the true stiffness [%]")
    axes.set_ylabel("RMS error relative to the true stiffness [%]")
    _regions(axes, limits)
    # Rows of no class, which are last, below the others.
    for row, point in zip(rows[::-1], points[::-1], strict=True):
        axes.plot(
            *point, marker=_MARKERS[row.joint.name], color=_COLORS[row.condition.group],
            markersize=5, markeredgewidth=0.5, markeredgecolor="white", linestyle="none",
            label=f"{row.condition.name}, {row.joint.name}",
        )  # fmt: skip
    figure.legend(handles=_legend(rows), loc="outside right upper", fontsize=8)
    return figure


def _regions(axes: Axes, limits: tuple[float, float]) -> None:
    """Draws the dangerous corner, and the line on which error and sigma_std are equal."""
    low, high = limits
    claim, error = 100 * DANGEROUS_CLAIM, 100 * DANGEROUS_ERROR
    axes.add_patch(Rectangle((low, error), claim - low, high - error, color=_GREY, alpha=0.25))
    corner = f"dangerous: over {error:g} % off,\nclaim under {claim:g} %"
    axes.text(1.3 * low, high / 1.3, corner, va="top")
    axes.plot(limits, limits, color=_GREY, linewidth=0.8, zorder=0)
    axes.text(high / 4, high / 6, "error = claim", color=_GREY, ha="center", va="top", rotation=45)


def _legend(rows: Sequence[Row]) -> list[Line2D | Patch]:
    joints = {row.joint.name for row in rows}
    groups = {row.condition.group for row in rows}
    markers = [
        Line2D([], [], color="#444444", marker=marker, linestyle="none", label=name)
        for name, marker in _MARKERS.items()
        if name in joints
    ]
    colors = [Patch(color=c, label=group.value) for group, c in _COLORS.items() if group in groups]
    return [*markers, *colors]
