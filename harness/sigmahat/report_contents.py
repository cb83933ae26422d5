"""What a report shows: tables and panels of traces, whatever they come from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

TRUE = "#8f8f8f"
COLORS = ("#1f83c4", "#12a37c", "#e06a1a", "#c9589b", "#b58900", "#56b4e9")
"""Okabe and Ito, shifted to be read on white and on black."""


@dataclass(frozen=True)
class Table:
    """Cells as text."""

    title: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True)
class Trace:
    """A line, or points, in one colour and with one switch."""

    label: str
    color: str
    x: NDArray[Any]
    y: NDArray[Any]
    kind: str = "line"
    """line; points; means, points with intervals; steps, y between edges x (one x more)."""
    half: NDArray[Any] | None = None
    """Half widths of the intervals of means."""
    width: float = 1.4


@dataclass(frozen=True)
class Panel:
    """A plot."""

    title: str
    x_label: str
    y_label: str
    traces: Sequence[Trace]
    x_log: bool = False
    y_log: bool = False
    linked: bool = True
    """Its x axis moves with those of the other panels that are linked."""
    y_range: tuple[float, float] | None = None
    """What is seen at first, where an estimate jumps while it learns."""


@dataclass(frozen=True)
class Contents:
    """All of a report."""

    title: str
    lines: Sequence[str]
    """Below the title."""
    tables: Sequence[Table]
    panels: Sequence[Panel]
    every: tuple[float, float] | None = None
    """Where every sample is drawn, if not everywhere."""


def number(value: object) -> str:
    """A cell for a value; "-" for what is not known."""
    if value is None or value == "":
        return "-"
    if not isinstance(value, float):
        return str(value)
    if np.isnan(value):
        return "-"
    return f"{value:.4g}"
