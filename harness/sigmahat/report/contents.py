"""Contents of a report as data: lines of text, tables, and panels with curves."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sigmahat.files.tables import name_and_unit
from sigmahat.show.panel import Panel
from sigmahat.show.style import plain_title

if TYPE_CHECKING:
    import pyarrow as pa


REPORT = "report.html"  # name of the report in its folder of results


@dataclass(frozen=True)
class Link:
    """A line of a report that leads to another file."""

    text: str
    path: Path


@dataclass(frozen=True)
class TextTable:
    title: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    words: Container[int] = (0,)  # columns with words, aligned to the left, and not numbers
    note: str = ""  # text below the table
    folded: bool = False  # whether only its title is shown at first


@dataclass(frozen=True)
class Contents:
    title: str
    lines: Sequence[str]  # of text, below the title
    tables: Sequence[TextTable]
    panels: Sequence[Panel]
    headline: str = ""  # the result in one line, above all lines
    answer: Sequence[Panel] = ()  # panels above all other panels, and above the tables
    links: Sequence[Link] = ()  # lines below the other lines
    notes: Sequence[str] = ()  # sentences about the processing of the samples
    marks: Sequence[float] = ()  # times of dotted lines in the panels over time [s]
    whole: tuple[float, float] | None = None
    """Times between which every sample of longer signals is drawn [s]."""


def number(value: object) -> str:
    """Formats a value for a cell of a table; "-" for an undefined value."""
    if value is None or value == "":
        return "-"
    if not isinstance(value, float):
        return str(value)
    return "-" if np.isnan(value) else f"{value:.4g}"


def of_file(title: str, table: pa.Table) -> TextTable:
    """Converts a table with names and units as titles to a table of a report."""
    import pyarrow as pa

    columns = [[number(cell) for cell in column.to_pylist()] for column in table.columns]
    head = [plain_title(*name_and_unit(name)) for name in table.column_names]
    words = [i for i, field in enumerate(table.schema) if pa.types.is_string(field.type)]
    return TextTable(title, head, list(zip(*columns, strict=True)), words)
