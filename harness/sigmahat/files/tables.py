"""Formats titles of columns and lines of text, and writes and reads tables as CSV."""

from __future__ import annotations

import csv
from collections.abc import Container, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.files.output import whole_file

if TYPE_CHECKING:
    import pyarrow as pa


def title(name: str, unit: str | None) -> str:
    """Formats name and unit as a title; the title of a quantity without a unit is the name."""
    return f"{name} [{unit}]" if unit else name


def name_and_unit(title: str) -> tuple[str, str | None]:
    """Splits a title of a column into name and unit."""
    name, bracket, unit = title.rpartition(" [")
    return (name, unit.removesuffix("]")) if bracket else (title, None)


def write_csv(path: Path, head: Iterable[str], rows: Iterable[Iterable[Any]]) -> None:
    """Writes a table as whole_file() does, numbers with all digits; None is an empty field."""
    with whole_file(path) as whole, whole.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(rows)


def numeric_columns(table: pa.Table) -> dict[str, NDArray[np.float64]]:
    """Returns columns with numbers or flags as floats, by name without the unit."""
    from pyarrow import types

    kinds = (types.is_floating, types.is_integer, types.is_boolean)
    found = {}
    for field in table.schema:
        if any(is_kind(field.type) for is_kind in kinds):
            name, _ = name_and_unit(field.name)
            found[name] = np.asarray(table[field.name].to_numpy(), dtype=np.float64)
    return found


def read_csv(path: Path) -> pa.Table:
    """Reads a CSV table. Raises ValueError if the file is not CSV, OSError without a file."""
    from pyarrow import ArrowInvalid, ArrowKeyError, csv

    try:
        return csv.read_csv(path)
    except (ArrowInvalid, ArrowKeyError) as error:
        raise ValueError(f"{path}: not readable as CSV; run the command that wrote it") from error


def aligned(rows: Sequence[Sequence[str]], left: Container[int] = (0,)) -> list[str]:
    """Formats rows as lines of text; each column is as wide as its longest cell.

    rows  cells, all rows of the same length; the head is a row, too
    left  columns with cells aligned to the left; cells of other columns are aligned to the right
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.ljust(width) if i in left else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    ]


def with_headings(lines: Sequence[str], headings: Sequence[str]) -> str:
    """Joins a head and lines to a text; each group of lines stands below its heading.

    headings  the heading of each line after the head; equal neighbours are one group
    """
    text, above = [lines[0]], ""
    for line, heading in zip(lines[1:], headings, strict=True):
        if heading != above:
            text += ["", above := heading]
        text.append(line)
    return "\n".join(text)


def counted(count: int, noun: str) -> str:
    """Formats a number of things: 1 seed, 5 seeds."""
    return f"{count} {noun}{'s' if count > 1 else ''}"
