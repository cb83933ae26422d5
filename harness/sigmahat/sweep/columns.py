"""The columns of a sweep's table: each has a title for people, and its meaning as data.

Parquet files store the meaning of a column with it, so that no title has to be taken apart.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from enum import Enum

from sigmahat.files import columns
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
    return columns.title(name, column.unit)


def half_width_title(index: Index) -> str:
    """Of the column with half the width of the 95 % interval of a mean."""
    return columns.title(f"{index.field} 95 % half width", index.unit)


def encoded(column: Column) -> str:
    """The meaning of a column as JSON."""
    if isinstance(column, ParameterColumn):
        return json.dumps({"parameter": asdict(column)})
    return json.dumps({"index": column.field} if isinstance(column, Index) else {"name": column})


def decoded(text: str) -> Column:
    """What encoded() was given. Raises KeyError, TypeError or ValueError for another text."""
    content = json.loads(text)
    if "parameter" in content:
        parameter = content["parameter"]
        return ParameterColumn(**{**parameter, "role": Role(parameter["role"])})
    return INDICES[content["index"]] if "index" in content else str(content["name"])
