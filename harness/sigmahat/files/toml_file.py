"""Reads and changes TOML files, such as the configuration of a log."""

import sys
from collections.abc import Iterator, Mapping, MutableMapping
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.items import InlineTable, Item

from sigmahat.files.whole_file import read_whole

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


_LONGEST = 256_000
_MOST_KEYS = 1000
_DEEPEST = 6


def read(path: Path) -> tomlkit.TOMLDocument:
    """Reads a TOML document with comments; the method unwrap() returns plain dictionaries.

    Raises OSError if the file cannot be read. Raises ValueError if the file is not TOML (with the
    place), or far larger than a file written by hand.
    """
    text = read_whole(path, _LONGEST).replace("\r\n", "\n").replace("\r", "\n")
    # The time that tomlkit takes grows with the square of the keys, and more with their depth.
    try:
        keys = _keys(tomllib.loads(text), 1)
    except RecursionError:
        raise ValueError(f"expected at most {_DEEPEST} tables in tables") from None
    if keys > _MOST_KEYS:
        raise ValueError(f"expected at most {_MOST_KEYS} keys, got {keys}")
    return tomlkit.parse(text)


def _keys(value: Any, depth: int) -> int:
    """Counts keys and tables in a value, at any depth. Raises ValueError if nested too deep."""
    if not isinstance(value, (dict, list)):
        return 0
    if depth > _DEEPEST:
        raise ValueError(f"expected at most {_DEEPEST} tables in tables")
    if isinstance(value, dict):
        return len(value) + sum(_keys(each, depth + 1) for each in value.values())
    return sum(1 + _keys(each, depth + 1) for each in value if isinstance(each, (dict, list)))


def dotted(table: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Yields values of nested tables by dotted name: motor.B = 1 is a nested table in TOML."""
    for name, value in table.items():
        if isinstance(value, Mapping):
            yield from dotted(value, f"{above}{name}.")
        else:
            yield f"{above}{name}", value


def set_dotted(table: MutableMapping[str, Any], name: str, item: Item) -> None:
    """Sets a dotted key in the form that the table uses: motor.B, "motor.B", or table motor."""
    group, _, last = name.partition(".")
    if name in table or not last:
        table[name] = item
    elif group in table:
        if isinstance(table[group], InlineTable):
            item.trivia.comment = ""  # a comment would end the line inside of the braces
        table[group][last] = item
    else:
        table.append(tomlkit.key([group, last]), item)  # type: ignore[attr-defined]
