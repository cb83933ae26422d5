"""Reads JSON Lines: one object in each line, such as {"t": 0.01, "motor": {"pos": 0.2}}.

The path to a number is the name of the column: "motor.pos". An element of an array has an index,
"positions[0]", if the array is equally long in all lines.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.compute
import pyarrow.json

from sigmahat.recording.arrow_columns import numbers
from sigmahat.recording.limits import check_columns, check_numbers
from sigmahat.recording.log import Array, Log, LogError

_DEEPEST = 32  # largest number of nested objects
_LONGEST = 256  # elements of an array; a longer one is an image, not a signal
_BLOCK = 1 << 20  # bytes that are parsed at a time, which hold a line at least


class JsonLog(Log):
    """A text file with one JSON object in each line."""

    def __init__(self, path: Path) -> None:
        """Raises LogError for lines that are no objects."""
        try:
            table = pa.json.read_json(path, pa.json.ReadOptions(False, _BLOCK))
        except pa.ArrowInvalid as error:
            raise LogError(
                f"{path}: expected one JSON object in each line ({error}); if the file is one "
                "JSON document, write its rows in lines: jq -c '.[]'"
            ) from error
        check_numbers(path, table.num_rows)
        columns: dict[str, pa.ChunkedArray] = {}
        for name, column in zip(table.column_names, table.columns, strict=True):
            for each, values in _flat(path, name, column):
                columns[each] = values
                check_columns(path, len(columns))
        self._table = pa.table(columns)
        super().__init__(path, dict.fromkeys(columns, table.num_rows))

    def _read(self, name: str) -> Array:
        return numbers(self.path, name, self._table[name])

    def batches(self, names: Sequence[str], rows: int) -> Iterator[pa.RecordBatch]:
        yield from self._table.select(list(names)).to_batches(rows)


def _flat(
    path: Path, name: str, column: pa.ChunkedArray, depth: int = 0
) -> Iterator[tuple[str, pa.ChunkedArray]]:
    """Yields the columns of an object or array in each line; arrays of other lengths are none."""
    if depth > _DEEPEST:
        raise LogError(f"{path}: expected at most {_DEEPEST} levels of objects, got more")
    kind = column.type
    if pa.types.is_struct(kind):
        for i, part in enumerate(column.flatten()):
            yield from _flat(path, f"{name}.{kind.field(i).name}", part, depth + 1)
    elif pa.types.is_list(kind):
        ends = pa.compute.min_max(pa.compute.list_value_length(column)).as_py()
        if ends["min"] is not None and ends["min"] == ends["max"] <= _LONGEST:
            for i in range(ends["max"]):
                element = pa.compute.list_element(column, i)
                yield from _flat(path, f"{name}[{i}]", element, depth + 1)
    else:
        yield name, column
