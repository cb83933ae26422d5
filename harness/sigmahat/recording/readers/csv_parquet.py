"""Reads logs in CSV and Parquet files."""

import weakref
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO, Any

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from sigmahat.fmi.quoted import cause, quoted
from sigmahat.recording.arrow_columns import (
    MISSING,
    first_text,
    fits_float64,
    holds_text,
    numbers,
)
from sigmahat.recording.limits import MOST_TEXT, check_columns, check_numbers
from sigmahat.recording.log import Array, Log, LogError
from sigmahat.recording.notes import Encoding, ShortRow
from sigmahat.recording.readers.dialect import dialect
from sigmahat.recording.readers.tidy_text import TidyText

_BLOCK = 1 << 20  # bytes of a CSV file that are parsed at a time
_ALWAYS_READ = 100_000_000  # uncompressed size up to which a file is not checked [bytes]
_BUFFER = 1 << 16  # bytes of a column that are read at a time, instead of a whole row group
_ROWS = 1 << 16  # rows of a column that are read at a time
_FEW = 100  # rows with text that are checked at a time
_SHOWN = 60  # characters of a row that a message shows


class ParquetLog(Log):
    """A Parquet file; columns of lists and structures are left out."""

    def __init__(self, path: Path) -> None:
        """Raises LogError for a file that is damaged."""
        try:
            self._file = pa.parquet.ParquetFile(path, pre_buffer=False, buffer_size=_BUFFER)
            schema, metadata = self._file.schema_arrow, self._file.metadata
            flat = [field.name for field in schema if _is_flat(field.type)]
        except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
            raise LogError(
                f"{path}: incomplete Parquet file ({cause(error)}); copy it again"
            ) from error
        check_columns(path, len(flat))
        check_numbers(path, metadata.num_rows)
        self._texts = {field.name for field in schema if _is_text(field.type)}
        super().__init__(path, dict.fromkeys(flat, metadata.num_rows))
        self.dates |= {field.name for field in schema if pa.types.is_timestamp(field.type)}

    def _read(self, name: str) -> Array:
        if name in self._texts:
            raise self._text(name)
        check_numbers(self.path, _bytes(self._file.metadata, name) // 8)
        try:
            kind = self._file.schema_arrow.field(name).type
            if pa.types.is_floating(kind) or pa.types.is_boolean(kind):
                return self._read_in_parts(name)
            column = self._file.read([name], use_threads=False).column(0)
        except (pa.ArrowException, OSError) as error:
            raise LogError(
                f"{self.path}: damaged at column {quoted(name)} ({cause(error)})"
            ) from error
        return numbers(self.path, name, column)

    def _read_in_parts(self, name: str) -> Array:
        """Reads a column part by part, which needs half of the memory."""
        values, row = np.empty(self.columns[name]), 0
        for batch in self._file.iter_batches(_ROWS, columns=[name], use_threads=False):
            part = pa.chunked_array([batch.column(0)])
            values[row : row + len(batch)] = numbers(self.path, name, part)
            row += len(batch)
        return values

    def _text(self, name: str) -> LogError:
        """Creates the error for a column of text, and reads the column part by part."""
        rows = 0
        for batch in self.batches([name], _FEW):
            found = first_text(pa.chunked_array([batch.column(0)]))
            if found is not None:
                return holds_text(self.path, name, rows + found[0], found[1])
            rows += len(batch)
        return holds_text(self.path, name, 1, "")

    def batches(self, names: Sequence[str], rows: int) -> Iterator[pa.RecordBatch]:
        texts = [name for name in names if name in self._texts]
        for name in names:
            check_numbers(self.path, _bytes(self._file.metadata, name) // 8)
        try:
            # Repeated texts stay in a dictionary until the total length of the texts is known.
            file = pa.parquet.ParquetFile(
                self.path, pre_buffer=False, buffer_size=_BUFFER, read_dictionary=texts
            )
            for batch in file.iter_batches(rows, columns=list(names), use_threads=False):
                yield self._with_texts(batch)
        except (pa.ArrowException, OSError) as error:
            raise LogError(f"{self.path}: damaged ({cause(error)})") from error

    def _with_texts(self, batch: pa.RecordBatch) -> pa.RecordBatch:
        """Replaces dictionaries of a batch by the texts, if the texts are not too long."""
        for i, field in enumerate(batch.schema):
            if pa.types.is_dictionary(field.type):
                texts = batch.column(i).dictionary
                longest = pa.compute.max(pa.compute.binary_length(texts)).as_py() or 0
                if longest * len(batch) > MOST_TEXT:
                    raise LogError(
                        f"{self.path}: column {quoted(field.name)} has texts of {longest} "
                        "characters; save the log without this column"
                    )
                batch = batch.set_column(i, field.name, batch.column(i).cast(texts.type))
        return batch


class CsvLog(Log):
    """A text file with a table, in any of the forms of dialect.py.

    A temporary Parquet file with the parsed text limits the memory for a long log. Only a column
    that does not begin with numbers, such as dates, is parsed again when the column is read.
    """

    def __init__(self, path: Path) -> None:
        """Raises LogError if the text file does not contain a table."""
        self.dialect = dialect(path)  # format of the file
        names = self._names = list(self.dialect.names)
        self._cut: list[int] = []  # number of values of a row that is too short
        self._wrong: pa.csv.InvalidRow | None = None  # a row that ends the reading
        self._tidy = TidyText(path, self.dialect)
        self._parse = pa.csv.ParseOptions(
            delimiter=self.dialect.delimiter, invalid_row_handler=self._left_out
        )
        super().__init__(path, dict.fromkeys(names, 0))
        if self.dialect.encoding != "utf-8":
            self.notes.append(Encoding(encoding=self.dialect.encoding))
        self.notes += [*self.dialect.notes, *self._tidy.notes]
        file = TemporaryFile(prefix="sigmahat-")  # noqa: SIM115
        weakref.finalize(self, file.close)  # closing removes the file
        self._copy = self._copied(file)
        self._types = {field.name: field.type for field in self._copy.schema_arrow}
        self.columns = dict.fromkeys(names, self._copy.metadata.num_rows)
        if self._cut:
            self.notes.append(ShortRow(values=self._cut[0], columns=len(names)))

    def _left_out(self, row: pa.csv.InvalidRow) -> str:
        """Skips one row that is too short, such as the last row of an interrupted recording."""
        if row.actual_columns >= row.expected_columns or self._cut:
            self._wrong = row
            return "error"
        self._cut.append(row.actual_columns)
        return "skip"

    def _read(self, name: str) -> Array:
        if _numeric(self._types[name]):
            column = self._copy.read([name], use_threads=False).column(0)
        else:
            column = self._parsed(self._copy, name)
        return numbers(self.path, name, column)

    def batches(self, names: Sequence[str], rows: int) -> Iterator[pa.RecordBatch]:
        yield from self._copy.iter_batches(rows, columns=list(names), use_threads=False)

    def _copied(self, file: IO[bytes]) -> pa.parquet.ParquetFile:
        """Writes all columns into a temporary Parquet file; columns without numbers become text."""
        try:
            with self._stream({}) as stream:
                kinds = {field.name: field.type for field in stream.schema}
                first = pa.table(stream.read_next_batch())
            try:
                self._write(file, kinds)
            except pa.ArrowInvalid:  # such as 0, 0, 0.5: whole numbers only at the beginning
                integers = [name for name, kind in kinds.items() if pa.types.is_integer(kind)]
                small = [name for name in integers if fits_float64(first[name])]
                self._write(file, {**kinds, **dict.fromkeys(small, pa.float64())})
        except pa.ArrowInvalid:
            # A column has text after numbers, or the file is damaged, which fails again here.
            try:
                self._write(file, {})
            except pa.ArrowInvalid as error:
                raise LogError(f"{self.path}: {self._reason(error)}") from error
            texts = pa.parquet.ParquetFile(file, pre_buffer=False)
            self._write(file, {name: self._parsed(texts, name).type for name in self._names})
        pa.default_memory_pool().release_unused()
        return pa.parquet.ParquetFile(file, pre_buffer=False)

    def _reason(self, error: pa.ArrowInvalid) -> str:
        """Says why the rows cannot be read."""
        if self._wrong is None:
            return f"{cause(error)}; the end of the file may be missing"
        row = self._wrong
        return (
            f"the row {row.text[:_SHOWN]!r} has {row.actual_columns} values, the other rows "
            f"{row.expected_columns}; remove it, or save the log again"
        )

    def _write(self, file: IO[bytes], kinds: Mapping[str, pa.DataType]) -> None:
        """Writes the Parquet copy; columns without a numeric type become text."""
        types = dict.fromkeys(self._names, pa.string())
        types |= {name: kind for name, kind in kinds.items() if _numeric(kind)}
        file.seek(0)
        file.truncate()
        with (
            self._stream(types) as blocks,
            pa.parquet.ParquetWriter(
                file, blocks.schema, use_dictionary=False, compression="none"
            ) as writer,
        ):
            for block in blocks:
                writer.write_batch(block)

    def _stream(self, types: Mapping[str, pa.DataType]) -> pa.csv.CSVStreamingReader:
        """Opens a reader of all columns; the first block determines types that are not given."""
        self._cut.clear()  # the text is parsed more than once
        self._wrong = None
        options = pa.csv.ConvertOptions(
            column_types=types, decimal_point=self.dialect.decimal, null_values=MISSING
        )
        read = pa.csv.ReadOptions(
            use_threads=False,
            block_size=_BLOCK,
            column_names=self._names,
            skip_rows=self.dialect.head,
            encoding=self.dialect.encoding,
        )
        return pa.csv.open_csv(self._tidy.open(), read, self._parse, options)

    def _parsed(self, copy: pa.parquet.ParquetFile, name: str) -> pa.ChunkedArray:
        """Parses a text column of the Parquet copy; the type fits all values of the column."""
        text = pa.BufferOutputStream()
        pa.csv.write_csv(copy.read([name], use_threads=False), text)
        options = pa.csv.ConvertOptions(decimal_point=self.dialect.decimal, null_values=MISSING)
        return pa.csv.read_csv(pa.BufferReader(text.getvalue()), convert_options=options).column(0)


def _is_flat(kind: pa.DataType) -> bool:
    """Returns whether a column of this type contains numbers or text, and no lists."""
    return _is_text(kind) or not (kind.num_fields or pa.types.is_fixed_size_binary(kind))


def _is_text(kind: pa.DataType) -> bool:
    kinds = (pa.types.is_string, pa.types.is_large_string, pa.types.is_dictionary)
    return any(is_kind(kind) for is_kind in kinds)


def _bytes(metadata: Any, name: str) -> int:
    """Returns an upper limit of the uncompressed size of a column of a Parquet file [bytes]."""
    groups = [metadata.row_group(i) for i in range(metadata.num_row_groups)]
    whole = sum(group.total_byte_size for group in groups)
    # Only for large files: pyarrow aborts the process if the metadata of a column are damaged.
    if whole <= _ALWAYS_READ:
        return int(whole)
    places = [j for j in range(metadata.num_columns) if metadata.schema.column(j).path == name]
    return sum(group.column(j).total_uncompressed_size for group in groups for j in places)


def _numeric(kind: pa.DataType) -> bool:
    return bool(pa.types.is_floating(kind) or pa.types.is_integer(kind))
