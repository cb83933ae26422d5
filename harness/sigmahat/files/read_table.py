"""Tables that sigmahat wrote, read back: their columns with numbers, by name."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.csv
from numpy.typing import NDArray

from sigmahat.files import columns


@dataclass(frozen=True)
class NumericColumn:
    """A column of numbers."""

    unit: str | None
    values: NDArray[Any]
    """One for each row."""


def numeric_columns(table: pa.Table) -> dict[str, NumericColumn]:
    """The columns with numbers or true and false, as floats, by name without the unit."""
    found = {}
    for field in table.schema:
        if any(
            is_kind(field.type)
            for is_kind in (pa.types.is_floating, pa.types.is_integer, pa.types.is_boolean)
        ):
            name, unit = columns.name_and_unit(field.name)
            values = np.asarray(table[field.name].to_numpy(), dtype=np.float64)
            found[name] = NumericColumn(unit, values)
    return found


def read_csv(path: Path) -> pa.Table:
    """A table of text. Raises ValueError if the file is not CSV, OSError if there is none."""
    try:
        return pa.csv.read_csv(path)
    except (pa.ArrowInvalid, pa.ArrowKeyError) as error:
        raise ValueError(f"{path}: not readable as CSV; run the command that wrote it") from error
