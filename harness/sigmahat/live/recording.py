"""Records the messages of a stream as CSV, which is readable up to the last seconds at any time.

Whatever ends the process, the rows that were written stay. A format with a footer, such as Parquet,
would be lost as a whole.
"""

import hashlib
import math
import os
import time
from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from io import FileIO
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.csv
from numpy.typing import NDArray

from sigmahat.files.output import write_whole
from sigmahat.live.messages import Columns

_EVERY = 1.0  # [s] between two writes
_ROWS = 1 << 16  # most rows that wait to be written
_MISSING = -(2**63)

# With the first array, pyarrow imports an installed pandas. No sample should wait for this import.
pa.array(np.empty(0))


class Recording:
    """A CSV file with a row for each message, and its configuration beside it; missing values are
    empty cells.

    A thread writes, so that no sample waits for the disk. After an error, the file keeps its last
    whole row, and further rows are left out.
    """

    def __init__(self, path: Path, columns: Mapping[str, bool], configuration: str) -> None:
        """columns        for each column, whether it has integers that a float64 does not hold
        configuration  contents of the file beside it, with the suffix .toml
        """
        self.path = path
        self._digest = hashlib.sha256()
        self._missing = {n: _MISSING if whole else math.nan for n, whole in columns.items()}
        self._kinds = np.dtype([(n, "i8" if whole else "f8") for n, whole in columns.items()])
        self._rows, self._table = 0, np.empty(_ROWS, self._kinds)
        self._saved = time.monotonic()
        self._is_open = True
        self._file: FileIO | None = None
        self._thread = ThreadPoolExecutor(1)
        self._written: Future[None] = self._thread.submit(self._open, configuration)

    @property
    def digest(self) -> str:
        """SHA-256 of the file, after close()."""
        return self._digest.hexdigest()

    def add(self, row: Columns) -> None:
        """Adds the next message, of which save() has to be told."""
        if self._is_open:
            self._table[self._rows] = tuple(row.get(n, none) for n, none in self._missing.items())
            self._rows += 1

    def save(self) -> None:
        """Writes the rows of the last second, if it is over.

        Raises OSError, once, if earlier rows could not be written; this closes the file.
        """
        if not self._is_open or not self._rows:
            return
        is_due = time.monotonic() - self._saved >= _EVERY and self._written.done()
        if is_due or self._rows == _ROWS:
            try:
                self._flush()
            except OSError:
                self._end()
                raise

    def close(self) -> None:
        """Writes all rows. Raises OSError, unless save() did, if rows could not be written."""
        if not self._is_open:
            return
        try:
            self._flush()
            self._written.result()
        finally:
            self._end()

    def _end(self) -> None:
        self._is_open = False
        self._thread.shutdown()
        if self._file is not None:
            self._file.close()

    def _flush(self) -> None:
        self._written.result()
        self._written = self._thread.submit(self._write, self._table[: self._rows])
        self._rows, self._table = 0, np.empty(_ROWS, self._kinds)
        self._saved = time.monotonic()

    def _open(self, configuration: str) -> None:
        write_whole(configuration, self.path.with_suffix(".toml"))
        self._file = FileIO(self.path, "w")

    def _write(self, table: NDArray[Any]) -> None:
        assert self._file is not None
        columns = {n: np.ascontiguousarray(table[n]) for n in self._missing}
        arrays = [
            pa.array(each, mask=(each == none) | (each != each))
            for each, none in zip(columns.values(), self._missing.values(), strict=True)
        ]
        size, text = self._file.tell(), pa.BufferOutputStream()
        options = pa.csv.WriteOptions(include_header=not size)
        pa.csv.write_csv(pa.table(arrays, names=list(columns)), text, options)
        rest = memoryview(text.getvalue())
        digest = self._digest.copy()
        digest.update(rest)
        try:
            while rest:
                rest = rest[self._file.write(rest) :]
            os.fsync(self._file)
        except OSError:
            self._file.truncate(size)  # a number that is cut off would be a wrong number
            raise
        self._digest = digest
