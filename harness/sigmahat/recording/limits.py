"""Limits for the size of the columns of a log.

A compressed file of some kilobytes can expand to many gigabytes, which would fill the memory.
Recorded data never compress so strongly. Each limit has a lower bound, so that a file of usual size
is always accepted.
"""

from pathlib import Path

from sigmahat.recording.log import LogError

MOST_COLUMNS = 2000
_NUMBERS, _SMALL = 15_000_000, 10_000_000  # allowed numbers in a file up to this size [bytes]
_TOGETHER = 2  # factor of the limit if all columns are in memory at the same time
_NUMBERS_PER_BYTE = 3  # limit for further bytes; without compression, at most 1 is possible
_BYTES = 400_000_000  # limit for all columns of a file that is read as a whole
_MESSAGES, _BYTES_PER_MESSAGE = 1_000_000, 10  # in a bag of any size, and for further bytes
_DATA, _DATA_PER_BYTE = 200_000_000, 8  # bytes of the messages of a bag that are decoded
_UNPACKED, _UNPACKED_PER_BYTE = 1_000_000_000, 30  # [bytes]; a bag is unpacked in pieces
MOST_TEXT = 100_000_000  # characters of a column of text at a time


def _size(path: Path) -> int:
    """Returns the bytes of a file, or of the files in the folder of a bag."""
    files = path.iterdir() if path.is_dir() else (path,)
    return sum(file.stat().st_size for file in files)


def _most_numbers(path: Path) -> int:
    """Returns the allowed number of values in a column of a file, by the size of the file."""
    return _NUMBERS + _NUMBERS_PER_BYTE * max(0, _size(path) - _SMALL)


def check_together(path: Path, numbers: int) -> None:
    """Raises LogError for too many numbers in all columns together, which share the memory."""
    # For fewer numbers, the size of the file does not matter.
    if numbers > _TOGETHER * _NUMBERS and numbers > (most := _TOGETHER * _most_numbers(path)):
        raise LogError(
            f"{path}: expected at most {most} numbers, got {numbers}; "
            "save only the columns of one joint, or fewer rows"
        )


def check_columns(path: Path, columns: int) -> None:
    """Raises LogError for too many columns."""
    if columns > MOST_COLUMNS:
        raise LogError(
            f"{path}: expected at most {MOST_COLUMNS} columns, got {columns}; "
            "save only the columns of one joint"
        )


def check_numbers(path: Path, numbers: int) -> None:
    """Raises LogError for more numbers in a column than the size of the file allows."""
    # For fewer numbers, the size of the file is not needed: the file may be deleted already.
    if numbers > _NUMBERS and numbers > _most_numbers(path):
        raise LogError(
            f"{path}: expected at most {_most_numbers(path)} numbers in a file of this size, got "
            f"{numbers} or more; save it without compression, or in parts"
        )


def check_bytes(path: Path, size: int) -> None:
    """Raises LogError if columns that are read at once would need too much memory [bytes]."""
    most = max(_BYTES, 8 * _most_numbers(path))
    if size > most:
        raise LogError(
            f"{path}: expected at most {most / 1e6:.0f} MB of data in a file of this size, got "
            f"{size / 1e6:.0f} MB; save it without compression, or in parts"
        )


def check_messages(path: Path, messages: int) -> None:
    """Raises LogError for more messages in a bag than its size allows."""
    if messages > _MESSAGES and messages > (most := _size(path) // _BYTES_PER_MESSAGE):
        raise LogError(
            f"{path}: expected at most {max(most, _MESSAGES)} messages in a bag of this size, got "
            "more; record fewer topics, or without compression"
        )


def check_unpacked(path: Path, size: int) -> None:
    """Raises LogError if a bag is far larger [bytes] without compression."""
    if size > _UNPACKED and size > (most := _UNPACKED_PER_BYTE * _size(path)):
        raise LogError(
            f"{path}: expected at most {max(most, _UNPACKED) / 1e6:.0f} MB in a bag of this size "
            "without compression, got more; record it without compression"
        )


def check_data(path: Path, size: int) -> None:
    """Raises LogError if the messages that are to be decoded are too many bytes."""
    if size > _DATA and size > (most := _DATA_PER_BYTE * _size(path)):
        raise LogError(
            f"{path}: expected at most {max(most, _DATA) / 1e6:.0f} MB of messages with numbers in "
            "a bag of this size, got more; record fewer topics, or without compression"
        )
