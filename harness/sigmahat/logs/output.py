"""The table of a log with the estimates added, written while the replay goes on."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from sigmahat.logs.log import Log
from sigmahat.logs.readers.tables import CsvLog
from sigmahat.logs.sampling import Samples

_ROWS = 1 << 16


class Table(AbstractContextManager["Table"]):
    """Every row of the log, with the outputs of the last tick at or before it.

    A CSV log gives a CSV file, every other log a Parquet file. Estimates are the columns
    "estimate.sigma [N.m/rad]" and so on, and "estimate.t [s]", the time of the
    tick since the start of the log.
    """

    def __init__(self, log: Log, samples: Samples, units: Mapping[str, str], stem: Path) -> None:
        """Units of the outputs by name; the file is stem with the suffix of its format."""
        self._text = isinstance(log, CsvLog)
        self.path = stem.with_suffix(".csv" if self._text else ".parquet")
        self._units = units
        self._tick_of_row = samples.tick_of_row
        self._T = samples.T
        names = [name for name, n in log.columns.items() if n == len(samples.tick_of_row)]
        self._rows = _Rows(log.batches(names, _ROWS))
        self._row = self._tick = 0
        self._writer: Any = None

    def add(self, outputs: Mapping[str, np.ndarray[Any, Any]]) -> None:
        """Writes the rows of the next ticks, whose outputs these are."""
        ticks = len(next(iter(outputs.values())))
        end = int(np.searchsorted(self._tick_of_row, self._tick + ticks))
        take = self._tick_of_row[self._row : end] - self._tick
        table = self._rows.take(end - self._row)
        times = self._T * (self._tick + take)
        table = table.append_column("estimate.t [s]", pa.array(times))
        for name, values in outputs.items():
            unit = self._units.get(name)
            title = f"estimate.{name} [{unit}]" if unit else f"estimate.{name}"
            table = table.append_column(title, pa.array(values[take]))
        self._row, self._tick = end, self._tick + ticks
        if self._writer is None:
            writer = pa.csv.CSVWriter if self._text else pa.parquet.ParquetWriter
            self._writer = writer(self.path, table.schema, **self._options())
        self._writer.write_table(table)

    def _options(self) -> dict[str, Any]:
        if self._text:
            return {"write_options": pa.csv.WriteOptions(quoting_style="needed")}
        return {"use_dictionary": False}  # measured numbers hardly repeat

    def __exit__(
        self,
        _kind: type[BaseException] | None,
        _error: BaseException | None,
        _trace: TracebackType | None,
    ) -> None:
        if self._writer is not None:
            self._writer.close()


class _Rows:
    """Takes as many rows as wanted from batches of any size."""

    def __init__(self, batches: Iterator[pa.RecordBatch]) -> None:
        self._batches = batches
        self._left: list[pa.RecordBatch] = []

    def take(self, rows: int) -> pa.Table:
        have = sum(batch.num_rows for batch in self._left)
        while have < rows or not self._left:
            batch = next(self._batches)
            self._left.append(batch)
            have += batch.num_rows
        table = pa.Table.from_batches(self._left)
        self._left = table.slice(rows).to_batches() or [self._left[-1].slice(0, 0)]
        return table.slice(0, rows)
