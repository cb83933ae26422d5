"""What a command writes: folders and files that are complete or not there, and their SHA-256."""

from __future__ import annotations

import hashlib
import os
import platform
import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from shutil import rmtree


@contextmanager
def created_folder(path: Path, ignored: str = "") -> Iterator[None]:
    """Creates a folder if there is none; at the end it is removed again if nothing is in it.

    ignored  name of a file that does not count as something, and is removed with the folder

    Raises OSError if the folder cannot be created.
    """
    missing = [p for p in (path, *path.parents) if not p.exists()]
    try:
        path.mkdir(parents=True, exist_ok=True)
        yield
    finally:
        if missing and [p.name for p in path.glob("*")] == [ignored]:
            (path / ignored).unlink()
        for p in missing:
            with suppress(OSError):  # something is in it
                p.rmdir()


@contextmanager
def output_folder(path: Path) -> Iterator[Path]:
    """Yields a folder to write into; its files appear in path together, once all is well.

    Creates path, and leaves nothing behind after an exception. Raises OSError if path cannot be
    written to.
    """
    with created_folder(path), unfinished_folder(path) as unfinished:
        yield unfinished


@contextmanager
def unfinished_folder(path: Path) -> Iterator[Path]:
    """The same for a folder that exists.

    What processes that were killed have left there is removed.
    """
    # The name is fixed before the folder is made: an interrupt at any moment leaves nothing.
    unfinished = path / f".unfinished-{os.getpid()}{_HOST}"
    _remove_abandoned(path)
    try:
        unfinished.mkdir()
        yield unfinished
        for file in sorted(unfinished.iterdir()):
            file.replace(path / file.name)
        unfinished.rmdir()
    except BaseException:
        rmtree(unfinished, ignore_errors=True)
        raise


_HOST = "@" + re.sub(r"[^\w.-]", "_", platform.node())
"""Of names: the number of a process says nothing on another machine, which may share the folder."""
_UNFINISHED = re.compile(rf"\.unfinished-(\d{{1,9}}){re.escape(_HOST)}")


def _remove_abandoned(path: Path) -> None:
    """Removes the unfinished folders of processes of this machine that have ended."""
    for each in path.glob(".unfinished-*"):
        match = _UNFINISHED.fullmatch(each.name)
        if match and not _runs(int(match[1])):
            rmtree(each, ignore_errors=True)


def _runs(process: int) -> bool:
    """Whether another process with this number may be running."""
    if process == os.getpid():
        return False
    if os.name != "posix":  # there os.kill ends processes
        return True
    try:
        os.kill(process, 0)  # sends nothing
    except ProcessLookupError:
        return False
    except OSError:  # it is of another user
        return True
    return True


def write_whole(text: str, path: Path) -> None:
    """Writes a file in UTF-8. If it is interrupted, the file is as it was before.

    A link stays a link to the file. Raises OSError if it cannot be written.
    """
    if path.exists() and not path.is_file():  # such as /dev/stdout; a folder is refused
        path.write_text(text, encoding="utf-8")
        return
    file = path.resolve()
    try:
        with unfinished_folder(file.parent) as folder:
            (folder / file.name).write_text(text, encoding="utf-8")
    except OSError as error:  # it names what nobody has heard of
        raise OSError(error.errno, error.strerror, str(path)) from error


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
