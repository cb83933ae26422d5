"""The Modelica package as an archive, in the form in which Modelica tools load it."""

import re
from collections.abc import Iterable
from pathlib import Path

from sigmahat.export import archive


def write(out: Path, library: Path, sources: Iterable[Path], licence: Path, version: str) -> None:
    """Write the archive ``out`` with one folder, ``Sigmahat VERSION``.

    library  folder of the package, with its ``package.mo``
    sources  C files and headers to add to its ``Resources/C-Sources``

    Equal files give equal bytes. Raises ``ValueError`` if the package says that it has another
    version, ``FileNotFoundError`` for a file that is missing.
    """
    text = (library / "package.mo").read_text(encoding="utf-8")
    stated = re.search(r'^\s*version="(.*)",$', text, re.MULTILINE)
    if stated is None or stated[1] != version:
        received = stated[1] if stated else "none"
        raise ValueError(f"{library / 'package.mo'}: expected version {version}, got {received}")
    folder = f"{library.name} {version}"
    files = sorted(file for file in library.rglob("*") if file.is_file())
    contents = {f"{folder}/{file.relative_to(library).as_posix()}": file for file in files}
    contents |= {f"{folder}/Resources/C-Sources/{file.name}": file for file in sources}
    archive.write(out, {**contents, f"{folder}/LICENSE": licence})
