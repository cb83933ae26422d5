"""Converts columns of Arrow to numbers."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute

from sigmahat.fmi.quoted import quoted
from sigmahat.recording.log import EXACT, Array, LogError

_NO_TEXT = r"^\s*([+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(?i:nan|inf|infinity))?\s*$"
"""Pattern of an empty cell, or of a number in the notation of Python."""
MISSING = (
    *("", "-", "--", "---", "NA", "N/A", "n/a", "n.a.", "#N/A", "#NA", "#N/A N/A", "<NA>"),
    *("NULL", "null", "None", "none", "NaN", "nan", "-NaN", "-nan", "missing", "?"),
    *("1.#QNAN", "-1.#QNAN", "1.#IND", "-1.#IND", "1.#INF", "-1.#INF"),
    *("#VALUE!", "#DIV/0!", "#REF!", "#NUM!", "#NAME?", "#NULL!"),
)
"""Texts that programs write in place of a number that they do not have."""
_SHOWN = 100  # characters of a cell that an error message shows
_PER_SECOND = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}  # units of timestamps


def numbers(path: Path, name: str, column: pa.ChunkedArray) -> Array:
    """Converts an Arrow column for Log.read(). Raises LogError for a column without numbers."""
    kind = column.type
    if pa.types.is_timestamp(kind):
        ticks = column.cast(pa.int64())
        first = next((x.as_py() for x in ticks if x.is_valid), 0)
        return numbers(path, name, pa.compute.subtract(ticks, first)) / _PER_SECOND[kind.unit]
    if pa.types.is_string(kind) or pa.types.is_large_string(kind):
        raise holds_text(path, name, *(first_text(column) or (1, "")))
    if pa.types.is_null(kind):
        return np.full(len(column), np.nan)
    if not (pa.types.is_floating(kind) or pa.types.is_integer(kind) or pa.types.is_boolean(kind)):
        raise LogError(f"{path}: column {quoted(name)} holds {kind}, expected numbers")
    if pa.types.is_integer(kind) and not fits_float64(column):
        column = column.cast(pa.int64(), safe=False)  # large uint64 become negative
        first = next(x.as_py() for x in column if x.is_valid)
        column = pa.compute.subtract(column, first)
    values, row = np.empty(len(column)), 0
    for chunk in column.chunks:  # to_numpy() of a column imports pandas, which takes long
        batch = pa.record_batch([chunk.cast(pa.float64(), safe=False)], [name])
        values[row : row + len(chunk)] = batch.to_tensor(null_to_nan=True).to_numpy()[:, 0]
        row += len(chunk)
    return values


def first_text(column: pa.ChunkedArray) -> tuple[int, str] | None:
    """Finds the first cell that is no number: row, from 1 on, and text; None if there is none."""
    is_number = pa.compute.match_substring_regex(column, _NO_TEXT)
    is_missing = pa.compute.is_in(column, value_set=pa.array(MISSING, column.type))
    is_text = pa.compute.invert(pa.compute.or_(is_number, is_missing))
    row = pa.compute.index(is_text, True).as_py()
    return None if row < 0 else (row + 1, column[row].as_py()[:_SHOWN])


def holds_text(path: Path, name: str, row: int, text: str) -> LogError:
    """Creates the error for a column that contains text in the given row."""
    return LogError(
        f"{path}: column {quoted(name)} holds text ({quoted(text)} in row {row}), expected numbers"
    )


def fits_float64(column: pa.ChunkedArray) -> bool:
    """Returns whether a float64 holds every integer of a column, unlike nanoseconds since 1970."""
    ends = pa.compute.min_max(column).as_py()
    return ends["min"] is None or max(abs(ends["min"]), abs(ends["max"])) <= EXACT


def is_number(text: str) -> bool:
    """Returns whether a text is a number in the notation of Python."""
    try:
        float(text)
    except ValueError:
        return False
    return True
