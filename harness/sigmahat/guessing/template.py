"""The configuration that `sigmahat init` writes: the guess, and comments on what to check."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import accumulate

import tomlkit
from tomlkit.items import Item, Table

from sigmahat.fmi.instance import installed
from sigmahat.guessing.columns import TURN, Column, Columns, likely_unit
from sigmahat.guessing.guess import JointGuess
from sigmahat.guessing.ports import PortGuess
from sigmahat.logs.configuration import (
    ANOTHER_ROBOT,
    ANY_COULOMB,
    FILL_IN,
    NOT_YOURS,
    PORTS,
    WIDE_PRIOR,
)
from sigmahat.logs.joints import together
from sigmahat.logs.log import Log
from sigmahat.logs.units import seconds

_MEANING = {
    "theta": "principal motor, after its gear",
    "q": "link",
    "theta_c": "motor that sets the stiffness",
    "tau": "torque of the principal motor, on its axis before the gear",
    "tau_e_sensor": "measured flexibility torque, for modality Sensor",
}
_MOTOR_UNITS = {"motor.B": "kg.m2", "motor.D_theta": "N.m.s/rad"}
_TORQUES = {"N.m": 1.0, "mN.m": 1e-3, "kN.m": 1e3, "N.cm": 1e-2}
_RANGE = (1.0, 100.0)  # of the set-point
_GAIN = 0.02  # relative, the start value of the FMU
_ALIKE = 1.2
"""Largest ratio of similar gear ratios as seen in a log: a soft joint may exceed its motor."""
_MOST_LISTED, _LONGEST_LIST = 200, 40_000  # columns, and bytes of their lines together
_HEAD = """\
Configuration for {log}{joint}, guessed from names and values of its columns.
Lines with FILL IN need a value of your data sheet; lines with CHECK are less sure than others.
Then: sigmahat identify (B, D_theta, friction, ranges), sigmahat estimate (stiffness).

Columns of the log:
{columns}

A port is sign (x - zero) / gear_ratio, in its unit. Keys of a port, all but column
optional: unit (rad, deg, turn, counts; N.m, mN.m, A; mm for theta_c), sign, zero,
gear_ratio (encoder or torque on the other side of the gear), counts_per_turn,
torque_constant [N.m/A], mm_per_turn (of the motor, for theta_c in mm), scale (instead
of a unit), wrap (period of a counter that starts again), time (a column of its own)."""
_OF_SEVERAL = """

Common keys of all joints are written once, below. Each joint has sections [joints.NAME...],
whose keys replace common keys: move a key there if a joint differs."""


def write(log: Log, columns: Columns, joints: Mapping[str, JointGuess]) -> str:
    """The text of a configuration of these joints; values that all joints have are written once,
    and where no column looks like a port, it asks for a column."""
    lines = "\n".join(_listed(log, columns, joints))
    name = "" if len(joints) > 1 else next(iter(joints.values())).name
    head = _HEAD.format(log=log.path.name, joint=name and f", joint {name}", columns=lines)
    if len(joints) > 1:
        head += _OF_SEVERAL
    guesses = _with_one_gear(joints).items()
    documents = {name: _document(guess, head) for name, guess in guesses}
    (one, *others) = documents.values()
    return tomlkit.dumps(together(documents) if others else one)


def _listed(log: Log, columns: Columns, joints: Mapping[str, JointGuess]) -> Iterator[str]:
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
    shown = min(_MOST_LISTED, sum(end < _LONGEST_LIST for end in ends))
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


def _with_one_gear(joints: Mapping[str, JointGuess]) -> Mapping[str, JointGuess]:
    """The joints with one comment for all gear ratios, if all are unknown and look alike."""
    motors = {name: each.ports["theta"] for name, each in joints.items() if "theta" in each.ports}
    moves = [each.moves or 0.0 for each in motors.values() if each.gear_ratio is None]
    if len(moves) < len(joints) or min(moves) <= 0 or max(moves) > _ALIKE * min(moves):
        return joints
    note = next(iter(motors.values())).notes["gear_ratio"]
    noted = {name: motor.noted("gear_ratio", note) for name, motor in motors.items()}
    return {n: replace(j, ports={**j.ports, "theta": noted[n]}) for n, j in joints.items()}


def _document(guess: JointGuess, head: str) -> tomlkit.TOMLDocument:
    document = tomlkit.document()
    for line in head.splitlines():
        document.add(tomlkit.comment(line))
    document.add(tomlkit.nl())
    document.add("time", _time(guess))
    ports = tomlkit.table(is_super_table=True)
    needed = ("q", "tau_e_sensor") if _is_sensor(guess) else ("theta", "q", "tau")
    missing = []
    for name in PORTS:
        if name in guess.ports:
            ports.add(name, port_table(name, guess.ports[name]))
        elif name in needed:
            ports.add(name, _empty_port(name))
        else:
            missing.append(name)
    last = list(ports)[-1]
    for name in missing:
        text = f"[ports.{name}]   # {_MEANING[name]}, {PORTS[name]}; no column looks like it"
        ports[last].add(tomlkit.comment(text))
        ports[last].add(tomlkit.nl())
    document.add("ports", ports)
    document.add("parameters", _parameters(guess))
    return document


def _is_sensor(guess: JointGuess) -> bool:
    return "tau" not in guess.ports and "tau_e_sensor" in guess.ports


def _time(guess: JointGuess) -> Table:
    table = tomlkit.table()
    if guess.time is None:
        _hint(table, "no column looks like a time: rows are taken as samplePeriod apart")
    else:
        table.add("column", guess.time)
        table.add("unit", guess.clock.unit)
    shorter = "[s] interpolate over shorter gaps; else ticks are skipped"
    if guess.clock.longest_gap is None:
        _hint(table, f"longest_gap = 0.01   # {shorter}")
    else:
        note = f"{shorter}. Rows are lost in this log"
        _add(table, "longest_gap", guess.clock.longest_gap, note)
    table.add(tomlkit.nl())
    return table


def port_table(name: str, port: PortGuess) -> Table:
    """The section of a port that has a column; comments say what to check and to fill in."""
    table = tomlkit.table()
    _comment(table, f"{_MEANING[name]}, {PORTS[name]}")
    span = "no number" if math.isnan(port.low) else f"{port.low:.6g} to {port.high:.6g}"
    _add(table, "column", port.column, f"{span}; {port.why}")
    if port.unit is None:
        _add(table, "scale", 0, f"FILL IN: {PORTS[name]} per unit of the column")
    else:
        _add(table, "unit", port.unit, port.notes.get("unit", ""))
    if port.time is not None:
        _add(table, "time", port.time)
    if port.unit == "counts":
        fill_in = "FILL IN: of the encoder, after its four-fold evaluation"
        note = port.notes.get("counts_per_turn", fill_in)
        _add(table, "counts_per_turn", port.counts_per_turn or 0, note)
    if name == "theta":
        check = "CHECK: ratio of the gear if the encoder is on the motor's shaft"
        _add(table, "gear_ratio", port.gear_ratio or 0, port.notes.get("gear_ratio", check))
    if name == "tau":
        _hint(table, f"gear_ratio = 1   # {port.notes['gear_ratio']}")
    if port.unit in ("A", "mA"):
        _add(table, "torque_constant", 0, "FILL IN: N.m/A, from the data sheet of the motor")
    if port.unit == "mm":
        _hint(table, "mm_per_turn = 2.5   # not given: the set-point is the number of mm")
    if port.wrap is not None:
        _add(table, "wrap", port.wrap, port.notes.get("wrap", ""))
    _add(table, "sign", port.sign, port.notes.get("sign", ""))
    _add(table, "zero", port.zero, port.notes.get("zero", "value of the column at the zero"))
    table.add(tomlkit.nl())
    return table


def _empty_port(name: str) -> Table:
    table = tomlkit.table()
    _comment(table, f"{_MEANING[name]}, {PORTS[name]}")
    _add(table, "column", FILL_IN, "no column looks like this port: choose from the list above")
    _add(table, "unit", PORTS[name])
    if name == "q":
        _hint(table, "value = 0   # in place of the column, if the link is locked on purpose")
    table.add(tomlkit.nl())
    return table


def period_of(guess: JointGuess) -> str:
    """The unit of the sample period, and whether it is plausible."""
    unit, T = guess.clock.unit, guess.clock.interval
    likely = likely_unit(unit, T)
    if likely is None:
        return "[s]"
    other = T / seconds(unit) * seconds(likely)
    return (
        f"[s] CHECK: {T:g} s between rows is implausible. If {guess.time} is in {likely}, "
        f'set time.unit = "{likely}" and samplePeriod = {other:g}'
    )


def _parameters(guess: JointGuess) -> Table:
    table, ports = tomlkit.table(), guess.ports
    _comment(table, "parameters of StiffnessEstimator.fmu; all others keep their start values")
    if guess.time is None:
        _add(table, "samplePeriod", 0, "[s] FILL IN: time between two rows; the log has no times")
    else:
        _add(table, "samplePeriod", guess.clock.interval, period_of(guess))
    _add(table, "method", "FilteredRegression", "or Paper2011, which needs exact motor data")
    sensor = _is_sensor(guess)
    _add(table, "modality", "Sensor" if sensor else "Residual", "Residual, Sensor or Model")
    if sensor:
        _add_ranges(table, guess)
    else:
        _add_motor(table, ports.get("theta"))
    for name in ("theta", "q"):
        if name in ports and ports[name].unit != "counts":
            _add(table, f"encoder.{name}", *_encoder(ports[name]))
    for name, value, comment in _set_point(ports.get("theta_c")):
        _add(table, name, value, comment)
    return table


def _add_motor(table: Table, theta: PortGuess | None) -> None:
    """The gear ratio unless theta gives it, motor data that are not known yet, and priors."""
    if theta is None or theta.gear_ratio == 1:
        _add(table, "motor.gamma", 0, "FILL IN: gear ratio, between motor and flexibility")
    else:
        _add(table, "motor.gamma", 0, "0: the gear_ratio of theta, which must then not be 1")
    fmu = installed("StiffnessEstimator")
    for name, unit in _MOTOR_UNITS.items():
        _add(table, name, float(fmu.variable(name).start), f"[{unit}] {NOT_YOURS}")
        _add(table, name.replace("motor.", "prior."), ANOTHER_ROBOT, WIDE_PRIOR)
    _add(table, "prior.tau_coulomb", ANY_COULOMB, WIDE_PRIOR)
    gain = "CHECK: how well is the gain of tau known, to 0.02, 0.05 or 0.1? No log shows it"
    _add(table, "prior.torque_gain", _GAIN, gain)
    _hint(table, "torque.held = true   # if a drive holds each value of tau until the next one")


def _add_ranges(table: Table, guess: JointGuess) -> None:
    """Ranges for a joint with a sensor; with a motor, `identify` writes these ranges."""
    q, sensor = guess.ports.get("q"), guess.ports["tau_e_sensor"]
    if q is not None and q.unit in TURN and "theta" not in guess.ports:
        in_rad = 2 * math.pi / TURN[q.unit]
        _add(table, "range.phi", _largest(q) * in_rad, "[rad] largest deformation, with a margin")
    else:
        _hint(table, "range.phi = 0.3   # [rad] CHECK: the largest deformation")
    if sensor.unit in _TORQUES:
        largest = _largest(sensor) * _TORQUES[sensor.unit]
        _add(table, "prior.tau_e", largest, "[N.m] largest torque, with a margin")
    else:
        _hint(table, "prior.tau_e = 45   # [N.m] CHECK: the largest torque")
    _hint(
        table, "noise.tau_e = 0.032   # [N.m] CHECK: standard deviation of the noise of the torque"
    )


def _largest(port: PortGuess) -> float:
    """Largest magnitude of a port in the unit of its column, and a fifth more."""
    return float(f"{1.2 * max(abs(port.low - port.zero), abs(port.high - port.zero)):.3g}")


def _encoder(port: PortGuess) -> tuple[int, str]:
    if not port.steps:
        return 0, "counts per turn; not quantised"
    gear = port.gear_ratio or port.moves or 1.0
    where = "" if gear == 1 else f", times a gear of {gear:.4g}"
    return round(port.steps * gear), f"counts per turn; its step is 1/{port.steps} turn{where}"


def _set_point(port: PortGuess | None) -> Iterator[tuple[str, float, str]]:
    """Parameters of the set-point, whose values should be about 1 to 100."""
    if port is None:
        yield "rls.m", 1, "no set-point"
        yield "setPoint.offset", 0, "with a port theta_c: set-point = offset + scale theta_c"
        yield "setPoint.scale", 1, ""
        return
    in_port = 2 * math.pi / TURN[port.unit] if port.unit in TURN else 1.0
    largest = in_port * max(abs(port.low - port.zero), abs(port.high - port.zero))
    scale = 1.0
    if port.unit != "counts" and largest > 0 and math.isfinite(largest):
        least, most = _RANGE
        if not least <= largest <= most:
            scale = 10.0 ** (1 - math.floor(math.log10(largest)))
    yield "setPoint.offset", 0, "set-point = offset + scale theta_c, about 1 to 100"
    yield "setPoint.scale", scale, "" if port.unit == "mm" else "per rad"


def _add(table: Table, name: str, value: str | float, comment: str = "") -> None:
    """Adds a key, motor.B with its dot; a whole number is written as an integer."""
    whole = isinstance(value, float) and value.is_integer() and abs(value) < 2**53
    item = tomlkit.item(int(value) if whole else value)
    if comment:
        _comment(item, comment)
    table.append(tomlkit.key(name.split(".")), item)


def _hint(table: Table, text: str) -> None:
    table.add(tomlkit.comment(text))


def _comment(item: Item, text: str) -> None:
    item.comment(text)
    item.trivia.comment_ws = "   "
