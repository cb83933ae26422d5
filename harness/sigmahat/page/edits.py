"""Keys of a configuration as text: read, set, removed. Comments of people stay."""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping
from typing import Any

import tomlkit
from tomlkit.items import Table

from sigmahat.logs.configuration import FILL_IN, NOT_YOURS, WIDE_PRIOR
from sigmahat.user_input import toml_file

Value = str | float | bool
GAMMA = "motor.gamma"
SECTIONS = ("ports", "time")
"""Keys that start so are of sections of their own; all others are of [parameters]."""
_NOT_ZERO = ("counts_per_turn", "gear_ratio", "torque_constant", "scale")
_OF_A_GUESS = (FILL_IN, "CHECK", NOT_YOURS, WIDE_PRIOR)
"""Begin of comments that are no longer true when somebody has set the value."""


def value_of(document: tomlkit.TOMLDocument, key: str) -> Any:
    """The value of a key as "ports.tau.sign" or "motor.B"; None if it is not there."""
    return next((value for name, value in _values(document) if name == key), None)


def set_value(document: tomlkit.TOMLDocument, key: str, value: Value) -> None:
    """Sets a key; what a guess said about it in a comment is dropped."""
    table, name = _place(document, key)
    whole = isinstance(value, float) and value.is_integer() and abs(value) < 2**53
    item = tomlkit.item(int(value) if whole else value)
    old = _item(document, key)
    if old is not None:
        comment = old.trivia.comment.removeprefix("#").strip()
        if comment.startswith(_OF_A_GUESS) or comment.endswith((NOT_YOURS, WIDE_PRIOR)):
            old.trivia.comment = old.trivia.comment_ws = ""
    toml_file.set_dotted(table, name, item)


def remove_value(document: tomlkit.TOMLDocument, key: str) -> None:
    """Removes a key, if it is there."""
    if value_of(document, key) is None:
        return
    table, name = _place(document, key)
    if name in table:
        del table[name]
    else:
        group, _, last = name.partition(".")
        del table[group][last]


def set_port(document: tomlkit.TOMLDocument, port: str, table: Table | None) -> None:
    """Replaces the section of a port; None removes it."""
    ports = document.setdefault("ports", tomlkit.table(is_super_table=True))
    if port in ports:
        del ports[port]
    if table is not None:
        ports[port] = table


def comment_of(document: tomlkit.TOMLDocument, key: str) -> str:
    """The comment of a key that a guess left: what to fill in or to check; else empty."""
    item = _item(document, key)
    comment = "" if item is None else item.trivia.comment.removeprefix("#").strip()
    return comment if comment.startswith((FILL_IN, "CHECK")) else ""


def to_fill_in(document: tomlkit.TOMLDocument) -> list[str]:
    """Keys that need a value of somebody who knows the joint."""
    found = [
        key
        for key, value in _values(document)
        if (key.endswith(_NOT_ZERO) and value == 0)
        or (key.endswith(".column") and value == FILL_IN)
    ]
    # 0 stands for the gear ratio of theta, if that is one.
    if value_of(document, GAMMA) == 0 and value_of(document, "ports.theta.gear_ratio") in (None, 1):
        found.append(GAMMA)
    return found


def _values(document: tomlkit.TOMLDocument) -> Iterator[tuple[str, Any]]:
    for key, value in toml_file.dotted(document.unwrap()):
        yield key.removeprefix("parameters."), value


def _place(document: tomlkit.TOMLDocument, key: str) -> tuple[MutableMapping[str, Any], str]:
    """The table of a key, which is made if it is missing, and its name there."""
    *path, name = key.split(".")
    if not path or path[0] not in SECTIONS:
        return document.setdefault("parameters", tomlkit.table()), key
    table: Any = document
    for part in path:
        table = table.setdefault(part, tomlkit.table())
    return table, name


def _item(document: tomlkit.TOMLDocument, key: str) -> Any:
    """The item of a key with its comment; None if it is not there."""
    if value_of(document, key) is None:
        return None
    table, name = _place(document, key)
    if name not in table:
        group, _, last = name.partition(".")
        table, name = table[group], last
    item = table[name]
    return item if hasattr(item, "trivia") else None
