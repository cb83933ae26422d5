"""Writes the configuration of `sigmahat init`: the guess, and comments on values to check."""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.items import Table

from sigmahat.files.escape import one_line
from sigmahat.files.templates import environment
from sigmahat.fmi.model import installed_model
from sigmahat.guess.columns import Column, Columns, likely_unit
from sigmahat.guess.guess import JointGuess
from sigmahat.guess.ports import PortGuess
from sigmahat.recording import configuration
from sigmahat.recording.deformation import missing_position
from sigmahat.recording.log import Log
from sigmahat.recording.several_joints import together
from sigmahat.recording.units import TURN, seconds

MEANINGS = {
    "theta": "principal motor, after its gear",
    "q": "link",
    "theta_c": "motor that sets the stiffness",
    "tau": "torque of the principal motor, on its axis before the gear",
    "tau_e_sensor": "measured flexibility torque, for modality Sensor",
    "phi": "deformation q - theta, in place of the position that is not measured",
}
"""Descriptions of the ports for the user."""
_IN_RAD = {unit: 2 * math.pi / turn for unit, turn in TURN.items()}
_IN_NM = {"N.m": 1.0, "mN.m": 1e-3, "kN.m": 1e3, "N.cm": 1e-2}
_RANGE = (1.0, 100.0)  # of the set-point
_MOST_LISTED = 200  # columns: with more lines, the file would be too long to be read again


def write(log: Log, columns: Columns, joints: Mapping[str, JointGuess]) -> str:
    """Formats a configuration of the given joints, with common values only once. If no column fits
    a port, the text asks the user for a column."""
    several = len(joints) > 1
    head = {
        "log": log.path.name,
        "listed": list(_listed(log, columns, joints)),
        "several": several,
    }
    texts = {
        name: _TEMPLATES.get_template("configuration.jinja").render(
            **head, guess=guess, constant=_constant(columns, guess)
        )
        for name, guess in joints.items()
    }
    if several:
        documents = {name: tomlkit.parse(text) for name, text in texts.items()}
        return tomlkit.dumps(together(documents, configuration.FILL_IN))
    return next(iter(texts.values()))


def _constant(columns: Columns, joint: JointGuess) -> dict[str, str]:
    """Describes the columns that have no signal although their name is of a missing port."""
    silent = silent_torque(columns, joint)
    if silent is None:
        return {}
    low = columns.facts[silent].low
    return {"tau": f"{silent} is {low:g} throughout, which is no torque: name another column"}


def silent_torque(columns: Columns, joint: JointGuess) -> str | None:
    """Returns the column of a torque or current of the joint that is constant; None without one, or
    if another column has the torque."""
    if {"tau", "tau_e_sensor"} & joint.ports.keys():
        return None
    for column in columns.signals:
        of_joint = not joint.name or "_".join(column.meaning.joints) in ("", joint.name)
        is_constant = column.facts.low == column.facts.high
        if column.meaning.quantity in ("torque", "current") and of_joint and is_constant:
            return column.name
    return None


def port_table(name: str, port: PortGuess) -> Table:
    """Creates the section of a port; comments list values to be checked or filled in."""
    text = _TEMPLATES.get_template("port.jinja").render(name=name, port=port) + "\n"
    found: Any = tomlkit.parse(text)["ports"]
    table: Table = found[name]
    return table


def _listed(log: Log, columns: Columns, joints: Mapping[str, JointGuess]) -> Iterator[str]:
    """Yields a line of text for each column, but at most 200 lines."""
    what = dict.fromkeys(log.columns, "another time")
    what |= {column.name: _unused(column) for column in columns.signals}
    first = next(iter(joints.values()))
    times = (first.time, *(port.time for port in first.ports.values()))
    what |= dict.fromkeys((time for time in times if time), "time")
    for name, joint in reversed(list(joints.items())):
        if joint.temperature is not None:
            what[joint.temperature] = f"{name} temperature".strip()
        ports = joint.ports.items()
        what |= {each.column: f"{name} ports.{port}".strip() for port, each in ports}
    lines = []
    for name, samples in log.columns.items():
        low, high = columns.facts[name].low, columns.facts[name].high
        span = "" if math.isnan(low) else f", {low:.6g} to {high:.6g}"
        lines.append(f"  {name}: {samples} samples{span}; {what[name]}")
    yield from lines[:_MOST_LISTED]
    if len(lines) > _MOST_LISTED:
        yield f"  and {len(lines) - _MOST_LISTED} more, left out here"


def _unused(column: Column) -> str:
    """Explains why a column is not used for any port."""
    meaning, facts = column.meaning, column.facts
    if facts.text:
        return "text"
    if math.isnan(facts.low):
        return "no number"
    if not facts.varies:
        return "constant" if facts.low == facts.high else "a few values only"
    words = [
        "reference" if meaning.reference else "",
        "computed" if meaning.computed else "",
        "" if meaning.quantity in (None, "other") else meaning.quantity,
        f"of {' '.join(meaning.joints)}" if meaning.joints and meaning.quantity else "",
    ]
    said = " ".join(word for word in words if word)
    return f"{said}, not used" if said else "not placed"


def _key(name: str, value: str | float, comment: str | None = None) -> str:
    """Formats a line of TOML; a whole number is written as an integer."""
    whole = isinstance(value, float) and value.is_integer() and abs(value) < 2**53
    text = tomlkit.item(int(value) if whole else value).as_string()
    return f"{name} = {text}   # {comment}" if comment else f"{name} = {text}"


def period_of(guess: JointGuess) -> str:
    """Describes the unit of the sample period, and whether the period is plausible."""
    if guess.time is None:
        return "[s] FILL IN: time between two rows; the log has no times"
    unit, T = guess.clock.unit, guess.clock.interval
    likely = likely_unit(unit, T)
    if likely is None:
        return "[s]"
    other = T / seconds(unit) * seconds(likely)
    return (
        f"[s] CHECK: {T:g} s between rows is implausible. If {guess.time} is in {likely}, "
        f'set time.unit = "{likely}" and samplePeriod = {other:g}'
    )


def _largest(port: PortGuess) -> float:
    """Returns 1.2 times the largest magnitude of a port, in the unit of the column."""
    return float(f"{1.2 * max(abs(port.low - port.zero), abs(port.high - port.zero)):.3g}")


def _scale_of(set_point: PortGuess) -> float:
    """Chooses a scale with which the largest set-point is between 1 and 100."""
    in_port = _IN_RAD.get(set_point.unit or "", 1.0)
    low, high = set_point.low - set_point.zero, set_point.high - set_point.zero
    largest = in_port * max(abs(low), abs(high))
    least, most = _RANGE
    if set_point.unit == "counts" or not 0 < largest < math.inf or least <= largest <= most:
        return 1.0
    return 10.0 ** (1 - math.floor(math.log10(largest)))


_TEMPLATES = environment(
    # Texts are comments, or strings of TOML that key() has made.
    Path(__file__).parent,
    autoescape=False,
    finalize=lambda value: one_line(str(value)),
).overlay(trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True)
_TEMPLATES.filters["short"] = lambda number: float(f"{number:.12g}")
_TEMPLATES.globals |= {
    "MEANINGS": MEANINGS,
    "UNITS": configuration.PORTS,
    "IN_RAD": _IN_RAD,
    "IN_NM": _IN_NM,
    "configuration": configuration,
    "key": _key,
    "start": lambda name: float(installed_model("StiffnessEstimator").variable(name).start),
    "period_of": period_of,
    "largest": _largest,
    "missing_position": missing_position,
    "scale_of": _scale_of,
}
