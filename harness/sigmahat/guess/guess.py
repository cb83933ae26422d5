"""Guesses the joints of a log, and for each joint the column of every port.

    joints = guess(read_columns(open_log(path)))
    joints["knee"].ports["theta"].column

The module template.py writes a guess as a configuration.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sigmahat.fmi.unknown_name import unknown
from sigmahat.guess.columns import Column, Columns, TimeColumn, usual_times
from sigmahat.guess.ports import PortGuess, guess_ports
from sigmahat.guess.roles import Roles, assign, chosen_roles
from sigmahat.recording.log import Log, LogError

_TEMPERATURES = (-40.0, 200.0)  # [degC]: of a motor that runs
_OF_A_JOINT = ("position", "deformation", "torque", "current", None)


def joints_of_log(columns: Sequence[Column], T: float) -> dict[str, Roles]:
    """Finds the joints of a log by name, a single joint "" without names; T as for assign()."""
    placed = [each for each in columns if each.meaning.quantity in _OF_A_JOINT]
    of_joints = {each.name: each.meaning.joints for each in placed}
    for groups in (_groups(placed, _all_words(placed)), _groups(placed, of_joints)):
        found = {name: assign(group, T) for name, group in groups.items()}
        whole = {name: roles for name, roles in found.items() if name and roles.is_complete}
        if len(whole) > 1:
            return whole
        if len(whole) == 1:
            (name,) = whole
            # Columns without the name of a joint belong to the only joint.
            return {name: assign([*groups[name], *groups.get("", [])], T)}
    if len(groups.keys() - {""}) > 1:
        return {name: roles for name, roles in found.items() if name and roles.ports}
    return {"": assign(placed, T)}


def _groups(
    columns: Sequence[Column], words: Mapping[str, Sequence[str]]
) -> dict[str, list[Column]]:
    groups: dict[str, list[Column]] = {}
    for column in columns:
        groups.setdefault("_".join(words[column.name]), []).append(column)
    return groups


def _all_words(columns: Sequence[Column]) -> Mapping[str, Sequence[str]]:
    """Returns for each column the words that are not in every name, and names of joints."""
    common = set.intersection(*(set(each.meaning.rest) for each in columns)) if columns else set()
    return {
        each.name: [
            word for word in each.meaning.rest if word not in common or word in each.meaning.joints
        ]
        for each in columns
    }


@dataclass(frozen=True)
class JointGuess:
    name: str  # name of the joint in the columns; empty if no column names a joint
    time: str | None  # the time column of ports without their own; None: the log has no times
    clock: TimeColumn
    ports: Mapping[str, PortGuess]  # guesses of the ports that have a column, in the order of PORTS
    temperature: str | None  # column with the temperature of the motor [degC]; None without one


def guess(columns: Columns) -> dict[str, JointGuess]:
    """Guesses the joints of a log by name, in the order of the columns; at least one joint.

    A port is missing if the log has no column that fits the port.
    """
    found = {}
    for name, roles in joints_of_log(columns.signals, columns.window_T).items():
        clocks = [role.column.clock for role in roles.ports.values()]
        main = clocks[0] if clocks else next(iter(columns.clocks))
        ports = guess_ports(roles, columns, main)
        samples = [
            role.column.samples for role in roles.ports.values() if role.column.clock == main
        ]
        clock = usual_times(samples or [columns.clocks[main]])
        found[name] = JointGuess(name, main, clock, ports, _temperature(columns.signals, name))
    return found


def _temperature(columns: Sequence[Column], joint: str) -> str | None:
    """Returns the column with the temperature of the motor of a joint, if only one can be meant: by
    its name that of a motor, or of no other part."""
    found = [
        each
        for each in columns
        if each.meaning.quantity == "temperature"
        and each.meaning.side in (None, "motor")
        and joint in ("", "_".join(each.meaning.rest), "_".join(each.meaning.joints))
        and _TEMPERATURES[0] < each.facts.low <= each.facts.high < _TEMPERATURES[1]
    ]
    named = [each for each in found if each.meaning.side == "motor"] or found
    is_sure = len(named) == 1 and (
        named[0].meaning.side or not set(named[0].meaning.rest) - {joint}
    )
    return named[0].name if is_sure else None


def one_joint(log: Log, joints: Mapping[str, JointGuess], name: str) -> JointGuess:
    """Returns the joint of the given name. Raises LogError with all names for a wrong name."""
    short = re.sub(r"^(joint|axis|j)_?(?=\d)", "", name.lower())
    for each, joint in joints.items():
        if each.lower() in (name.lower(), short):
            return joint
    named = [each for each in joints if each]
    if not named:
        raise LogError(f"{log.path}: its column names contain no joint; omit --joint")
    raise LogError(f"{log.path}: {unknown('joint', name, named)}")


def guess_chosen(columns: Columns, names: Mapping[str, str | None]) -> dict[str, PortGuess]:
    """Guesses units, signs, zeros and gear of ports whose columns the user has chosen.

    names  names of columns by port; constant columns are left out
    """
    moving = {each.name: each for each in columns.signals if len(each.window)}
    chosen = {port: moving[name] for port, name in names.items() if name in moving}
    roles = chosen_roles(chosen)
    clocks = [column.clock for column in chosen.values()]
    return guess_ports(roles, columns, next(iter(clocks), None))
