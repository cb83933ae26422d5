"""Fields to choose and to fill in; functions to read, set and remove keys of a configuration.

Comments of the user stay.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import tomlkit
from tomlkit.items import Table

from sigmahat.files import toml_file
from sigmahat.recording import several_joints
from sigmahat.recording.configuration import FILL_IN, NOT_YOURS, WIDE_PRIOR
from sigmahat.recording.units import TURN

_ANGLES, _TORQUES = (*TURN, "counts"), ("N.m", "mN.m", "kN.m")
UNITS: Mapping[str, Sequence[str]] = {
    "theta": _ANGLES,
    "q": _ANGLES,
    "tau": (*_TORQUES, "A", "mA"),
    "phi": _ANGLES,
    "theta_c": (*_ANGLES, "mm"),
    "tau_e_sensor": _TORQUES,
}
"""Units to choose from, by port; a file may name any other unit. Ports that most joints have are
first."""
BY_SCALE = "factor"  # choice in place of a unit: the port has a scale


@dataclass(frozen=True)
class Field:
    """An input of the page: a number, or a choice if there are items."""

    key: str
    title: str
    default: str = ""  # item, or text for the number, that holds without the key
    items: Sequence[tuple[str, str]] = ()  # values to choose from, and their texts
    kind: type[str] | type[float] = float  # of the value
    units: Sequence[str] = ()  # units of the column with which the field is shown; empty: all units
    ports: Sequence[str] = ()  # ports at which the field is shown; empty: all ports


def items(values: Iterable[str]) -> list[tuple[str, str]]:
    """Creates items of a choice whose labels are equal to the values."""
    return [(each, each) for each in values]


SIGN = Field("sign", "sign", "1", (("1", "+1"), ("-1", "-1: turned round")))
OF_PORT = (
    Field("counts_per_turn", "counts per turn", units=("counts",)),
    Field("gear_ratio", "gear ratio", "1", ports=("theta", "tau")),
    Field("torque_constant", "torque constant [N.m/A]", units=("A", "mA")),
    Field("scale", "port per unit of the column", units=(BY_SCALE,)),
    Field("mm_per_turn", "mm per turn of the motor", "number of mm", units=("mm",)),
    Field("zero", "zero, in its unit", "0"),
    Field("wrap", "starts again after", "never", ports=("theta", "q", "phi", "theta_c")),
    Field("delay", "recorded later by [s]", "0", ports=("tau",)),
)
PARAMETERS = (
    Field("time.unit", "unit of time", "s", items(("s", "ms", "us", "ns", "min")), str),
    # The defaults are the start values of the FMU.
    Field("modality", "modality", "Residual", items(("Residual", "Sensor", "Model")), str),
    Field("method", "method", "Paper2011", items(("Paper2011", "FilteredRegression")), str),
    Field("samplePeriod", "sample period [s]", "0.001"),
    Field("motor.gamma", "motor.gamma", "of theta"),
    Field("motor.B", "motor.B [kg.m²]"),
    Field("motor.D_theta", "motor.D_theta [N.m.s/rad]"),
)


Value = str | float | bool
GAMMA = "motor.gamma"
SECTIONS = ("ports", "time")  # first parts of keys; all other keys are in [parameters]
_NOT_ZERO = ("counts_per_turn", "gear_ratio", "torque_constant", "scale")
_OF_A_GUESS = (FILL_IN, "CHECK", NOT_YOURS, WIDE_PRIOR)
"""First words of comments that are no longer true after the user has set the value."""


def value_of(document: tomlkit.TOMLDocument, key: str) -> Any:
    """Returns the value of a key such as "ports.tau.sign" or "motor.B"; None if missing."""
    return next((value for name, value in _values(document) if name == key), None)


def set_value(document: tomlkit.TOMLDocument, key: str, value: Value) -> None:
    """Sets a key, and removes its comment if a guess wrote this comment."""
    place = _place(key)
    whole = isinstance(value, float) and value.is_integer() and abs(value) < 2**53
    item = tomlkit.item(int(value) if whole else value)
    old = several_joints.items(document).get(place)
    if old is not None:
        comment = old.trivia.comment.removeprefix("#").strip()
        if comment.startswith(_OF_A_GUESS) or comment.endswith((NOT_YOURS, WIDE_PRIOR)):
            old.trivia.comment = old.trivia.comment_ws = ""
    several_joints.set_item(document, place, item)


def remove_value(document: tomlkit.TOMLDocument, key: str) -> None:
    if value_of(document, key) is not None:
        several_joints.remove(document, _place(key))


def set_port(document: tomlkit.TOMLDocument, port: str, table: Table | None) -> None:
    """Replaces the section of a port; None removes it."""
    ports = document.setdefault("ports", tomlkit.table(is_super_table=True))
    if port in ports:
        del ports[port]
    if table is not None:
        ports[port] = table


def comment_of(document: tomlkit.TOMLDocument, key: str) -> str:
    """Returns the comment of a guess on a key to be filled in or checked; else ""."""
    item = several_joints.items(document).get(_place(key))
    comment = "" if item is None else item.trivia.comment.removeprefix("#").strip()
    return comment if comment.startswith((FILL_IN, "CHECK")) else ""


def to_fill_in(document: tomlkit.TOMLDocument) -> list[str]:
    """Returns the keys for which the user must give a value."""
    found = [
        key
        for key, value in _values(document)
        if (key.endswith(_NOT_ZERO) and value == 0)
        or (key.endswith((".column", ".unit")) and value == FILL_IN)
    ]
    # 0 stands for the gear ratio of theta, which must then not be 1.
    if value_of(document, GAMMA) == 0 and value_of(document, "ports.theta.gear_ratio") in (None, 1):
        found.append(GAMMA)
    return found


def _values(document: tomlkit.TOMLDocument) -> Iterator[tuple[str, Any]]:
    for key, value in toml_file.dotted(document.unwrap()):
        yield key.removeprefix("parameters."), value


def _place(key: str) -> several_joints.Place:
    place = tuple(key.split("."))
    return place if place[0] in SECTIONS else ("parameters", key)
