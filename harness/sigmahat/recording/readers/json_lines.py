"""Reads JSON Lines: one object in each line, such as {"t": 0.01, "motor": {"pos": 0.2}}.

The path to a number is the name of the column: "motor.pos". An element of an array has an index,
"positions[0]", if the array is equally long in all lines.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.compute
import pyarrow.json

from sigmahat.fmi.quoted import cause
from sigmahat.recording.arrow_columns import numbers
from sigmahat.recording.limits import check_columns, check_numbers
from sigmahat.recording.log import Array, Log, LogError
from sigmahat.recording.readers.json_paths import LONGEST_LINE, check_paths

_LONGEST = 256  # elements of an array; a longer one is an image, not a signal


class JsonLog(Log):
    """A text file with one JSON object in each line."""

    def __init__(self, path: Path) -> None:
        """Raises LogError for lines that are no objects, or more than memory holds."""
        check_paths(path)
        try:
            table = pa.json.read_json(path, pa.json.ReadOptions(False, LONGEST_LINE))
        except pa.ArrowInvalid as error:
            raise LogError(
                f"{path}: expected one JSON object in each line ({cause(error)}); if the "
                "file is one JSON document, write its rows in lines: jq -c '.[]'"
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


def _flat(path: Path, name: str, column: pa.ChunkedArray) -> Iterator[tuple[str, pa.ChunkedArray]]:
    """Yields the columns of an object or array in each line; arrays of other lengths are none."""
    kind = column.type
    if pa.types.is_struct(kind):
        for i, part in enumerate(column.flatten()):
            yield from _flat(path, f"{name}.{kind.field(i).name}", part)
    elif pa.types.is_list(kind):
        ends = pa.compute.min_max(pa.compute.list_value_length(column)).as_py()
        if ends["min"] is not None and ends["min"] == ends["max"] <= _LONGEST:
            for i in range(ends["max"]):
                element = pa.compute.list_element(column, i)
                yield from _flat(path, f"{name}[{i}]", element)
    else:
        yield name, column
