"""The source code that an FMU carries: its C files, and the headers that they include."""

import re
from collections.abc import Iterable
from pathlib import Path


def for_version(files: Iterable[Path], fmi: int) -> list[Path]:
    """The files of an FMU of FMI 2.0 or 3.0: not those in the folder of the other version."""
    return [file for file in files if file.parent.name != {2: "fmi3", 3: "fmi2"}[fmi]]


def names(files: Iterable[Path]) -> list[str]:
    """The names of the C files among some files, which are those to compile."""
    return [file.name for file in files if file.suffix == ".c"]


def with_headers(files: Iterable[Path]) -> list[Path]:
    """The files given, and the headers they include from each other's folders, in any depth.

    A header in none of these folders is the importer's (FMI) or the compiler's. Raises
    ``ValueError`` for two files of one name: in the FMU all are in one folder.
    """
    waiting = list(files)
    folders = sorted({file.parent for file in waiting})
    found: dict[str, Path] = {}
    while waiting:
        file = waiting.pop()
        if file.name not in found:
            found[file.name] = file
            for name in re.findall(r'^#include "(.+)"', file.read_text("utf-8"), re.MULTILINE):
                waiting += [folder / name for folder in folders if (folder / name).is_file()]
        elif found[file.name] != file:
            raise ValueError(f"expected one file {file.name}, got {found[file.name]} and {file}")
    return list(found.values())
