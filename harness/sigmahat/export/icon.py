"""Icons of the FMUs: ``model.png``, which importers show, and the same as SVG.

A motor is a disk, the link a bar, a transmission a spring between them; an estimate has a hat.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyBboxPatch, Rectangle

_INK = "#1d3557"
_SPRING = "#c1440e"
_PAPER = "#ffffff"
_PIXELS = 256


def _spring(axes: Axes, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Zigzag with straight ends between two points."""
    along = np.array([0, 0.14, *np.linspace(0.2, 0.8, 7), 0.86, 1])
    across = np.array([0, 0, *np.tile([1.0, -1.0], 4)[:7], 0, 0]) * 7
    direction = np.subtract(end, start)
    normal = np.array([-direction[1], direction[0]]) / np.hypot(*direction)
    points = np.array(start) + along[:, None] * direction + across[:, None] * normal
    axes.plot(*points.T, color=_SPRING, linewidth=7, solid_joinstyle="round", zorder=1)


def _motor(axes: Axes, x: float, y: float, radius: float = 14) -> None:
    axes.add_patch(Circle((x, y), radius, facecolor=_INK, edgecolor=_INK, zorder=2))
    axes.add_patch(Circle((x, y), radius / 3, facecolor=_PAPER, zorder=3))


def _link(axes: Axes, x: float, low: float, high: float) -> None:
    axes.add_patch(Rectangle((x - 6, low), 12, high - low, facecolor=_INK, zorder=2))


def _sigma(axes: Axes, text: str, y: float, size: float) -> None:
    axes.text(50, y, text, fontsize=size, color=_INK, ha="center", va="center")


def _single(axes: Axes, y: float = 50) -> None:
    _spring(axes, (22, y), (78, y))
    _motor(axes, 22, y)
    _link(axes, 80, y - 20, y + 20)


def _real(axes: Axes) -> None:
    """A single transmission, and above it the loop of its hysteresis."""
    _single(axes, 32)
    turn = np.linspace(0, 2 * np.pi, 100)
    axes.plot(50 + 30 * np.sin(turn), 74 + 14 * np.sin(turn - 0.7), color=_SPRING, linewidth=5)


def _antagonistic(axes: Axes, centre: float = 50, apart: float = 24) -> None:
    for y in (centre - apart, centre + apart):
        _spring(axes, (22, y), (78, y))
        _motor(axes, 22, y, 12)
    _link(axes, 80, centre - apart - 12, centre + apart + 12)


def _awas(axes: Axes) -> None:
    """A lever on the axis of the motor, with a spring to the link at an adjustable arm."""
    axes.plot([26, 26], [18, 88], color=_INK, linewidth=10, solid_capstyle="round", zorder=1)
    _motor(axes, 26, 20)
    _spring(axes, (26, 66), (78, 66))
    axes.add_patch(Circle((26, 66), 6, facecolor=_PAPER, edgecolor=_INK, linewidth=4, zorder=3))
    arrow = {"arrowstyle": "<|-|>", "color": _INK, "linewidth": 3, "mutation_scale": 18}
    axes.annotate("", (11, 90), (11, 44), arrowprops=arrow)
    _link(axes, 80, 12, 88)


def _estimator(axes: Axes) -> None:
    _sigma(axes, r"$\hat\sigma$", 65, 76)
    _single(axes, 26)


def _antagonistic_estimator(axes: Axes) -> None:
    _sigma(axes, r"$\hat\sigma_1{+}\hat\sigma_2$", 78, 40)
    _antagonistic(axes, 34, 15)


ICONS: dict[str, Callable[[Axes], None]] = {
    "StiffnessEstimator": _estimator,
    "AntagonisticStiffnessEstimator": _antagonistic_estimator,
    "AwasPlant": _awas,
    "FlexibleJointPlant": _single,
    "AntagonisticVsaPlant": _antagonistic,
    "RealJointPlant": _real,
}
"""What draws the icon of each FMU, on axes from 0 to 100."""


def write(name: str, png: Path, svg: Path) -> None:
    """Write the icon of an FMU as PNG of 256 x 256 pixels and as SVG without fonts.

    The same name gives the same bytes. Raises ``KeyError`` for an FMU without an icon.
    """
    figure = Figure(figsize=(_PIXELS / 100, _PIXELS / 100), dpi=100)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0, 100), ylim=(0, 100))
    axes.axis("off")
    frame = FancyBboxPatch((4, 4), 92, 92, boxstyle="round,pad=0,rounding_size=10")
    frame.set(facecolor=_PAPER, edgecolor=_INK, linewidth=4)
    axes.add_patch(frame)
    ICONS[name](axes)
    with mpl.rc_context({"svg.fonttype": "path", "svg.hashsalt": name}):
        figure.savefig(png, metadata={"Software": None}, transparent=True)
        figure.savefig(svg, metadata={"Date": None, "Creator": None}, transparent=True)
