"""What was received as a log: a Parquet file, which `sigmahat estimate` reads."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

_ROWS = 1 << 13
"""Of a row group: seconds, so that writing it takes milliseconds."""


class Recording:
    """A row for each message; a column that a message lacks is empty there."""

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        """The file is made with the first row group, and is whole after close()."""
        self.path = path
        self.rows = 0
        self._columns = columns
        self._pending: list[Mapping[str, int | float]] = []
        self._schema: pa.Schema | None = None
        self._writer: pq.ParquetWriter | None = None
        self._thread = ThreadPoolExecutor(1)  # so that no sample waits for the disk
        self._written: Future[None] | None = None

    def add(self, row: Mapping[str, int | float], whole: Sequence[str]) -> None:
        """whole  columns of whole numbers that a float64 does not hold"""
        if self._schema is None:
            self._schema = pa.schema(
                [(n, pa.int64() if n in whole else pa.float64()) for n in self._columns]
            )
        self._pending.append(row)
        self.rows += 1
        if len(self._pending) == _ROWS:
            self._flush()

    def close(self) -> None:
        """Writes what is left. Raises OSError if the disk refuses."""
        if self._pending:
            self._flush()
        self._wait()
        self._thread.shutdown()
        if self._writer is not None:
            self._writer.close()

    def _flush(self) -> None:
        rows, self._pending = self._pending, []
        self._wait()
        self._written = self._thread.submit(self._write, rows)

    def _wait(self) -> None:
        if self._written is not None:
            self._written.result()

    def _write(self, rows: Sequence[Mapping[str, int | float]]) -> None:
        schema = self._schema
        if self._writer is None:
            self._writer = pq.ParquetWriter(self.path, schema)
        arrays = [
            pa.array([_cell(row.get(field.name), field.type) for row in rows], field.type)
            for field in schema
        ]
        self._writer.write_table(pa.Table.from_arrays(arrays, schema=schema))


def _cell(value: int | float | None, kind: pa.DataType) -> int | float | None:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return None
    return value if pa.types.is_integer(kind) else float(value)
