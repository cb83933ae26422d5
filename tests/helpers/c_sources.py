"""The C code of the library: where it is, and what a compiler needs to find its headers."""

from __future__ import annotations

from pathlib import Path

LIBRARY = Path(__file__).resolve().parents[2] / "c"
SOURCES = sorted(LIBRARY.rglob("*.c"))
HEADERS = sorted(LIBRARY.rglob("*.h"))
FOLDERS = sorted({header.parent for header in HEADERS})
