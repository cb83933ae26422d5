"""Writes folders and files that are complete or do not exist, and computes their SHA-256."""

import hashlib
import json
import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any


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

    Creates path. After an exception, no file remains. Raises OSError if path cannot be
    written to.
    """
    with created_folder(path), TemporaryDirectory(prefix=".unfinished-", dir=path) as unfinished:
        yield Path(unfinished)
        for file in sorted(Path(unfinished).iterdir()):
            file.replace(path / file.name)


def write_whole(text: str, path: Path) -> None:
    """Writes a file in UTF-8. After an interruption, the file is unchanged.

    A link stays a link to the file. Raises OSError if the file cannot be written.
    """
    if path.exists() and not path.is_file():  # such as /dev/stdout; a folder is refused
        path.write_text(text, encoding="utf-8")
        return
    file = path.resolve()
    try:
        with TemporaryDirectory(prefix=".unfinished-", dir=file.parent) as folder:
            whole = Path(folder, file.name)
            whole.write_text(text, encoding="utf-8")
            whole.replace(file)
    except OSError as error:  # it names a temporary file
        raise OSError(error.errno, error.strerror, str(path)) from error


def write_json(values: object, path: Path) -> None:
    """Writes JSON, numbers with all digits; a number that is not finite becomes null."""
    text = json.dumps(finite(values), indent=1, allow_nan=False)
    path.write_text(text + "\n", encoding="utf-8")


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
