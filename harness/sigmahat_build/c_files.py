"""Chooses the C files of an FMU: those of its version of FMI, and the headers they include."""

import re
from collections.abc import Iterable
from pathlib import Path


def for_version(files: Iterable[Path], fmi: int) -> list[Path]:
    """Selects the files for FMI 2.0 or 3.0, without files in the folder of the other version."""
    return [file for file in files if file.parent.name != {2: "fmi3", 3: "fmi2"}[fmi]]


def with_headers(files: Iterable[Path]) -> list[Path]:
    """Returns files and all headers that the files include, directly or indirectly.

    Other headers come with the importer (FMI) or the compiler. Raises ``ValueError`` for two files
    of one name: the FMU has all files in one folder.
    """
    waiting = list(files)
    folders = sorted({file.parent for file in waiting})
    by_name: dict[str, Path] = {}
    while waiting:
        file = waiting.pop()
        if file.name not in by_name:
            by_name[file.name] = file
            for name in re.findall(r'^#include "(.+)"', file.read_text("utf-8"), re.MULTILINE):
                waiting += [folder / name for folder in folders if (folder / name).is_file()]
        elif by_name[file.name] != file:
            raise ValueError(f"expected one file {file.name}, got {by_name[file.name]} and {file}")
    return list(by_name.values())
