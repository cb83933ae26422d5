"""TOML files: the configuration of a log, the plan of a sweep."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, MutableMapping
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.items import InlineTable, Item


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


def set_dotted(table: MutableMapping[str, Any], name: str, item: Item) -> None:
    """Sets motor.B in the form of the table: motor.B, "motor.B", or B in a table motor."""
    group, _, last = name.partition(".")
    if name in table or not last:
        table[name] = item
    elif group in table:
        if isinstance(table[group], InlineTable):
            item.trivia.comment = ""  # it would end the line inside of the braces
        table[group][last] = item
    else:
        table.append(tomlkit.key([group, last]), item)  # type: ignore[attr-defined]
