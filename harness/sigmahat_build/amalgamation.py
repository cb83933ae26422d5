"""Writes the C library as one pair of files, to copy into another project."""

import re
from collections.abc import Iterable
from pathlib import Path

_OWN_INCLUDE = re.compile(r'^#include "(.+)"\n', re.MULTILINE)


def write(out: Path, sources: Iterable[Path], interface: Path, licence: Path, version: str) -> None:
    """Write ``sigmahat.h`` and ``sigmahat.c`` into the folder ``out``.

    sources    C files of the library. They become one file with one namespace: if two files use
               the same name for something ``static``, the compiler reports an error
    interface  header whose contents, with all that it includes, make ``sigmahat.h``
    licence    text that has to go with the code

    Headers are searched in the folders of these files. Raises ``FileNotFoundError`` if a file, or a
    header that a file includes, is missing.
    """
    files = list(sources)
    folders = sorted({file.parent for file in [*files, interface]})
    lines = [f"sigmahat {version}: all of the library in one file.", ""]
    lines += licence.read_text(encoding="utf-8").splitlines()
    head = "/* " + "\n".join(f" * {line}".rstrip() for line in lines)[3:] + "\n */\n"
    done: set[Path] = set()
    header = _inlined(interface, folders, done)
    body = "".join(_inlined(source, folders, done) for source in files)
    out.mkdir(parents=True, exist_ok=True)
    (out / "sigmahat.h").write_text(head + header, encoding="utf-8")
    (out / "sigmahat.c").write_text(head + '#include "sigmahat.h"\n' + body, encoding="utf-8")


def _inlined(file: Path, folders: list[Path], done: set[Path]) -> str:
    """Replaces the first include of each library header in a file by the contents of the header."""
    if file in done:
        return ""
    done.add(file)

    def header(match: re.Match[str]) -> str:
        for folder in folders:
            if (folder / match[1]).is_file():
                return _inlined(folder / match[1], folders, done)
        expected = ", ".join(map(str, folders))
        raise FileNotFoundError(f"no header {match[1]}: expected it in {expected}")

    text = _OWN_INCLUDE.sub(header, file.read_text(encoding="utf-8"))
    return f"\n/* ---- {file.name} ---- */\n\n{text}"
