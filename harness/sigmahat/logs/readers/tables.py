"""CSV and Parquet files."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from sigmahat.logs.errors import LogError
from sigmahat.logs.log import Array, Log, numbers

_BLOCK = 1 << 22  # bytes of a CSV file that are parsed at a time


class ParquetLog(Log):
    """A Parquet file; columns of lists and structures are left out."""

    def __init__(self, path: Path) -> None:
        """Raises LogError for a file that is damaged."""
        try:
            self._file = pa.parquet.ParquetFile(path, memory_map=True)
        except (pa.ArrowException, OSError) as error:
            raise LogError(f"{path}: not a whole Parquet file ({error}); copy it again") from error
        flat = [field.name for field in self._file.schema_arrow if not field.type.num_fields]
        super().__init__(path, dict.fromkeys(flat, self._file.metadata.num_rows))

    def _read(self, name: str) -> Array:
        try:
            column = self._file.read([name], use_threads=False).column(0)
        except (pa.ArrowException, OSError) as error:
            raise LogError(f"{self.path}: damaged at column {name!r} ({error})") from error
        return numbers(self.path, name, column)

    def batches(self, names: Sequence[str], rows: int) -> Iterator[pa.RecordBatch]:
        try:
            yield from self._file.iter_batches(rows, columns=list(names), use_threads=False)
        except (pa.ArrowException, OSError) as error:
            raise LogError(f"{self.path}: damaged ({error})") from error


class CsvLog(Log):
    """A text file: one line that names the columns, then numbers between , or ; or tabs.

    With ; between them the numbers may have decimal commas.
    """

    def __init__(self, path: Path) -> None:
        """Raises LogError for a file that is no such table."""
        with path.open(encoding="utf-8-sig", newline="") as file:
            try:
                head, first = file.readline().strip("\r\n"), file.readline().strip("\r\n")
            except UnicodeDecodeError as error:
                raise LogError(
                    f"{path}: neither text nor a known binary format; expected CSV, Parquet, MAT, "
                    "HDF5, MCAP or a ROS 2 bag"
                ) from error
        delimiter = max(",;\t", key=head.count)
        names = [cell.strip().strip('"') for cell in head.split(delimiter)]
        if delimiter not in head:
            raise LogError(
                f"{path}: line 1 is {head[:40]!r}, expected the names of several columns "
                "between commas, semicolons or tabs"
            )
        if all(_is_figure(name) for name in names):
            raise LogError(f"{path}: line 1 holds numbers, expected the names of the columns")
        repeated = {name for name in names if names.count(name) > 1}
        if repeated:
            raise LogError(f"{path}: line 1 names column {repeated.pop()!r} twice")
        self._parse = pa.csv.ParseOptions(delimiter=delimiter)
        comma = delimiter == ";" and "," in first and "." not in first
        self._decimal = "," if comma else "."
        if not first:
            raise LogError(f"{path}: no rows below the names of the columns; record it again")
        self._names = names
        super().__init__(path, dict.fromkeys(names, 0))
        rows = self._table(names[:1]).num_rows
        self.columns = dict.fromkeys(names, rows)

    def _read(self, name: str) -> Array:
        return numbers(self.path, name, self._table([name]).column(0))

    def batches(self, names: Sequence[str], rows: int) -> Iterator[pa.RecordBatch]:
        try:
            with self._stream(dict.fromkeys(self._names, None)) as first:
                types = {
                    f.name: pa.float64() if _numeric(f.type) else pa.string() for f in first.schema
                }
            yield from self._stream({name: types[name] for name in names})
        except pa.ArrowInvalid as error:
            raise self._damaged(error) from error

    def _stream(self, types: Mapping[str, pa.DataType | None]) -> pa.csv.CSVStreamingReader:
        """A reader of some columns; where the type is None the first block decides."""
        options = pa.csv.ConvertOptions(
            include_columns=list(types),
            column_types={name: kind for name, kind in types.items() if kind is not None},
            decimal_point=self._decimal,
        )
        return pa.csv.open_csv(self.path, self._options(), self._parse, options)

    def _table(self, names: list[str]) -> pa.Table:
        options = pa.csv.ConvertOptions(include_columns=names, decimal_point=self._decimal)
        try:
            return pa.csv.read_csv(self.path, self._options(), self._parse, options)
        except pa.ArrowInvalid as error:
            raise self._damaged(error) from error

    def _options(self) -> pa.csv.ReadOptions:
        return pa.csv.ReadOptions(block_size=_BLOCK, column_names=self._names, skip_rows=1)

    def _damaged(self, error: pa.ArrowInvalid) -> LogError:
        return LogError(f"{self.path}: {error}; a file cut in the middle ends like this")


def _numeric(kind: pa.DataType) -> bool:
    return bool(pa.types.is_floating(kind) or pa.types.is_integer(kind))


def _is_figure(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
