"""The C library as one pair of files, for those who want to drop it into a project."""

import re
from collections.abc import Iterable
from pathlib import Path

_OWN_INCLUDE = re.compile(r'^#include "(.+)"\n', re.MULTILINE)


def write(out: Path, sources: Iterable[Path], interface: Path, licence: Path, version: str) -> None:
    """Write ``sigmahat.h`` and ``sigmahat.c`` into the folder ``out``.

    sources    C files of the library
    interface  header whose contents, with all that it includes, make ``sigmahat.h``
    licence    text that has to go with the code

    Raises ``FileNotFoundError`` for a file, or a header included by one, that is missing.
    """
    lines = [f"sigmahat {version}: all of the library in one file.", ""]
    lines += licence.read_text(encoding="utf-8").splitlines()
    head = "/* " + "\n".join(f" * {line}".rstrip() for line in lines)[3:] + "\n */\n"
    done: set[Path] = set()
    header = _inlined(interface, done)
    body = "".join(_inlined(source, done) for source in sources)
    out.mkdir(parents=True, exist_ok=True)
    (out / "sigmahat.h").write_text(head + header, encoding="utf-8")
    (out / "sigmahat.c").write_text(head + '#include "sigmahat.h"\n' + body, encoding="utf-8")


def _inlined(file: Path, done: set[Path]) -> str:
    """A file with the headers of the library that it includes, each where it is needed first."""
    if file in done:
        return ""
    done.add(file)
    text = _OWN_INCLUDE.sub(
        lambda match: _inlined(file.parent / match[1], done), file.read_text(encoding="utf-8")
    )
    return f"\n/* ---- {file.name} ---- */\n\n{text}"
