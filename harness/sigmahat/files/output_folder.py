"""Folders that a command writes to: nothing is left behind where it fails."""

from __future__ import annotations

import os
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
    # The name is fixed before the folder is made: an interrupt at any moment leaves nothing.
    unfinished = path / f".unfinished-{os.getpid()}"
    with created_folder(path):
        try:
            unfinished.mkdir()
            yield unfinished
            for file in sorted(unfinished.iterdir()):
                file.replace(path / file.name)
            unfinished.rmdir()
        except BaseException:
            rmtree(unfinished, ignore_errors=True)
            raise
