"""The received messages as a log: a Parquet file, which `sigmahat estimate` reads."""

from __future__ import annotations

import math
from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

_ROWS = 1 << 13
"""Rows of a row group: seconds of a log, which are written in milliseconds."""
_MISSING = -(2**63)

# With the first array, pyarrow imports an installed pandas. No sample should wait for this import.
pa.array(np.empty(0))


class Recording:
    """A row for each message; a column that a message lacks is empty in this row."""

    def __init__(self, path: Path, columns: Mapping[str, bool]) -> None:
        """Makes the file, which is complete after close(). Raises OSError if it cannot be written.

        columns  for each column, whether it has integers that a float64 does not hold
        """
        self.path = path
        self._missing = {n: _MISSING if whole else math.nan for n, whole in columns.items()}
        self._kinds = np.dtype([(n, "i8" if whole else "f8") for n, whole in columns.items()])
        kinds = [(n, pa.int64() if whole else pa.float64()) for n, whole in columns.items()]
        self._writer = pq.ParquetWriter(path, pa.schema(kinds))
        self._thread = ThreadPoolExecutor(1)  # so that no sample waits for the disk
        self._written: Future[None] | None = None
        self._rows, self._table = 0, np.empty(_ROWS, self._kinds)

    def add(self, row: Mapping[str, int | float]) -> None:
        """Adds the next message. Raises OSError if an earlier message could not be written."""
        self._table[self._rows] = tuple(row.get(n, none) for n, none in self._missing.items())
        self._rows += 1
        if self._rows == _ROWS:
            self._flush()

    def close(self) -> None:
        """Writes the remaining rows. Raises OSError if the file cannot be written."""
        self._flush()
        self._thread.shutdown()
        self._wait()
        self._writer.close()

    def _flush(self) -> None:
        self._wait()
        self._written = self._thread.submit(self._write, self._table[: self._rows])
        self._rows, self._table = 0, np.empty(_ROWS, self._kinds)

    def _wait(self) -> None:
        if self._written is not None:
            self._written.result()

    def _write(self, table: NDArray[Any]) -> None:
        columns = {n: np.ascontiguousarray(table[n]) for n in self._missing}
        arrays = [pa.array(each, mask=each == self._missing[n]) for n, each in columns.items()]
        self._writer.write_table(pa.Table.from_arrays(arrays, schema=self._writer.schema))
