"""The table of a sweep, a row for each run and comparison, in memory and as a Parquet file."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet
from numpy.typing import NDArray

from sigmahat.experiments.job import Outcome
from sigmahat.experiments.metrics import INDICES, Index
from sigmahat.experiments.scenario import PLANT, source_and_variable
from sigmahat.files import tables
from sigmahat.fmi.instance import installed
from sigmahat.fmi.model import Value
from sigmahat.studies.sweep_grid import Grid
from sigmahat.studies.sweep_scenario import ALL, models, parameters_by_owner, reduced

# Parameters of the nominal AwAS in the estimator, and their names in the plant.
_NAMES_IN_THE_PLANT = {"model.k_s": "spring.k_s", "model.r_0": "spring.r_0", "model.b": "spring.b"}


def name_in_the_plant(parameter: str) -> str:
    """Returns the name of the plant parameter that an estimator parameter describes."""
    return _NAMES_IN_THE_PLANT.get(parameter, parameter)


class ValueSource(str, Enum):
    """Kind of the values in a column of a parameter."""

    LISTED = "listed"  # values that are used with every seed
    DRAWN = "drawn"  # values that are drawn for each seed
    ERROR = "error"  # errors of a parameter of an estimator, relative to the parameter of the plant


@dataclass(frozen=True)
class ParameterColumn:
    role: ValueSource
    owner: str  # "plant", a modality, or "estimator": all estimators
    parameter: str  # name in the FMU, "motor.B"
    unit: str | None

    @property
    def name(self) -> str:
        """Name for people."""
        if self.role is ValueSource.ERROR:
            return f"error of {self.parameter}"
        return f"{self.owner}.{self.parameter}"

    def same_quantity(self, other: ParameterColumn) -> bool:
        """Returns whether two columns have the same parameter, of any owner."""
        return name_in_the_plant(self.parameter) == name_in_the_plant(other.parameter)


SweepColumn = str | ParameterColumn | Index
"""A text is the name of a column without a unit: run, scenario, seed, estimation, failure."""


def title(column: SweepColumn) -> str:
    """Formats the title of a column for tables and files."""
    if isinstance(column, str):
        return column
    name = column.field if isinstance(column, Index) else column.name
    return tables.title(name, column.unit)


RUN, SCENARIO, SEED, ESTIMATION, FAILURE = "run", "scenario", "seed", "estimation", "failure"
"""Columns of every sweep, in addition to columns of parameters and indices."""
_MEANING = b"sigmahat.column"


@dataclass(frozen=True)
class SweepTable:
    """Rows of a sweep, and the meaning of their columns."""

    table: pa.Table  # table with the titles of the columns as names
    columns: Sequence[SweepColumn]  # columns in the order of the table

    def parameters(self, *roles: ValueSource) -> list[ParameterColumn]:
        """Returns the columns of parameters with the given roles."""
        return [
            column
            for column in self.columns
            if isinstance(column, ParameterColumn) and column.role in roles
        ]

    def values(self, column: SweepColumn) -> list[Any]:
        values: list[Any] = self.table[title(column)].to_pylist()
        return values

    def numbers(self, column: SweepColumn) -> NDArray[np.float64]:
        return np.asarray(self.table[title(column)].to_numpy(), dtype=np.float64)

    def where(self, rows: Sequence[bool]) -> SweepTable:
        """Returns a table with the selected rows only."""
        return SweepTable(self.table.filter(pa.array(rows, pa.bool_())), self.columns)


_FAILED = dict.fromkeys(INDICES, math.nan)


def of_outcomes(grid: Grid, outcomes: Sequence[Outcome]) -> SweepTable:
    """Creates the table of a complete sweep from its outcomes, in the order of the grid."""
    scenarios = {name: reduced(name, grid.modalities) for name in grid.scenarios}
    usual = {
        name: {o: installed(m.fmu).parameters(m.start) for o, m in models(each).items()}
        for name, each in scenarios.items()
    }
    parameters: dict[str, ParameterColumn] = {}
    first = models(scenarios[grid.scenarios[0]])
    for full in grid.parameters:
        owner, _, name = full.partition(".")
        model = first[next(each for each in first if each != PLANT) if owner == ALL else owner]
        role = ValueSource.LISTED if full in grid.listed else ValueSource.DRAWN
        unit = installed(model.fmu).variable(name).unit
        parameters[full] = ParameterColumn(role, owner, name, unit)
    swept = {name_in_the_plant(each.parameter) for each in parameters.values()}
    errors = dict.fromkeys(
        ParameterColumn(ValueSource.ERROR, ALL, name, "%")
        for own in usual.values()
        for owner, values in own.items()
        for name in values
        if owner != PLANT and name_in_the_plant(name) in swept & own[PLANT].keys()
    )
    order: list[SweepColumn] = [RUN, SCENARIO, SEED, *parameters.values(), *errors]
    columns: dict[SweepColumn, list[Any]] = {
        column: [] for column in (*order, ESTIMATION, *INDICES.values(), FAILURE)
    }
    for run, outcome in zip(grid.runs, outcomes, strict=True):
        chosen = parameters_by_owner(run.parameters, scenarios[run.scenario])
        given = {o: {**own, **chosen[o]} for o, own in usual[run.scenario].items()}
        for comparison in scenarios[run.scenario].comparisons:
            estimator, _ = source_and_variable(comparison.estimate)
            indices = outcome.rows.get(comparison.name, _FAILED)
            row: dict[SweepColumn, Any] = {
                RUN: run.number,
                SCENARIO: run.scenario,
                SEED: run.seed,
                **{column: run.parameters[name] for name, column in parameters.items()},
                **{each: _error(each.parameter, given[estimator], given[PLANT]) for each in errors},
                ESTIMATION: comparison.name,
                **{index: indices[field] for field, index in INDICES.items()},
                FAILURE: outcome.failures.get(comparison.name),
            }
            for column, values in columns.items():
                values.append(row[column])
    arrays = [_array(column, values) for column, values in columns.items()]
    fields = [
        pa.field(title(column), array.type, metadata=_meaning(column))
        for column, array in zip(columns, arrays, strict=True)
    ]
    return SweepTable(pa.table(arrays, pa.schema(fields)), list(columns))


def _error(name: str, estimator: Mapping[str, Value], plant: Mapping[str, Value]) -> float:
    """Error of a parameter, relative to the plant [%]; nan if the plant has 0 or no such value."""
    true = float(plant.get(name_in_the_plant(name), 0.0))
    return (float(estimator[name]) / true - 1) * 100 if true and name in estimator else math.nan


def _meaning(column: SweepColumn) -> dict[bytes, str] | None:
    """Returns metadata of a file column, because a title does not describe a parameter fully."""
    if not isinstance(column, ParameterColumn):
        return None
    return {_MEANING: json.dumps({"parameter": asdict(column)})}


def _column(field: pa.Field) -> SweepColumn:
    """Reads a column of a file. Raises KeyError, TypeError or ValueError for wrong metadata."""
    meaning = json.loads((field.metadata or {}).get(_MEANING, "{}"))
    if "parameter" in meaning:
        parameter = meaning["parameter"]
        return ParameterColumn(**{**parameter, "role": ValueSource(parameter["role"])})
    return {title(index): index for index in INDICES.values()}.get(field.name, str(field.name))


def _array(column: SweepColumn, values: Sequence[Any]) -> pa.Array:
    if column == FAILURE:
        return pa.array(values, pa.string())
    if {type(value) for value in values} == {int, float}:
        return pa.array([float(value) for value in values])
    return pa.array(values)


def write(sweep: SweepTable, path: Path) -> None:
    """Writes a table as Parquet; equal tables give equal bytes."""
    pa.parquet.write_table(sweep.table, path)


def read(path: Path) -> SweepTable:
    """Reads a table from write(). Raises ValueError for other files, OSError without a file."""
    try:
        table = pa.parquet.read_table(path)
        columns = [_column(field) for field in table.schema]
        if not {RUN, FAILURE} <= set(columns):
            raise KeyError(RUN)
    except (pa.ArrowInvalid, KeyError, TypeError, ValueError, OSError) as error:
        if not path.exists():
            raise
        raise ValueError(f"{path}: expected the table of a sweep; run the sweep again") from error
    return SweepTable(table, columns)
