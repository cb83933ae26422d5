"""Defines a recorded log, independent of the file format, and limits for the size of the columns.

A compressed file of some kilobytes can expand to many gigabytes, which would fill the memory.
Recorded data never compress so strongly. Each limit has a lower bound, so that a file of usual size
is always accepted.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute
from numpy.typing import NDArray

from sigmahat.fmi.unknown_name import unknown
from sigmahat.recording.notes import RecordingNote


class LogError(ValueError):
    """An error in a log. The message states in one line the place, the expectation, the remedy."""


Array = NDArray[np.float64]
_NO_TEXT = r"^\s*([+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(?i:nan|inf|infinity))?\s*$"
"""Pattern of an empty cell, or of a number in the notation of Python."""
_SHOWN = 100  # characters of a cell that an error message shows
_PER_SECOND = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}  # units of timestamps
EXACT = 2**53  # largest magnitude up to which a float64 holds every integer


class Log(ABC):
    """Named columns of numbers, not always of the same length."""

    def __init__(self, path: Path, columns: Mapping[str, int]) -> None:
        self.path = path  #: The file.
        self.columns = columns  #: Number of samples of each column.
        self.notes: list[RecordingNote] = []  #: On reading the file.

    def read(self, name: str) -> Array:
        """Reads one column [size: samples]; nan where a sample is missing.

        Dates and times become seconds since the first row. Integers beyond 2^53, such as
        nanoseconds since 1970, are counted from the first value. Raises LogError for an unknown
        column, or for a column that does not contain numbers.
        """
        self.samples(name)
        values = self._read(name)
        pa.default_memory_pool().release_unused()  # the pool would keep the column
        return values

    def samples(self, name: str) -> int:
        """Number of samples of a column. Raises LogError if there is no such column."""
        if name not in self.columns:
            raise LogError(f"{self.path}: {unknown('column', name, self.columns)}")
        return self.columns[name]

    @abstractmethod
    def _read(self, name: str) -> Array:
        """Reads one column for read(), which has checked that the column exists."""

    @abstractmethod
    def batches(self, names: Sequence[str], rows: int) -> Iterator[pa.RecordBatch]:
        """Yields columns of equal length unconverted, at most `rows` rows at a time."""


class LogInMemory(Log):
    """A log that is read as a whole when it is opened."""

    def __init__(self, path: Path, arrays: Mapping[str, NDArray[np.generic]]) -> None:
        super().__init__(path, {name: len(array) for name, array in arrays.items()})
        self._arrays = arrays

    def _read(self, name: str) -> Array:
        array = self._arrays[name]
        if array.dtype.kind in "iu" and len(array) and np.abs(array).max() > EXACT:
            array = array.astype(np.int64) - array.astype(np.int64)[0]
        return array.astype(np.float64)

    def batches(self, names: Sequence[str], rows: int) -> Iterator[pa.RecordBatch]:
        for first in range(0, max(self.columns[name] for name in names), rows):
            yield pa.record_batch(
                {name: pa.array(self._arrays[name][first : first + rows]) for name in names}
            )


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
        raise LogError(f"{path}: column {name!r} holds {kind}, expected numbers")
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
    is_text = pa.compute.invert(pa.compute.match_substring_regex(column, _NO_TEXT))
    row = pa.compute.index(is_text, True).as_py()
    return None if row < 0 else (row + 1, column[row].as_py()[:_SHOWN])


def holds_text(path: Path, name: str, row: int, text: str) -> LogError:
    """Creates the error for a column that contains text in the given row."""
    return LogError(f"{path}: column {name!r} holds text ({text!r} in row {row}), expected numbers")


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


MOST_COLUMNS = 2000
_NUMBERS, _SMALL = 15_000_000, 10_000_000  # allowed numbers in a file up to this size [bytes]
_TOGETHER = 2  # factor of the limit if all columns are in memory at the same time
_NUMBERS_PER_BYTE = 3  # limit for further bytes; without compression, at most 1 is possible
_BYTES = 400_000_000  # limit for all columns of a file that is read as a whole
MOST_TEXT = 100_000_000  # characters of a column of text at a time


def _most_numbers(path: Path) -> int:
    """Returns the allowed number of values in a column of a file, by the size of the file."""
    files = path.iterdir() if path.is_dir() else (path,)  # the folder of a bag
    size = sum(file.stat().st_size for file in files)
    return _NUMBERS + _NUMBERS_PER_BYTE * max(0, size - _SMALL)


def check_together(path: Path, numbers: int) -> None:
    """Raises LogError for too many numbers in all columns together, which share the memory."""
    # For fewer numbers, the size of the file does not matter.
    if numbers > _TOGETHER * _NUMBERS and numbers > (most := _TOGETHER * _most_numbers(path)):
        raise LogError(
            f"{path}: expected at most {most} numbers, got {numbers}; "
            "save only the columns of one joint, or fewer rows"
        )


def check_columns(path: Path, columns: int) -> None:
    """Raises LogError for too many columns."""
    if columns > MOST_COLUMNS:
        raise LogError(
            f"{path}: expected at most {MOST_COLUMNS} columns, got {columns}; "
            "save only the columns of one joint"
        )


def check_numbers(path: Path, numbers: int) -> None:
    """Raises LogError for more numbers in a column than the size of the file allows."""
    # For fewer numbers, the size of the file is not needed: the file may be deleted already.
    if numbers > _NUMBERS and numbers > _most_numbers(path):
        raise LogError(
            f"{path}: expected at most {_most_numbers(path)} numbers in a file of this size, got "
            f"{numbers} or more; save it without compression, or in parts"
        )


def check_bytes(path: Path, size: int) -> None:
    """Raises LogError if columns that are read at once would need too much memory [bytes]."""
    most = max(_BYTES, 8 * _most_numbers(path))
    if size > most:
        raise LogError(
            f"{path}: expected at most {most / 1e6:.0f} MB of data in a file of this size, got "
            f"{size / 1e6:.0f} MB; save it without compression, or in parts"
        )
