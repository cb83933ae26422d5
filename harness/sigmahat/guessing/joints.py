"""Whose joint a column belongs to: columns of different joints never make one joint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sigmahat.guessing.columns import Column
from sigmahat.guessing.roles import Roles, assign

_OF_A_JOINT = ("position", "torque", "current", None)


def joints(columns: Sequence[Column], T: float) -> dict[str, Roles]:
    """The joints of a log by their names; one without a name if the log has only one.

    T  time between the samples of the windows of the columns [s]
    """
    placed = [each for each in columns if each.meaning.quantity in _OF_A_JOINT]
    for groups in (_groups(placed, _all_words(placed)), _groups(placed, _joint_words(placed))):
        found = {name: assign(group, T) for name, group in groups.items()}
        whole = {name: roles for name, roles in found.items() if name and roles.is_complete}
        if len(whole) > 1:
            return whole
        if len(whole) == 1:
            (name,) = whole
            # What bears no name of a joint is of the only one.
            return {name: assign([*groups[name], *groups.get("", [])], T)}
    if len(groups.keys() - {""}) > 1:
        return {name: roles for name, roles in found.items() if name and roles.ports}
    return {"": assign(placed, T)}


def _groups(
    columns: Sequence[Column], words: Mapping[str, Sequence[str]]
) -> dict[str, list[Column]]:
    """Columns by what is left of their names."""
    groups: dict[str, list[Column]] = {}
    for column in columns:
        groups.setdefault("_".join(words[column.name]), []).append(column)
    return groups


def _all_words(columns: Sequence[Column]) -> Mapping[str, Sequence[str]]:
    """Words and numbers that do not stand in every name, and names of joints."""
    common = set.intersection(*(set(each.meaning.rest) for each in columns)) if columns else set()
    return {
        each.name: [
            word for word in each.meaning.rest if word not in common or word in each.meaning.joints
        ]
        for each in columns
    }


def _joint_words(columns: Sequence[Column]) -> Mapping[str, Sequence[str]]:
    return {each.name: each.meaning.joints for each in columns}
