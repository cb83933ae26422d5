"""What was received as a log: a Parquet file, which `sigmahat estimate` reads."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

_ROWS = 1 << 13
"""Of a row group: seconds, so that writing it takes milliseconds."""
_MISSING = -(2**63)

# With the first array pyarrow imports pandas, where there is one. No sample should wait for that.
pa.array(np.empty(0))


class Recording:
    """A row for each message; a column that a message lacks is empty there."""

    def __init__(self, path: Path, columns: Sequence[str], whole: Collection[str]) -> None:
        """Makes the file, which is complete after close(). Raises OSError if it cannot be written.

        whole  columns of whole numbers that a float64 does not hold
        """
        self.path = path
        self._numbers = [name for name in columns if name not in whole]
        self._whole = [name for name in columns if name in whole]
        kinds = [
            *[(n, pa.float64()) for n in self._numbers],
            *[(n, pa.int64()) for n in self._whole],
        ]
        self._writer = pq.ParquetWriter(path, pa.schema(kinds))
        self._thread = ThreadPoolExecutor(1)  # so that no sample waits for the disk
        self._written: Future[None] | None = None
        self._begin()

    def _begin(self) -> None:
        self._rows = 0
        self._of_numbers = np.empty((_ROWS, len(self._numbers)))
        self._of_whole = np.empty((_ROWS, len(self._whole)), np.int64)

    def add(self, row: Mapping[str, int | float]) -> None:
        """The columns of the next message. Raises OSError if an earlier one was not written."""
        self._of_numbers[self._rows] = [row.get(name, math.nan) for name in self._numbers]
        self._of_whole[self._rows] = [row.get(name, _MISSING) for name in self._whole]
        self._rows += 1
        if self._rows == _ROWS:
            self._flush()

    def close(self) -> None:
        """Writes what is left. Raises OSError if it cannot be written."""
        self._flush()
        self._thread.shutdown()
        self._wait()
        self._writer.close()

    def _flush(self) -> None:
        self._wait()
        rows = self._rows
        self._written = self._thread.submit(
            self._write, self._of_numbers[:rows], self._of_whole[:rows]
        )
        self._begin()

    def _wait(self) -> None:
        if self._written is not None:
            self._written.result()

    def _write(self, numbers: NDArray[np.float64], whole: NDArray[np.int64]) -> None:
        arrays = [pa.array(np.ascontiguousarray(column)) for column in numbers.T]
        arrays += [pa.array(column, mask=column == _MISSING) for column in whole.T]
        self._writer.write_table(pa.Table.from_arrays(arrays, schema=self._writer.schema))
