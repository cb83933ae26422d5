"""Makes the rows of a text file ready for a reader of CSV, with notes on what was done.

Below the rows there may be statistics or an end mark; between them comments, or the names of the
columns again where a device appended a recording. A terminal puts its own time before each line, a
spreadsheet separates thousands. A file without any of these is read as it is.
"""

import re
import weakref
from collections.abc import Sequence
from itertools import islice
from mmap import ACCESS_READ, mmap
from pathlib import Path
from tempfile import TemporaryFile
from typing import IO

from sigmahat.recording.notes import (
    CommentsLeftOut,
    LinesBelowTable,
    NamesAgain,
    PrefixLeftOut,
    RecordingNote,
    ThousandsSeparated,
)
from sigmahat.recording.readers.dialect import PREFIX, SPACES, Dialect
from sigmahat.recording.readers.footer import footer_lines

_COMMENTS = (b"#", b"%", b"//")  # signs at the beginning of a comment
_PREFIX = re.compile(PREFIX.pattern.encode())


class TidyText:
    """The text of a table without what stands between its rows, and with one delimiter between two
    columns: the file itself, or a copy.
    """

    def __init__(self, path: Path, dialect: Dialect) -> None:
        self._path, self._dialect = path, dialect
        self._names = dialect.names_line.encode(dialect.encoding).strip()
        self._thousands = _thousands(dialect)
        self._comments = 0  # lines
        self._again: list[int] = []  # lines in the file with the names of the columns
        self._example = b""  # of a number with separators of thousands
        self._footer = footer_lines(path, dialect)
        self._end = 0  # line at which the footer begins, from 1 on; 0 without one
        self._copy: IO[bytes] | None = None
        with path.open("rb") as file, mmap(file.fileno(), 0, access=ACCESS_READ) as text:
            is_table = not dialect.prefix and not self._is_aligned and not self._footer
            is_tidy = is_table and not self._is_mixed(text)
        if not is_tidy:
            self._copy = self._copied()

    def open(self) -> Path | IO[bytes]:
        """Returns the text, at its beginning; a copy is a file that stays open."""
        if self._copy is None:
            return self._path
        self._copy.seek(0)
        return self._copy

    @property
    def notes(self) -> Sequence[RecordingNote]:
        """What was done."""
        notes: list[RecordingNote] = []
        if self._dialect.prefix:
            notes.append(PrefixLeftOut(prefix=self._dialect.prefix))
        if self._again:
            notes.append(NamesAgain(line=self._again[0], lines=len(self._again)))
        if self._example:
            notes.append(ThousandsSeparated(example=self._example.decode("ascii")))
        if self._comments:
            notes.append(CommentsLeftOut(lines=self._comments))
        if self._footer:
            notes.append(LinesBelowTable(line=self._end, lines=self._footer))
        return notes

    @property
    def _is_aligned(self) -> bool:
        """Whether any number of spaces is between two columns."""
        return self._dialect.delimiter == SPACES

    def _is_mixed(self, text: mmap) -> bool:
        """Whether a file has comments or names below its first line, or separated thousands."""
        if any(text.find(b"\n" + sign) >= 0 for sign in _COMMENTS):
            return True
        if self._names and text.find(b"\n" + self._names, len(self._names)) >= 0:
            return True
        return self._thousands is not None and self._thousands.search(text) is not None

    def _copied(self) -> IO[bytes]:
        copy = TemporaryFile(prefix="sigmahat-")  # noqa: SIM115
        weakref.finalize(self, copy.close)
        with self._path.open("rb") as file:
            if self._footer:
                count = sum(1 for _ in file)
                self._end = count - self._footer + 1
                file.seek(0)
            rows = islice(file, self._end - 1) if self._footer else file
            for number, line in enumerate(rows):
                if number < self._dialect.head:
                    copy.write(line)
                else:
                    copy.write(self._tidied(line, number + 1))
        return copy

    def _tidied(self, line: bytes, number: int) -> bytes:
        """Returns a line below the names for the copy, empty if it is no row."""
        if self._dialect.prefix:
            line = _PREFIX.sub(b"", line, count=1)
        text = line.strip()
        if text.startswith(_COMMENTS):
            self._comments += 1
            return b""
        if self._names and text == self._names:
            self._again.append(number)
            return b""
        if self._thousands is not None:
            line = self._thousands.sub(self._without_separators, line)
        return b" ".join(line.split()) + b"\n" if self._is_aligned else line

    def _without_separators(self, number: re.Match[bytes]) -> bytes:
        if not self._example:
            self._example = number[0]
        separator = b"." if self._dialect.decimal == "," else b","
        return number[0].replace(separator, b"")


def _thousands(dialect: Dialect) -> re.Pattern[bytes] | None:
    """Returns the pattern of whole thousands with separators, such as 1.234 of 1.234,56."""
    if dialect.decimal == ",":
        return re.compile(rb"(?<![\d.,:/])(?<!\d-)[1-9]\d{0,2}(?:\.\d{3})+(?![\d.:/-])")
    if dialect.delimiter == ",":  # which belongs to a number only within quotes
        return re.compile(rb'(?<=")[+-]?[1-9]\d{0,2}(?:,\d{3})+(?=(?:\.\d*)?")')
    return re.compile(rb"(?<![\d.,:/])(?<!\d-)[1-9]\d{0,2}(?:,\d{3})+(?![\d,:/-])")
