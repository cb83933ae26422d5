"""Limits for the contents of a log: a small file must not fill the memory.

Some kilobytes of a compressed file can become many gigabytes. Recorded data are far from this
ratio. Each limit has a lower bound, so that no limit concerns a file of usual size.
"""

from __future__ import annotations

from pathlib import Path

from sigmahat.logs.log import LogError

MOST_COLUMNS = 2000
_NUMBERS, _SMALL = 15_000_000, 10_000_000  # allowed numbers in a file up to this size [bytes]
_TOGETHER = 2  # factor for all columns together, where they are needed at the same time
_NUMBERS_PER_BYTE = 3  # for further bytes; without compression, at most 1 is possible
_BYTES = 400_000_000  # of all columns of a file that is read as a whole
MOST_TEXT = 100_000_000
"""Characters of a column of text at a time."""


def most_numbers(path: Path) -> int:
    """How many numbers a column of a file may hold."""
    files = path.iterdir() if path.is_dir() else (path,)  # the folder of a bag
    size = sum(file.stat().st_size for file in files)
    return _NUMBERS + _NUMBERS_PER_BYTE * max(0, size - _SMALL)


def check_together(path: Path, numbers: int) -> None:
    """Raises LogError for more numbers than all columns that are compared may hold."""
    most = _TOGETHER * _NUMBERS
    if numbers > most:  # for fewer numbers, the size of the file does not matter
        most = _TOGETHER * most_numbers(path)
    if numbers > most:
        raise LogError(
            f"{path}: {numbers} numbers, expected at most {most} to guess from; "
            "save the columns of one joint alone, or fewer rows"
        )


def check_columns(path: Path, columns: int) -> None:
    """Raises LogError for too many columns."""
    if columns > MOST_COLUMNS:
        raise LogError(
            f"{path}: {columns} columns, expected at most {MOST_COLUMNS}; "
            "save the columns of one joint alone"
        )


def check_numbers(path: Path, numbers: int) -> None:
    """Raises LogError for more numbers than a file of this size may hold."""
    if numbers <= _NUMBERS:  # then the file, which may have vanished, does not matter
        return
    if numbers > most_numbers(path):
        raise LogError(
            f"{path}: {numbers} numbers or more in a file of {path.stat().st_size / 1e6:.3g} MB, "
            f"expected at most {most_numbers(path)}; save it without compression, or in parts"
        )


def check_bytes(path: Path, size: int) -> None:
    """Raises LogError for more bytes than all columns that are read at once may take."""
    most = max(_BYTES, 8 * most_numbers(path))
    if size > most:
        raise LogError(
            f"{path}: {size / 1e6:.0f} MB in a file of {path.stat().st_size / 1e6:.3g} MB, "
            f"expected at most {most / 1e6:.0f} MB; save it without compression, or in parts"
        )
