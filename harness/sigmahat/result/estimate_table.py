"""Writes and reads the table of `sigmahat estimate` and its notes; writes estimates as messages.

The table has the columns of the log and the estimates: `estimate.csv` for a CSV log, else
`estimate.parquet`. Estimates have titles such as "estimate.sigma [N.m/rad]". "estimate.t [s]" is
the time of the tick since the start of the log. `estimate.json` has the notes on the replay.

In Parquet the estimates are float32, rounded to five digits: three or four digits are accurate. The
columns of the log are unchanged. Times are float64, because times of hours need more digits.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute
import pyarrow.csv
import pyarrow.parquet
from numpy.typing import NDArray

from sigmahat.files import tables
from sigmahat.files.output import finite
from sigmahat.fmi.model import Model
from sigmahat.fmi.series import schema
from sigmahat.recording.log import Log, LogError
from sigmahat.recording.notes import RecordingNote
from sigmahat.recording.readers.csv_parquet import CsvLog, ParquetLog
from sigmahat.recording.sampling import Samples
from sigmahat.result.headline import StiffnessChange
from sigmahat.result.stored import NO_OTHER_KEYS, Format, Text, Word

_ROWS = 1 << 15
_STEM = "estimate"
_PREFIX = "estimate."
_REPEATED = 2  # with more rows per distinct value, a dictionary in Parquet is shorter
_TIME = "t"
_TIMES = (_TIME, "change_age")
_DOUBT, _VALID = "doubt", "valid"  # a text, and a flag


class EstimateWriter(AbstractContextManager["EstimateWriter"]):
    """Writes every row of the log with the outputs of the last tick at or before the row."""

    def __init__(self, log: Log, samples: Samples, units: Mapping[str, str], folder: Path) -> None:
        """units  units of the outputs that have a unit, by name of the output"""
        self._dialect = log.dialect if isinstance(log, CsvLog) else None
        self._path = folder / f"{_STEM}.{'csv' if self._dialect else 'parquet'}"
        self._units = {_TIME: "s", **units}
        self._tick_of_row = samples.tick_of_row
        self._T = samples.T
        names = [name for name, n in log.columns.items() if n == len(samples.tick_of_row)]
        self._batches = log.batches(names, _ROWS)
        self._left = pa.Table.from_batches([next(self._batches)])  # rows that are not written yet
        self._row = self._tick = 0
        self._writer: Any = None
        self._thread = ThreadPoolExecutor(1)  # writes a table while the next ticks are computed
        self._written: Future[None] = self._thread.submit(lambda: None)  # the last table

    def add(self, outputs: Mapping[str, NDArray[Any]]) -> None:
        """Writes the rows of the next ticks, with the outputs of these ticks."""
        ticks = len(next(iter(outputs.values())))
        # The type is int32 as in the array: numpy would convert the whole array to another type.
        end = int(np.searchsorted(self._tick_of_row, np.int32(self._tick + ticks)))
        take = self._tick_of_row[self._row : end] - self._tick
        count = end - self._row
        while self._left.num_rows < count:
            more = pa.Table.from_batches([next(self._batches)])
            self._left = pa.concat_tables([self._left, more])
        table, self._left = self._left.slice(0, count), self._left.slice(count)
        times = self._T * np.arange(self._tick, self._tick + ticks)
        for name, values in {_TIME: times, **outputs}.items():
            rows = values[take]
            if self._dialect is None and rows.dtype == np.float64 and name not in _TIMES:
                rows = _rounded(rows)
            title = tables.title(_PREFIX + name, self._units.get(name))
            table = table.append_column(title, pa.array(rows))
        self._row, self._tick = end, self._tick + ticks
        if self._dialect is not None and self._dialect.decimal == ",":
            table = _with_commas(table)
        if self._writer is None:
            writer = pa.csv.CSVWriter if self._dialect else pa.parquet.ParquetWriter
            self._writer = writer(self._path, table.schema, **self._options(table))
        self._written.result()  # waits, and raises the error of the last table, if any
        self._written = self._thread.submit(self._writer.write_table, table)

    def _options(self, first: pa.Table) -> dict[str, Any]:
        if self._dialect is not None:
            options = pa.csv.WriteOptions(quoting_style="needed", delimiter=self._dialect.delimiter)
            return {"write_options": options}
        split = [name for name in first.column_names if _is_split(name, first[name])]
        others = [name for name in first.column_names if name not in split]
        return {"compression": "zstd", "use_byte_stream_split": split, "use_dictionary": others}

    def __exit__(self, _kind: object, error: BaseException | None, _trace: object) -> None:
        try:
            if error is None:
                self._written.result()
        finally:
            self._thread.shutdown()
            if self._writer is not None:
                self._writer.close()
            pa.default_memory_pool().release_unused()  # the figure needs memory, too


def _rounded(values: NDArray[np.float64]) -> NDArray[np.float32]:
    """Rounds numbers to 16 bits after the leading bit. The other bits are noise, which would take
    a third of the file.
    """
    bits = values.astype(np.float32).view(np.uint32)
    return ((bits + 0x40) & 0xFFFFFF80).view(np.float32)


def _is_split(name: str, column: pa.ChunkedArray) -> bool:
    """Returns whether Parquet stores a column as byte streams, which suits smooth signals.

    Measured numbers that were once decimal text have random bytes, but few distinct values. An
    estimate may begin with many equal values.
    """
    if pa.types.is_integer(column.type):
        return True
    if not pa.types.is_floating(column.type):
        return False
    repeated = _REPEATED * pa.compute.count_distinct(column).as_py() <= len(column)
    return name.startswith(_PREFIX) or not repeated


def _with_commas(table: pa.Table) -> pa.Table:
    """Converts the numbers of a table to text with decimal commas."""
    for i, field in enumerate(table.schema):
        if pa.types.is_floating(field.type):
            text = pa.compute.replace_substring(table.column(i).cast(pa.string()), ".", ",")
            table = table.set_column(i, field.name, text)
    return table


MCAP = "estimate.mcap"  # name of the file in the folder of results
_TOPIC = "/estimate"


@contextmanager
def mcap_file(
    path: Path, model: Model, T: float
) -> Iterator[Callable[[Mapping[str, NDArray[Any]]], None]]:
    """Yields a function that writes a message for each of the next ticks, which are T [s] apart.

    Messages are JSON of the topic /estimate, for Foxglove and PlotJuggler. The schema of the
    messages has unit and description of each field. Times count from the start of the log.
    """
    from mcap.writer import Writer

    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(library="sigmahat")
        ticks, channel = 0, -1

        def add(outputs: Mapping[str, NDArray[Any]]) -> None:
            nonlocal ticks, channel
            if not ticks:
                data = json.dumps(schema(model, outputs)).encode()
                described = writer.register_schema("estimate", "jsonschema", data)
                channel = writer.register_channel(_TOPIC, "json", described)
            columns = [finite(values.tolist()) for values in outputs.values()]
            for row in zip(*columns, strict=True):
                stamp = round(1e9 * T * ticks)
                data = json.dumps(dict(zip(outputs, row, strict=True))).encode()
                writer.add_message(channel, stamp, data, stamp)
                ticks += 1

        yield add
        writer.finish()  # type: ignore[no-untyped-call]


class EstimateTable(Mapping[str, NDArray[np.float64]]):
    """Reads the outputs that `sigmahat estimate` wrote into a folder, by name; true is 1.

    A column is read at each access: all columns of a long log together do not fit the memory.
    """

    def __init__(self, folder: Path) -> None:
        """Raises LogError if the table is missing or damaged."""
        path = next(folder.glob(f"{_STEM}.parquet"), folder / f"{_STEM}.csv")
        is_csv = path.suffix == ".csv"
        try:
            self._log = CsvLog(path) if is_csv else ParquetLog(path)
        except (LogError, OSError) as error:
            what = "not readable as CSV" if is_csv else "damaged"
            raise LogError(f"{path}: {what}; run `sigmahat estimate` again") from error
        titles = [title for title in self._log.columns if title.startswith(_PREFIX)]
        names = [tables.name_and_unit(title.removeprefix(_PREFIX)) for title in titles]
        self.units = dict(names)  # unit of each output, None for flags
        self._titles = dict(zip(self.units, titles, strict=True))
        if not self.units.keys() >= {*_TIMES, "sigma", _VALID, _DOUBT}:
            raise LogError(f"{path}: expected a table of `sigmahat estimate`; run it again")
        del self._titles[_DOUBT]
        self.t = self._log.read(self._titles.pop(_TIME))  # times of the rows [s]
        self.used = self._log.read(self._titles.pop(_VALID)).astype(np.bool_)
        """Output `valid` for each row: whether the estimator used the row."""

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        return self._log.read(self._titles[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self._titles)

    def __len__(self) -> int:
        return len(self._titles)


@dataclass(frozen=True)
class Replayed:
    """The contents of `estimate.json`."""

    __pydantic_config__ = NO_OTHER_KEYS

    format: Text
    version: int
    log: Text  # path of the log, as given by the user
    ticks: int  # number of ticks of the estimator in the log
    skipped: int  # ticks without an estimate: a measurement was missing
    T: float  # time between ticks [s]
    changes: Sequence[StiffnessChange]  # changes of the stiffness
    doubt: dict[Word, float]
    """Fraction of the ticks in the second half, by item of the output `doubt`."""
    notes: Sequence[RecordingNote]  # on reading the log and on its samples
    joint: Text = ""  # name of the joint; empty if the configuration names no joint
    findings: list[dict[str, Any]] | None = None
    """Findings of the checks as data, checks/findings.py; None without checks."""


REPLAYED = Format("estimate.json", "sigmahat estimate", 3, Replayed)  # format of the file
