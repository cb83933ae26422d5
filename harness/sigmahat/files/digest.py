"""SHA-256 of a file or a folder, as `sha256sum` prints it."""

from __future__ import annotations

import hashlib
from pathlib import Path

_CHUNK = 1 << 20


def sha256(path: Path) -> str:
    """Of a file its bytes; of a folder, such as a ROS 2 bag, the list of its files.

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
        while chunk := file.read(_CHUNK):
            digest.update(chunk)
    return digest.hexdigest()
