"""The table of a sweep, a row for each run and comparison, in memory and as a Parquet file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet
from numpy.typing import NDArray

from sigmahat.sweep.columns import Column, ParameterColumn, Role, decoded, encoded, title

RUN, SCENARIO, SEED, ESTIMATION, FAILURE = "run", "scenario", "seed", "estimation", "failure"
"""Columns that every sweep has, together with those of parameters and indices."""
_MEANING = b"sigmahat.column"


@dataclass(frozen=True)
class SweepTable:
    """Rows of a sweep, and what their columns are."""

    table: pa.Table
    """With the titles of the columns as names."""
    columns: Sequence[Column]
    """In the order of the table."""

    def parameters(self, *roles: Role) -> list[ParameterColumn]:
        """Columns of parameters with these roles."""
        return [
            column
            for column in self.columns
            if isinstance(column, ParameterColumn) and column.role in roles
        ]

    def values(self, column: Column) -> list[Any]:
        """Of each row."""
        values: list[Any] = self.table[title(column)].to_pylist()
        return values

    def numbers(self, column: Column) -> NDArray[np.float64]:
        """Of each row, of a column with numbers."""
        return np.asarray(self.table[title(column)].to_numpy(), dtype=np.float64)

    def where(self, rows: Sequence[bool]) -> SweepTable:
        """Some of the rows."""
        return SweepTable(self.table.filter(pa.array(rows, pa.bool_())), self.columns)


def from_columns(columns: dict[Column, list[Any]]) -> SweepTable:
    """A table of columns of one length, by what they are."""
    arrays = {column: _array(column, values) for column, values in columns.items()}
    fields = [
        pa.field(title(column), array.type, metadata={_MEANING: encoded(column)})
        for column, array in arrays.items()
    ]
    return SweepTable(pa.table(list(arrays.values()), pa.schema(fields)), list(columns))


def _array(column: Column, values: Sequence[Any]) -> pa.Array:
    if column == FAILURE:
        return pa.array(values, pa.string())
    if {type(value) for value in values} == {int, float}:
        return pa.array([float(value) for value in values])
    return pa.array(values)


def write(sweep: SweepTable, path: Path) -> None:
    """Writes Parquet; the same table gives the same bytes."""
    pa.parquet.write_table(sweep.table, path)


def read(path: Path) -> SweepTable:
    """Reads what write() wrote. Raises ValueError for another file, OSError if there is none."""
    try:
        table = pa.parquet.read_table(path)
        columns = [decoded(field.metadata[_MEANING]) for field in table.schema]
    except (pa.ArrowInvalid, KeyError, TypeError, ValueError, OSError) as error:
        if not path.exists():
            raise
        raise ValueError(f"{path}: not the table of a sweep; run the sweep again") from error
    return SweepTable(table.rename_columns([title(column) for column in columns]), columns)
