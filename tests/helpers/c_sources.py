"""The C code of the library: where it is, and what a compiler needs to find its headers."""

from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
LIBRARY = REPOSITORY / "c"
SOURCES = sorted(LIBRARY.rglob("*.c"))
HEADERS = sorted(LIBRARY.rglob("*.h"))
FOLDERS = sorted({header.parent for header in HEADERS})
