"""Finds what stands below the rows of a text file: statistics, remarks, or an end mark."""

from itertools import takewhile
from pathlib import Path

from sigmahat.recording.arrow_columns import MISSING
from sigmahat.recording.readers.dialect import PREFIX, Dialect, may_be_value, split_cells

_LONGEST = 1 << 16  # bytes at the end of a file that are looked at


def footer_lines(path: Path, dialect: Dialect) -> int:
    """Counts the lines below the rows: they begin with text, and the rows begin with a number.

    A row that was cut off begins with a number, too, and is none of them.
    """
    with path.open("rb") as file:
        for _ in range(dialect.head):
            file.readline()
        begin = file.tell()
        if not _is_row(file.readline(), dialect):
            return 0
        file.seek(0, 2)
        file.seek(max(begin, file.tell() - _LONGEST))
        lines = file.read().splitlines(keepends=True)
    below = list(takewhile(lambda line: not _is_row(line, dialect), reversed(lines)))
    has_text = any(line.strip() for line in below)
    return len(below) if has_text and len(below) < len(lines) else 0


def _is_row(line: bytes, dialect: Dialect) -> bool:
    """Returns whether a line begins with a number, a date, or a text that stands for none."""
    text = line.decode(dialect.encoding, errors="replace").strip("\r\n")
    if dialect.prefix:
        text = PREFIX.sub("", text, count=1)
    first = split_cells(text, dialect.delimiter)[:1]
    return bool(text.strip()) and (first == [""] or first[0] in MISSING or may_be_value(first[0]))
