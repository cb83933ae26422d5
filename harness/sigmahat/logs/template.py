"""The configuration that `sigmahat init` writes: the guess, and comments on what to check."""

from __future__ import annotations

import math
from collections.abc import Mapping

import tomlkit
from tomlkit.items import Item, Table

from sigmahat.logs.configuration import PORTS
from sigmahat.logs.guess import Guess, PortGuess
from sigmahat.logs.log import Log

_MEANING = {
    "theta": "principal motor, after its gear",
    "q": "link",
    "theta_c": "motor that sets the stiffness",
    "tau": "torque of the principal motor, on its axis before the gear",
    "tau_e_sensor": "measured flexibility torque, for modality Sensor",
}
_MOTOR_UNITS = {"motor.B": "kg.m2", "motor.D_theta": "N.m.s/rad", "motor.gamma": "gear ratio"}
_HEAD = """\
Configuration for {log}, guessed from the names of its columns: check all.
Then: sigmahat identify (B, D_theta, friction), sigmahat estimate (stiffness).

Columns found:
{columns}

A port is sign (x - zero) in its unit, over gear_ratio. Keys of a port, all but column
optional: unit (rad, deg, turn, counts; N.m, mN.m, A; mm for theta_c), sign, zero,
gear_ratio (encoder or torque on the other side of the gear), counts_per_turn,
torque_constant [N.m/A], mm_per_turn (of the motor, for theta_c in mm), scale (instead
of a unit), wrap (period of a counter that starts again), time (a column of its own)."""


def write(log: Log, guess: Guess, fmu_defaults: Mapping[str, float]) -> str:
    """The text of a configuration.

    fmu_defaults  start values of the estimator's motor parameters, by name
    """
    columns = "\n".join(f"  {name}: {samples} samples" for name, samples in log.columns.items())
    document = tomlkit.document()
    for line in _HEAD.format(log=log.path.name, columns=columns).splitlines():
        document.add(tomlkit.comment(line))
    document.add(tomlkit.nl())
    document.add("time", _time(guess))
    ports = tomlkit.table(is_super_table=True)
    for name, port in guess.ports.items():
        ports.add(name, table := _port(name, port))
    for name, unit in PORTS.items():
        if name not in guess.ports:
            table.add(tomlkit.comment(f"[ports.{name}]   # {unit}; no column looks like it"))
            table.add(tomlkit.nl())
    document.add("ports", ports)
    document.add("parameters", _parameters(guess, fmu_defaults))
    return tomlkit.dumps(document)


def _time(guess: Guess) -> Table:
    table = tomlkit.table()
    if guess.time is None:
        table.add(
            tomlkit.comment("no column looks like a time: rows are taken as samplePeriod apart")
        )
    else:
        table.add("column", guess.time)
        table.add("unit", guess.time_unit)
    gap = "longest_gap = 0.01   # [s] interpolate over shorter gaps; else ticks are skipped"
    table.add(tomlkit.comment(gap))
    table.add(tomlkit.nl())
    return table


def _port(name: str, port: PortGuess) -> Table:
    table = tomlkit.table()
    _comment(table, f"{_MEANING[name]}, {PORTS[name]}")
    span = "no number" if math.isnan(port.low) else f"{port.low:.6g} to {port.high:.6g}"
    _add(table, "column", port.column, span)
    _add(table, "unit", port.unit)
    if port.time is not None:
        _add(table, "time", port.time)
    if port.unit == "counts":
        fill_in = "FILL IN: of the encoder, after its four-fold evaluation"
        _add(table, "counts_per_turn", 0, fill_in)
    if name == "theta":
        check = "CHECK: that of the gear if the encoder sits on the motor's shaft"
        _add(table, "gear_ratio", 1, check)
    if port.unit in ("A", "mA"):
        _add(table, "torque_constant", 0, "FILL IN: N.m/A, from the data sheet of the motor")
    if port.unit == "mm":
        without = "mm_per_turn = 2.5   # not given: the set-point is the number of mm"
        table.add(tomlkit.comment(without))
    if port.wrap is not None:
        _add(table, "wrap", port.wrap, "it jumps by this: check")
    _add(table, "sign", 1)
    _add(table, "zero", 0, "what the column shows at the zero of the port")
    table.add(tomlkit.nl())
    return table


def _parameters(guess: Guess, defaults: Mapping[str, float]) -> Table:
    table, ports = tomlkit.table(), guess.ports
    _comment(table, "of StiffnessEstimator.fmu, by their names; others keep their start values")
    _add(table, "samplePeriod", guess.T, "[s]")
    _add(table, "method", "MatchedFilter", "or Paper2011, which needs exact motor data")
    sensor = "tau" not in ports and "tau_e_sensor" in ports
    _add(table, "modality", "Sensor" if sensor else "Residual", "Residual, Sensor or Model")
    if not sensor:
        for name, value in defaults.items():
            _add(table, name, value, f"[{_MOTOR_UNITS[name]}] of the AwAS: replace it with yours")
        for line in (
            "torque.held = true   # if a drive holds each value of tau until the next one",
            "prior.torque_gain = 0.02   # how wrong the gain of tau may be: no data show it",
        ):
            table.add(tomlkit.comment(line))
    for name in ("theta", "q"):
        if name in ports and ports[name].unit != "counts":
            counts = ports[name].counts_per_turn
            comment = f"its step is 1/{counts} turn" if counts else "not quantised"
            _add(table, f"encoder.{name}", counts, f"counts per turn; {comment}")
    if "theta_c" not in ports:
        _add(table, "rls.m", 1, "no set-point")
    elif ports["theta_c"].unit == "mm":
        offset = "set-point = offset + scale theta_c: here the number of mm"
        _add(table, "setPoint.offset", 0, offset)
        _add(table, "setPoint.scale", 1)
    else:
        for line in (
            "set-point = offset + scale theta_c, of order 1 to 100; for the AwAS the lever arm",
            "in mm. These are the start values, which hold while the lines are comments:",
            "setPoint.offset = 100",
            "setPoint.scale = -0.39789   # per rad",
        ):
            table.add(tomlkit.comment(line))
    return table


def _add(table: Table, name: str, value: str | float, comment: str = "") -> None:
    """Adds a key, motor.B with its dot; a whole number is written as one."""
    whole = isinstance(value, float) and value.is_integer()
    item = tomlkit.item(int(value) if whole else value)
    if comment:
        _comment(item, comment)
    table.append(tomlkit.key(name.split(".")), item)


def _comment(item: Item, text: str) -> None:
    """Adds a comment to the line of an item, at some distance."""
    item.comment(text)
    item.trivia.comment_ws = "   "
