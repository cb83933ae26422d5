"""The table of a sweep, a row for each run and comparison, in memory and as a Parquet file."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet
from numpy.typing import NDArray

from sigmahat.files import tables
from sigmahat.runs.metrics import INDICES, Index

# Parameters of the nominal AwAS in the estimator, and what the plant calls them.
_NAMES_IN_THE_PLANT = {
    "model.k_s": "spring.k_s",
    "model.r_0": "spring.r_0",
    "model.b": "spring.b",
}


def name_in_the_plant(parameter: str) -> str:
    """What the plant calls a parameter of an estimator, if it has it."""
    return _NAMES_IN_THE_PLANT.get(parameter, parameter)


class Role(str, Enum):
    """What a column of a parameter holds."""

    LISTED = "listed"
    """Values that every seed runs with."""
    DRAWN = "drawn"
    """Values that are drawn for each seed."""
    ERROR = "error"
    """Relative errors of a parameter of an estimator, compared with that of the plant."""


@dataclass(frozen=True)
class ParameterColumn:
    """A column of a parameter."""

    role: Role
    owner: str
    """"plant", a modality, or "estimator": each of them."""
    parameter: str
    """Name in the FMU, "motor.B"."""
    unit: str | None

    @property
    def name(self) -> str:
        """For people."""
        if self.role is Role.ERROR:
            return f"error of {self.parameter}"
        return f"{self.owner}.{self.parameter}"

    def same_quantity(self, other: ParameterColumn) -> bool:
        """Whether both are of one parameter, whoever owns it."""
        return name_in_the_plant(self.parameter) == name_in_the_plant(other.parameter)


Column = str | ParameterColumn | Index
"""A text is the name of a column without a unit: run, scenario, seed, estimation, failure."""


def title(column: Column) -> str:
    """Of a column, in tables and files."""
    if isinstance(column, str):
        return column
    name = column.field if isinstance(column, Index) else column.name
    return tables.title(name, column.unit)


def half_width_title(index: Index) -> str:
    """Of the column with half the width of the 95 % interval of a mean."""
    return tables.title(f"{index.field} 95 % half width", index.unit)


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
    arrays = [_array(column, values) for column, values in columns.items()]
    fields = [
        pa.field(title(column), array.type, metadata=_meaning(column))
        for column, array in zip(columns, arrays, strict=True)
    ]
    return SweepTable(pa.table(arrays, pa.schema(fields)), list(columns))


def _meaning(column: Column) -> dict[bytes, str] | None:
    """What a file says of a column, whose title does not say all of a parameter."""
    if not isinstance(column, ParameterColumn):
        return None
    return {_MEANING: json.dumps({"parameter": asdict(column)})}


def _column(field: pa.Field) -> Column:
    """A column of a file. Raises KeyError, TypeError or ValueError for another meaning."""
    meaning = json.loads((field.metadata or {}).get(_MEANING, "{}"))
    if "parameter" in meaning:
        parameter = meaning["parameter"]
        return ParameterColumn(**{**parameter, "role": Role(parameter["role"])})
    return {title(index): index for index in INDICES.values()}.get(field.name, str(field.name))


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
        columns = [_column(field) for field in table.schema]
        if not {RUN, FAILURE} <= set(columns):
            raise KeyError(RUN)
    except (pa.ArrowInvalid, KeyError, TypeError, ValueError, OSError) as error:
        if not path.exists():
            raise
        raise ValueError(f"{path}: not the table of a sweep; run the sweep again") from error
    return SweepTable(table, columns)
