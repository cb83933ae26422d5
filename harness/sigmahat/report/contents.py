"""What a report shows, as data: lines of text, tables, and panels with curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.files.tables import name_and_unit
from sigmahat.plotting.style import plain_title

if TYPE_CHECKING:
    import pyarrow as pa

TRUE = "#8f8f8f"
"""Colour of what an estimate is compared with."""
COLORS = ("#1f83c4", "#12a37c", "#e06a1a", "#c9589b", "#b58900", "#56b4e9")
"""Okabe and Ito, shifted to be read on white and on black."""


@dataclass(frozen=True)
class TextTable:
    """Cells as text."""

    title: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    words: Sequence[bool]
    """Of each column, whether its cells are words, which stand at the left, and not numbers."""
    note: str = ""
    """Below the table."""
    folded: bool = False
    """Whether only its title is shown at first."""


class Kind(Enum):
    """How a curve is drawn."""

    LINE = "line"
    POINTS = "points"
    MEANS = "means"
    """Points with intervals, and a line through them."""
    STEPS = "steps"
    """y between edges x, of which there is one more."""


@dataclass(frozen=True)
class Curve:
    """A line, or points, in one colour and with one switch."""

    label: str
    color: str
    x: NDArray[Any]
    y: NDArray[Any]
    kind: Kind = Kind.LINE
    half: NDArray[Any] | None = None
    """Half widths of the intervals of means."""
    band: tuple[NDArray[Any], NDArray[Any]] | None = None
    """Lower and upper end of the intervals of a line."""
    within: NDArray[np.bool_] | None = None
    """Where a line is not faded, because the data reach it; None: everywhere."""
    behind: tuple[NDArray[Any], NDArray[Any]] | None = None
    """x and y of points that a line was fitted to."""
    width: float = 1.4

    @property
    def low(self) -> NDArray[Any]:
        """Lower ends of the intervals of means; a logarithmic scale has no place for 0."""
        assert self.half is not None
        low: NDArray[Any] = np.maximum(self.y - self.half, 0.1 * self.y)
        return low

    @property
    def high(self) -> NDArray[Any]:
        """Upper ends of the intervals of means."""
        assert self.half is not None
        high: NDArray[Any] = self.y + self.half
        return high


@dataclass(frozen=True)
class Panel:
    """A plot."""

    title: str
    x_label: str
    y_label: str
    curves: Sequence[Curve]
    x_log: bool = False
    y_log: bool = False
    linked: bool = True
    """Its x axis moves with those of the other panels that are linked."""
    caption: str = ""
    """Below its title."""
    y_range: tuple[float, float] | None = None
    """What is shown at first, where an estimate jumps before it converges."""


@dataclass(frozen=True)
class Contents:
    """All of a report."""

    title: str
    lines: Sequence[str]
    """Below the title."""
    tables: Sequence[TextTable]
    panels: Sequence[Panel]
    answer: Sequence[Panel] = ()
    """Panels that stand above all others, and above the tables."""
    notes: Sequence[str] = ()
    """What had to be done to the samples, in sentences."""
    pictures: Sequence[Path] = ()
    """PNG files."""
    every: tuple[float, float] | None = None
    """Times between which every sample is drawn [s]; None: everywhere."""


def number(value: object) -> str:
    """A cell for a value; "-" for one that is not defined."""
    if value is None or value == "":
        return "-"
    if not isinstance(value, float):
        return str(value)
    return "-" if np.isnan(value) else f"{value:.4g}"


def of_file(title: str, table: pa.Table) -> TextTable:
    """A table as it is in a file, whose titles are names and units."""
    import pyarrow as pa

    columns = [[number(cell) for cell in column.to_pylist()] for column in table.columns]
    return TextTable(
        title,
        [plain_title(*name_and_unit(name)) for name in table.column_names],
        list(zip(*columns, strict=True)),
        [pa.types.is_string(field.type) for field in table.schema],
    )
