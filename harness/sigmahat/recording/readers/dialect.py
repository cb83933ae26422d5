"""How a text file writes its table: where the names of the columns are, and what separates cells.

People's files differ in what stands around the numbers. Lines of comments or of a device come
before the names, a line of units or an empty line below them; rows end with a delimiter; columns
have no name, or the same name twice. What is not ambiguous is read, and a note says what was done.
"""

import csv
import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from sigmahat.recording.arrow_columns import is_number
from sigmahat.recording.limits import check_columns
from sigmahat.recording.log import LogError
from sigmahat.recording.notes import LinesAboveTable, RecordingNote, RepeatedName, RowOfUnits
from sigmahat.recording.readers.encodings import first_lines

LONGEST_LINE = 1 << 20  # characters
_LINES = 200  # that are looked at to find the table
_COMMENT = re.compile(r"\s*(#|%|//)+\s?")
_SEPARATOR = re.compile(r"sep=(.)", re.IGNORECASE)  # the first line, for Excel
PREFIX = re.compile(
    r"\[[^\[\]]{0,60}\d\d:\d\d:\d\d[^\[\]]{0,60}\]\s*"  # bounded: else quadratic in a line
    r"|(?:\d{4}-\d\d-\d\d[ T])?\d\d:\d\d:\d\d(?:[.,]\d+)?\s*->\s*"
)
"""The time at which a terminal received a line: "12:03:44.123 -> " or "[2026-03-12 12:03:44] "."""
_NO_DECIMAL_POINT = re.compile(
    r"(?<![\d.,])[1-9]\d{0,2}(?:\.\d{3})+(?![\d.])|\d{1,2}\.\d{1,2}\.\d{2,4}|:\d\d\.\d+"
)
"""Points in 1.234 of 1.234,56, in a date and in a time of day."""
_END_OF_HEAD = "***End_of_Header***"  # in a measurement file of LabVIEW
_LIST = re.compile(r"[\[(]\s*[-+]?[\d.]+(?:e[-+]?\d+)?[,\s][^\[\]()]*[\])]")
"""A list or an array of numbers that was printed: "[0.12, 0.0]" or "[0.12 0.  ]"."""
_DELIMITERS = ("\t", ";", ",")
SPACES = " "  # delimiter of a table whose columns are aligned with any number of spaces
_ALIKE = 3  # lines with equally many values that show the delimiter
_SHOWN = 40  # characters of a line that a message shows


@dataclass(frozen=True)
class Dialect:
    """The format of a text file that contains a table."""

    names: Sequence[str]  # names of the columns; with a row of units, name and unit
    delimiter: str  # character between the columns, SPACES: any number of spaces
    decimal: str  # point or comma in numbers
    encoding: str
    head: int  # lines before the first row
    names_line: str = ""  # the line with the names, as it is in the file
    prefix: str = ""
    """What a terminal wrote before the first line, and in the same form before all lines."""
    notes: Sequence[RecordingNote] = ()  # what was done to read the table


def dialect(path: Path) -> Dialect:
    """Detects the format of a text file. Raises LogError if the file contains no table."""
    found = first_lines(path, _LINES, LONGEST_LINE)
    if found is None:
        raise LogError(
            f"{path}: unknown binary format; expected CSV, Parquet, MAT, HDF5, MCAP or a ROS 2 bag"
        )
    lines, encoding = found
    for i, line in enumerate(lines, 1):
        if len(line) >= LONGEST_LINE:
            raise LogError(
                f"{path}: expected lines of at most {LONGEST_LINE} characters; see line {i}"
            )
    lines = [line.strip("\r\n").removeprefix("\ufeff") for line in lines]
    prefixes = [PREFIX.match(line) for line in lines if line]
    prefix = prefixes[0][0] if len(prefixes) > 1 and prefixes[0] and all(prefixes) else ""
    if prefix:
        lines = [PREFIX.sub("", line, count=1) for line in lines]
    return replace(_Table(path, lines, encoding).dialect(), prefix=prefix)


class _Table:
    """The first lines of a file, in which the table is looked for."""

    def __init__(self, path: Path, lines: Sequence[str], encoding: str) -> None:
        self._path, self._lines, self._encoding = path, lines, encoding
        self._notes: list[RecordingNote] = []
        forced = _SEPARATOR.fullmatch(lines[0].strip()) if lines else None
        ends = [i for i, line in enumerate(lines, 1) if line.startswith(_END_OF_HEAD)]
        begin = max([1 if forced else 0, *ends])
        self._texts = [
            i for i in range(begin, len(lines)) if lines[i].strip() and not _COMMENT.match(lines[i])
        ]
        """Lines that are neither empty nor comments."""
        if not self._texts:
            raise LogError(f"{path}: expected names of columns and rows, found none")
        self._delimiter: str = forced[1] if forced else self._find_delimiter()
        check_columns(path, len(self._cells(self._texts[0])))

    def dialect(self) -> Dialect:
        row = self._first_row()
        if row is None:
            raise self._no_rows()
        names_line, names = self._names(row)
        count = len(self._cells(row))
        while len(names) > count and not names[-1]:
            names.pop()  # a delimiter ends the names, but not the rows
        if names[count:] == ["Comment"]:
            names.pop()  # LabVIEW names a column of comments, which the rows do not have
        if len(names) < count and not any(self._cells(row)[len(names) :]):
            names += [""] * (count - len(names))  # a delimiter ends the rows
        if len(names) != count:
            raise LogError(
                f"{self._path}: line {row + 1} has {count} values, line {names_line + 1} names "
                f"{len(names)} columns"
            )
        check_columns(self._path, count)
        names = self._with_units(names, names_line, row)
        names = self._distinct(names)
        self._note_skipped(names_line, row)
        text = "".join(self._lines[row:])
        is_comma = "," in text and "." not in _NO_DECIMAL_POINT.sub("", text)
        decimal = "," if self._delimiter in (";", "\t", SPACES) and is_comma else "."
        return Dialect(
            names,
            self._delimiter,
            decimal,
            self._encoding,
            row,
            self._lines[names_line],
            notes=self._notes,
        )

    def _find_delimiter(self) -> str:
        """The delimiter with which some lines in a row have equally many values.

        A comma is tried last, because it may be in the numbers. Without such lines, the delimiter
        that is most often in the first line.
        """
        for place in range(len(self._texts)):
            lines = [self._lines[i] for i in self._texts[place : place + _ALIKE]]
            for delimiter in (*_DELIMITERS, SPACES):
                rows = [split_cells(line, delimiter) for line in lines]
                count = len(rows[0])
                if count > 1 and all(len(row) == count and _is_row(row) for row in rows):
                    return delimiter
        return max(_DELIMITERS, key=self._lines[self._texts[0]].count)

    def _first_row(self) -> int | None:
        """The first line of values that is followed by lines with as many, if any follow."""
        for place, i in enumerate(self._texts):
            rows = [self._cells(k) for k in self._texts[place : place + _ALIKE]]
            if len(rows) > 1 and len(rows[-1]) < len(rows[0]):
                rows.pop()  # the last line of a file may be cut off
            if len(rows[0]) > 1 and all(len(row) == len(rows[0]) and _is_row(row) for row in rows):
                return i
        return None

    def _cells(self, i: int) -> list[str]:
        return split_cells(self._lines[i], self._delimiter)

    def _names(self, row: int) -> tuple[int, list[str]]:
        """The line with the names of the columns, above a row, and the names."""
        above = [i for i in self._texts if i < row]
        count = len(self._cells(row))
        for i in above:  # what a device writes before the names has other numbers of cells
            cells = self._cells(i)
            if len(cells) > 1 and len(_without_empty_end(cells)) in (count, count - 1):
                return i, cells
        comments = [i for i in range(row) if _COMMENT.match(self._lines[i])]
        for i in reversed(comments):
            names = split_cells(_COMMENT.sub("", self._lines[i], count=1), self._delimiter)
            if len(names) == count and not _is_row(names):
                return i, names
        if above:
            i = above[-1]
            if self._delimiter not in self._lines[i]:
                raise self._no_names(i)
            return i, self._cells(i)
        raise LogError(
            f"{self._path}: line {row + 1} has numbers, expected the names of the columns; "
            "add a line of names above it"
        )

    def _with_units(self, names: list[str], names_line: int, row: int) -> list[str]:
        """Adds the units of a line between names and rows to the names."""
        between = [i for i in self._texts if names_line < i < row]
        if not between:
            return names
        units = self._cells(between[0])
        if len(units) != len(names):
            return names
        self._notes.append(RowOfUnits(line=between[0] + 1))
        given = zip(names, (unit.strip("[]()") for unit in units), strict=True)
        return [f"{name} [{unit}]" if unit else name for name, unit in given]

    def _distinct(self, names: Sequence[str]) -> list[str]:
        """Gives columns without a name, and further columns of one name, names of their own."""
        found: list[str] = []
        for place, name in enumerate(names, 1):
            new, count = name or f"column {place}", 2
            while new in found:
                new, count = f"{name} ({count})", count + 1
            if name and new != name:
                self._notes.append(RepeatedName(column=name, renamed=new))
            found.append(new)
        return found

    def _note_skipped(self, names_line: int, row: int) -> None:
        """Notes lines of comments, of a device, or of Excel before the rows."""
        used = {names_line, *(i for i in self._texts if i > names_line)}
        skipped = [i for i in range(row) if self._lines[i].strip() and i not in used]
        if skipped:
            self._notes.append(LinesAboveTable(lines=len(skipped)))

    def _no_names(self, i: int) -> LogError:
        for k in self._texts:
            found = _LIST.search(self._lines[k])
            if found:
                return LogError(
                    f"{self._path}: line {k + 1} has a list in a cell ({found[0][:_SHOWN]!r}), "
                    "expected numbers; save each element of the lists as a column of its own"
                )
        return LogError(
            f"{self._path}: line {i + 1} is {self._lines[i][:_SHOWN]!r}, expected names of columns "
            "that commas, semicolons or tabs separate"
        )

    def _no_rows(self) -> LogError:
        first = self._texts[0]
        has_list = any(_LIST.search(self._lines[i]) for i in self._texts)
        if has_list or self._delimiter not in self._lines[first]:
            return self._no_names(first)
        return LogError(
            f"{self._path}: expected rows below the column names, found none; record it again"
        )


def split_cells(line: str, delimiter: str) -> list[str]:
    cells = line.split() if delimiter == SPACES else line.split(delimiter)
    if '"' in line and delimiter != SPACES:  # a delimiter within quotes belongs to the cell
        with suppress(csv.Error):  # a cell that is longer than csv reads
            cells = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    return [cell.strip().strip('"') for cell in cells]


def _without_empty_end(cells: Sequence[str]) -> Sequence[str]:
    end = len(cells)
    while end and not cells[end - 1]:
        end -= 1
    return cells[:end]


def _is_row(cells: Sequence[str]) -> bool:
    """Whether most cells that are not empty may be numbers or dates, as in no line of names."""
    filled = [cell for cell in cells if cell]
    values = sum(may_be_value(cell) for cell in filled)
    return bool(filled) and 2 * values >= len(filled)


def may_be_value(cell: str) -> bool:
    """Whether a cell may be a number, a date or a missing value instead of a name or a unit.

    A date has more digits than letters, unlike a name such as "0x6064:00 Position" or "1st motor".
    """
    digits, letters = sum(map(str.isdigit, cell)), sum(map(str.isalpha, cell))
    is_date = cell[:1].isdigit() and digits >= letters
    return is_date or (is_number(cell.replace(",", ".")) and cell != "")
