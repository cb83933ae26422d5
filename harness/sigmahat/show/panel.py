"""Panels with curves as data: Matplotlib draws them for files, Bokeh for pages."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import NDArray

TRUE = "#8f8f8f"
"""Colour of the reference of an estimate."""
COLORS = ("#1f83c4", "#12a37c", "#e06a1a", "#c9589b", "#b58900", "#56b4e9")
"""Okabe and Ito, shifted to be read on white and on black."""


class TraceKind(Enum):
    LINE = "line"
    POINTS = "points"
    MEANS = "means"  # points with intervals, and a line through them
    STEPS = "steps"  # y between edges x: one more edge than values


@dataclass(frozen=True)
class Trace:
    """A line, or points, in one colour and with one switch."""

    label: str
    color: str
    x: NDArray[Any]
    y: NDArray[Any]
    kind: TraceKind = TraceKind.LINE
    band: tuple[NDArray[Any], NDArray[Any]] | None = None
    """Lower and upper ends of the 95 % intervals of the points of a line."""
    within: NDArray[np.bool_] | None = None
    """Points of the line in the range of the data, which are not paler; None: all points."""
    behind: tuple[NDArray[Any], NDArray[Any]] | None = None
    """Coordinates x and y of the points to which the line was fitted."""
    width: float = 1.4
    dash: tuple[float, ...] = ()  # lengths of dashes and gaps, in widths of the line; empty: none


@dataclass(frozen=True)
class Panel:
    title: str
    x_label: str
    y_label: str
    curves: Sequence[Trace]
    x_log: bool = False
    y_log: bool = False
    linked: bool = True  # whether the x axis moves with the x axes of the other linked panels
    caption: str = ""  # text below the title
    y_range: tuple[float, float] | None = None
    """Limits of y that are shown at first, for estimates that jump before they converge."""


FigureRows = Sequence[Sequence[Panel]]
"""The panels of a figure, from the top down; the panels of a row stand side by side."""
