"""TOML files: the configuration of a log, the plan of a sweep."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import tomlkit


def read(path: Path) -> tomlkit.TOMLDocument:
    """The document, with its comments; its method unwrap() gives plain dictionaries.

    Raises OSError if the file cannot be read, ValueError, which says where, if it is not TOML.
    """
    return tomlkit.parse(path.read_text(encoding="utf-8"))


def dotted(table: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Values of nested tables by their dotted names: motor.B = 1 is a table in a table to TOML."""
    for name, value in table.items():
        if isinstance(value, Mapping):
            yield from dotted(value, f"{above}{name}.")
        else:
            yield f"{above}{name}", value
