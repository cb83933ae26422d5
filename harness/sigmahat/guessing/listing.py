"""The list of all columns of a log at the head of its configuration."""

import math
from collections.abc import Iterator, Mapping
from itertools import accumulate

from sigmahat.guessing.columns import Column, Columns
from sigmahat.guessing.guess import JointGuess
from sigmahat.logs.log import Log

_MOST, _LONGEST = 200, 40_000  # columns, and bytes of their lines together


def listed(log: Log, columns: Columns, joints: Mapping[str, JointGuess]) -> Iterator[str]:
    """A line for each column, but not more lines than fit a configuration."""
    what = dict.fromkeys(log.columns, "another time")
    what |= {column.name: _unused(column) for column in columns.signals}
    first = next(iter(joints.values()))
    times = (first.time, *(port.time for port in first.ports.values()))
    what |= dict.fromkeys((time for time in times if time), "time")
    for name, joint in reversed(list(joints.items())):
        ports = joint.ports.items()
        what |= {each.column: f"{name} ports.{port}".strip() for port, each in ports}
    lines = []
    for name, samples in log.columns.items():
        low, high = columns.facts[name].low, columns.facts[name].high
        span = "" if math.isnan(low) else f", {low:.6g} to {high:.6g}"
        lines.append(f"  {name}: {samples} samples{span}; {what[name]}")
    ends = accumulate(len(line.encode()) for line in lines)
    shown = min(_MOST, sum(end < _LONGEST for end in ends))
    yield from lines[:shown]
    if shown < len(lines):
        yield f"  and {len(lines) - shown} more, left out here"


def _unused(column: Column) -> str:
    """Why a column feeds no port."""
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
