"""Defines a recorded log, independent of the file format."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from sigmahat.fmi.unknown_name import unknown
from sigmahat.recording.notes import RecordingNote


class LogError(ValueError):
    """An error in a log. The message states in one line the place, the expectation, the remedy."""


Array = NDArray[np.float64]
EXACT = 2**53  # largest magnitude up to which a float64 holds every integer


class Log(ABC):
    """Named columns of numbers, not always of the same length."""

    def __init__(self, path: Path, columns: Mapping[str, int]) -> None:
        self.path = path  #: The file.
        self.columns = columns  #: Number of samples of each column.
        self.units: dict[str, str] = {}  #: Of columns whose unit the file has beside the name.
        self.dates: set[str] = set()  #: Columns that the file stores as points in time.
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
