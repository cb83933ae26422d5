"""Decodes a message in JSON or CSV to columns of numbers. All contents of a message are checked.

A JSON message is an object, as in PlotJuggler: {"elbow": {"motor": [1.5, 2]}} has the columns
"elbow/motor[0]" and "elbow/motor[1]". A CSV message is one line with a line feed, which shows that
the last number is complete. A first line, or an option, names the columns of CSV.
"""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any

Columns = Mapping[str, int | float]  # numbers by column; nan where one is missing

LONGEST = 1 << 16  # bytes of a message
_DEEPEST = 8
_LARGEST = 2**63
_SHOWN = 60


class Decoder:
    """Reads the messages of a source."""

    def __init__(self, wanted: Sequence[str], columns: Sequence[str] = ()) -> None:
        """wanted  columns that are used; columns  columns of CSV, if no line names the columns"""
        self._wanted = {name.lstrip("/"): name for name in wanted}
        self._longest = max(map(len, wanted), default=0)
        self._csv = self._named(columns)

    def columns(self, message: bytes) -> Columns | None:
        """Decodes the next line of one sender; None for a line with names of columns.

        Raises ValueError, which says what was expected and what was received.
        """
        if not _is_json(message) and message.endswith(b"\n") and len(message) <= LONGEST:
            names = self._named(message.decode(errors="replace").split(","))
            # A line that names fewer columns than before is damaged.
            if any(names) and set(names) >= set(filter(None, self._csv)):
                self._csv = names
                return None
        return self.values(message)

    def values(self, message: bytes) -> Columns:
        """Decodes the used columns of a message, which any sender may have sent: it cannot change
        what the cells of others mean.

        Raises ValueError, as columns().
        """
        shown = f"{message[:_SHOWN]!r}{'...' if len(message) > _SHOWN else ''}"
        if len(message) > LONGEST:
            raise ValueError(f"expected at most {LONGEST} bytes, got {len(message)}")
        if _is_json(message):
            try:
                document = json.loads(message)
            except (ValueError, RecursionError) as error:
                raise ValueError(f"expected a whole JSON object, got {shown}") from error
            values = [
                (self._wanted.get(name), value) for name, value in self._flat(document, "", 0)
            ]
        else:
            if not message.endswith(b"\n"):
                raise ValueError(f"expected JSON, or CSV that ends with a line feed, got {shown}")
            try:
                cells = message.decode().split(",")
            except UnicodeDecodeError as error:
                raise ValueError(f"expected text in UTF-8, got {shown}") from error
            if len(cells) != len(self._csv):
                count = f"{len(self._csv)} cells" if self._csv else ""
                expected = count or "the names of the columns first, over UDP by --columns"
                raise ValueError(f"expected {expected}, got {shown}")
            values = list(zip(self._csv, (_parsed(each.strip()) for each in cells), strict=True))
        found = {name: number(name, value) for name, value in values if name is not None}
        if not found:
            raise ValueError(f"expected one of {', '.join(self._wanted)}, got {shown}")
        return found

    def _named(self, cells: Sequence[str]) -> list[str | None]:
        return [self._wanted.get(cell.strip().strip('"').lstrip("/")) for cell in cells]

    def _flat(self, value: Any, above: str, depth: int) -> Iterator[tuple[str, Any]]:
        """Yields the numbers in a value of JSON with their names, and texts and the like.

        Names that are longer than all columns are left out, with what is below them.
        """
        if depth > _DEEPEST:
            raise ValueError(f"expected at most {_DEEPEST} levels")
        if len(above) > self._longest:
            return
        if isinstance(value, dict):
            for key, each in value.items():
                name = key.lstrip("/")
                yield from self._flat(each, f"{above}/{name}" if above else name, depth + 1)
        elif isinstance(value, list):
            for i, each in enumerate(value):
                yield from self._flat(each, f"{above}[{i}]", depth + 1)
        else:
            yield above, value


def _is_json(message: bytes) -> bool:
    return message.lstrip().startswith(b"{")


def _parsed(cell: str) -> int | float | str | None:
    for kind in (int, float):
        with suppress(ValueError):
            return kind(cell)
    return cell or None


def number(name: str, value: Any) -> int | float:
    """Checks a value of a column; nan if not finite. Raises ValueError if it is no number."""
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return math.nan
    if isinstance(value, bool) or not isinstance(value, (int, float)) or abs(value) >= _LARGEST:
        raise ValueError(f"{name}: expected a number, got {str(value)[:_SHOWN]!r}")
    return value
