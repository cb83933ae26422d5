"""Writes folders and files that are complete or do not exist, and computes their SHA-256."""

import hashlib
import json
import math
import os
import stat
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

_UNFINISHED = ".unfinished-"  # prefix of folders for files that are not complete


@contextmanager
def created_folder(path: Path) -> Iterator[None]:
    """Creates a folder if it does not exist. At the end, a new folder without files is removed.

    Raises OSError if the folder cannot be created.
    """
    missing = [p for p in (path, *path.parents) if not p.exists()]
    try:
        path.mkdir(parents=True, exist_ok=True)
        yield
    finally:
        for p in missing:
            with suppress(OSError):  # the folder is not empty
                p.rmdir()


@contextmanager
def output_folder(path: Path) -> Iterator[Path]:
    """Yields a folder to write into. At the end, its files are moved to path together.

    Creates path. After an exception, no file remains, and files of path are unchanged. Raises
    OSError if path cannot be written to.
    """
    with created_folder(path), TemporaryDirectory(prefix=_UNFINISHED, dir=path) as unfinished:
        yield Path(unfinished)
        _move(sorted(Path(unfinished).iterdir()), path)


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Yields the path of a file to write. At the end, this file replaces the file at path.

    After an exception, a full disk or the end of the process, the file at path is unchanged. The
    new file has the mode of the old one. A link stays a link to the file. In an output_folder(),
    the file is written directly, because the end of the folder does all this.

    Raises OSError if the file cannot be written.
    """
    is_special = path.exists() and not path.is_file()  # such as /dev/stdout; a folder is refused
    if is_special or path.parent.name.startswith(_UNFINISHED):
        yield path
        return
    file = path.resolve()
    try:
        with TemporaryDirectory(prefix=_UNFINISHED, dir=file.parent) as folder:
            unfinished = Path(folder, file.name)
            yield unfinished
            _move([unfinished], file.parent)
    except OSError as error:  # it names a temporary file
        raise OSError(error.errno, error.strerror, str(path)) from error


def _move(files: Sequence[Path], folder: Path) -> None:
    """Moves files into a folder, after all of their bytes are on the disk."""
    for file in files:
        with file.open("rb+") as opened:
            os.fsync(opened.fileno())
        with suppress(FileNotFoundError):
            file.chmod(stat.S_IMODE((folder / file.name).stat().st_mode))
    for file in files:
        file.replace(folder / file.name)
    if os.name == "posix":  # elsewhere a folder cannot be opened
        descriptor = os.open(folder, os.O_RDONLY)
        with suppress(OSError):  # some file systems cannot do this, and need not
            os.fsync(descriptor)
        os.close(descriptor)


def write_whole(text: str, path: Path) -> None:
    """Writes a text in UTF-8 as whole_file() does."""
    with whole_file(path) as file:
        file.write_text(text, encoding="utf-8")


def write_json(values: object, path: Path) -> None:
    """Writes JSON as whole_file() does, numbers with all digits; one that is not finite is null."""
    write_whole(json.dumps(finite(values), indent=1, allow_nan=False) + "\n", path)


def finite(values: Any) -> Any:
    """Replaces numbers that are not finite by None for JSON, at any depth."""
    if isinstance(values, Mapping):
        return {str(key): finite(value) for key, value in values.items()}
    if isinstance(values, (list, tuple)):
        return [finite(value) for value in values]
    return None if isinstance(values, float) and not math.isfinite(values) else values


def sha256(path: Path) -> str:
    """Computes the hash of a file, or of the list of files in a folder such as a ROS 2 bag.

    The list has a line "HASH  NAME" for each file, sorted by name, which `sha256sum` would write.

    Raises OSError if a file cannot be read.
    """
    if not path.is_dir():
        return _of_file(path)
    files = sorted(each.relative_to(path).as_posix() for each in path.rglob("*") if each.is_file())
    lines = "".join(f"{_of_file(path / name)}  {name}\n" for name in files)
    return hashlib.sha256(lines.encode()).hexdigest()


def _of_file(path: Path) -> str:
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while chunk := file.read(1 << 20):
            digest.update(chunk)
    return digest.hexdigest()
