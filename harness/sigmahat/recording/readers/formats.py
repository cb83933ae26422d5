"""Opens a log. The format is determined by the contents of the file, not by the file name."""

import re
from collections.abc import Collection
from pathlib import Path

from sigmahat.recording.limits import check_columns
from sigmahat.recording.log import Log, LogError
from sigmahat.recording.readers.bags import read_bag
from sigmahat.recording.readers.csv_parquet import CsvLog, ParquetLog
from sigmahat.recording.readers.json_lines import JsonLog
from sigmahat.recording.readers.matrices import read_hdf5, read_mat

_PACKED = (
    (b"\x1f\x8b", "compressed with gzip", "unpack it: gunzip --keep {}"),
    (
        b"PK\x03\x04",
        "an Excel workbook or a ZIP archive",
        "save a workbook as CSV; unpack an archive",
    ),
    (b"\xff\xfe", "text in UTF-16", "convert it: iconv -f UTF-16 -t UTF-8 {}"),
    (b"BZh", "compressed with bzip2", "unpack it: bunzip2 --keep {}"),
    (b"\x28\xb5\x2f\xfd", "compressed with Zstandard", "unpack it: unzstd {}"),
)
_JSON = re.compile(rb"(\xef\xbb\xbf)?\s*(\[\s*)?\{")  # one object, or an array of objects
_BAGS = (b"\x89MCAP0\r\n", b"SQLite format 3\0")
_HEAD = 520  # bytes; in files of MATLAB the signature of HDF5 is at byte 512


def open_log(path: str | Path, wanted: Collection[str] | None = None) -> Log:
    """A log in CSV, JSON Lines, Parquet, MAT (v5 to v7.3), HDF5, MCAP, or a ROS 2 bag.

    Only the file itself is read, or the files in the folder of the bag, but no files outside to
    which they refer.

    wanted  the columns that are needed: of a bag, topics without any of them are not decoded, and
            their columns are missing. By default, all columns

    Raises LogError if the file is missing, empty, damaged, or of another format,
    and if the file holds more than a log may (log.py).
    """
    path = Path(path)
    head = _head(path)
    log = read_bag(path, wanted) if path.is_dir() or head.startswith(_BAGS) else _reader(path, head)
    if not log.columns or max(log.columns.values()) == 0:
        raise LogError(f"{path}: the file has no rows; record it again")
    check_columns(path, len(log.columns))
    return log


def need_log(path: Path) -> None:
    """Raises LogError if a log is missing or empty; the rest of the file is not read."""
    _head(path)


def _head(path: Path) -> bytes:
    """The first bytes of a log; none of a bag in a folder."""
    if path.is_dir():
        if not (path / "metadata.yaml").is_file():
            raise LogError(f"{path}: expected a file or a ROS 2 bag, got another folder")
        return b""
    if path.exists() and not path.is_file():  # reading a pipe would wait
        raise LogError(f"{path}: expected a file, got a pipe or a device; name a log")
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD)
    except OSError as error:
        raise LogError(f"{path}: {error.strerror}; name a readable log") from error
    if not head:
        raise LogError(f"{path}: the file is empty; record it again")
    return head


def _reader(path: Path, head: bytes) -> Log:
    if head.startswith(b"PAR1"):
        return ParquetLog(path)
    if b"\x89HDF\r\n\x1a\n" in (head[:8], head[512:520]):
        return read_hdf5(path)
    if head.startswith(b"MATLAB 5.0 MAT-file"):
        return read_mat(path)
    for begin, what, then in _PACKED:
        if head.startswith(begin):
            raise LogError(f"{path}: {what}; {then.format(path)}, and name the result")
    if _JSON.match(head):
        return JsonLog(path)
    if b"\0" in head:
        raise LogError(
            f"{path}: unknown format; expected CSV, Parquet, MAT, HDF5, MCAP or a ROS 2 bag"
        )
    return CsvLog(path)
