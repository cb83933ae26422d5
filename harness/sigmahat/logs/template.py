"""A configuration to start from, guessed from the names and values of a log's columns."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sigmahat.logs.configuration import PORTS
from sigmahat.logs.errors import LogError
from sigmahat.logs.log import Array, Log

_NAMES = {
    "theta_c": (r"theta_?c(?![a-z])", r"lever", r"set_?point", r"stiff\w*motor", r"(^|\W)r_mm"),
    "tau_e_sensor": (r"tau_e", r"sensor", r"load_?cell", r"(link|joint)_?(torque|tau)"),
    "theta": (r"^theta", r"\btheta", r"motor_?(pos|angle|enc|theta)", r"motor(?!.*(torque|cur))"),
    "q": (r"^q(?![a-z])", r"\bq(_|\b)", r"link", r"joint", r"output", r"angle"),
    "tau": (
        r"^tau",
        r"\btau",
        r"(motor|cmd)\w*(torque|current)",
        r"current",
        r"^i(_|\b)",
        r"torque",
    ),
}
"""Patterns of the names for each port, the surest first; ports in the order of their claims."""

_TIME = r"(^|[./])(t|time|stamp|timestamp|sec|seconds)(?![a-z])"
_DERIVED = r"dot|vel|speed|acc|true|temp"
_UNITS = {
    r"deg(rees?)?": "deg",
    r"m?rad": None,
    r"counts?|ticks?|enc|cnt": "counts",
    r"turns?|revs?": "turn",
    r"m?n\.?m": None,
    r"amps?|a|ampere": "A",
    r"ma": "mA",
    r"mm": "mm",
    r"ms|us|ns|s": None,
}
_ENCODED = ("theta", "q", "theta_c")
_DISTINCT = 20000  # values in which the step of an encoder is looked for


@dataclass(frozen=True)
class Guess:
    """What a column is taken for."""

    column: str
    unit: str
    time: str | None


def guess(log: Log) -> tuple[str | None, dict[str, Guess]]:
    """The time column, and a guess for each port that has one."""
    times = [name for name in log.columns if re.search(_TIME, name, re.IGNORECASE)]
    free = [n for n in log.columns if n not in times and not re.search(_DERIVED, n, re.IGNORECASE)]
    columns: dict[str, str] = {}
    for port, patterns in _NAMES.items():
        column = next(
            (n for p in patterns for n in free if re.search(p, n.split("/")[-1], re.IGNORECASE)),
            None,
        )
        if column is not None:
            free.remove(column)
            columns[port] = column
    clocks = {port: _clock(log, column, times) for port, column in columns.items()}
    main = next((clocks[port] for port in PORTS if port in clocks), None)
    return main, {
        port: Guess(
            columns[port],
            _unit(columns[port], PORTS[port]),
            clocks[port] if clocks[port] != main else None,
        )
        for port in PORTS
        if port in columns
    }


def _clock(log: Log, column: str, times: Sequence[str]) -> str | None:
    """The times of a column: those of its group or topic, else any of the same length."""
    same = [time for time in times if log.columns[time] == log.columns[column]]
    group = column.rpartition(".")[0]
    return next((time for time in same if time.rpartition(".")[0] == group), next(iter(same), None))


def _unit(column: str, target: str) -> str:
    """Unit at the end of a name, as in theta_deg, "q [deg]" or i(A)."""
    match = re.search(r"[\s_\[(.]+([a-zA-Z.]+?)[\])]?$", column)
    text = match.group(1) if match else ""
    for pattern, unit in _UNITS.items():
        if re.fullmatch(pattern, text, re.IGNORECASE):
            if unit is not None:
                return unit
            return {"nm": "N.m", "n.m": "N.m", "mnm": "mN.m", "mn.m": "mN.m"}.get(
                text.lower(), text.lower()
            )
    return target


def write(log: Log, fmu_defaults: Mapping[str, float]) -> str:
    """The text of a configuration with comments.

    fmu_defaults  start values of the estimator's motor parameters, by name

    Raises LogError if no column looks like a link or motor position.
    """
    time, found = guess(log)
    if not found:
        raise LogError(
            f"{log.path}: no column looks like a port (theta, q, theta_c, tau, tau_e_sensor) "
            f"by its name; there are: {', '.join(log.columns)}"
        )
    lines = list(_head(log))
    lines += ["", "[time]"]
    T = 1e-3
    if time is not None:
        unit = _unit(time, "s")
        T = _interval(log.read(time), unit)
        lines += [f"column = {_text(time)}", f"unit = {_text(unit)}"]
    else:
        lines += ["# no column looks like a time: rows are taken as samplePeriod apart"]
    lines += ["# longest_gap = 0.01   # [s] interpolate over shorter gaps; else ticks are skipped"]
    for name, each in found.items():
        lines += ["", *_port(log, name, each)]
    for name in PORTS:
        if name not in found:
            lines += ["", f"# [ports.{name}]   # {PORTS[name]}; no column looks like it"]
    lines += ["", *_parameters(log, found, T, fmu_defaults), ""]
    return "\n".join(lines)


def _head(log: Log) -> Iterator[str]:
    yield f"# Configuration for {log.path.name}, guessed from the names of its columns: check all."
    yield "# Then: sigmahat identify (B, D_theta, friction), sigmahat estimate (stiffness)."
    yield "#"
    yield "# Columns found:"
    for name, samples in log.columns.items():
        yield f"#   {name}: {samples} samples"
    yield "#"
    yield "# A port is sign (x - zero) in its unit, over gear_ratio. Keys of a port, all but column"
    yield "# optional: unit (rad, deg, turn, counts; N.m, mN.m, A; mm for theta_c), sign, zero,"
    yield "# gear_ratio (encoder or torque on the other side of the gear), counts_per_turn,"
    yield "# torque_constant [N.m/A], mm_per_turn (of the motor, for theta_c in mm), scale (instead"
    yield "# of a unit), wrap (period of a counter that starts again), time (a column of its own)."


_MEANING = {
    "theta": "principal motor, after its gear",
    "q": "link",
    "theta_c": "motor that sets the stiffness",
    "tau": "torque of the principal motor, on its axis before the gear",
    "tau_e_sensor": "measured flexibility torque, for modality Sensor",
}


def _port(log: Log, name: str, each: Guess) -> Iterator[str]:
    values = log.read(each.column)
    finite = values[np.isfinite(values)]
    yield f"[ports.{name}]   # {_MEANING[name]}, {PORTS[name]}"
    span = f"{finite.min():.6g} to {finite.max():.6g}" if len(finite) else "no number"
    yield f"column = {_text(each.column)}   # {span}"
    yield f"unit = {_text(each.unit)}"
    if each.time is not None:
        yield f"time = {_text(each.time)}"
    if each.unit == "counts":
        yield "counts_per_turn = 0   # FILL IN: of the encoder, after its four-fold evaluation"
    if name == "theta":
        yield "gear_ratio = 1   # CHECK: that of the gear if the encoder sits on the motor's shaft"
    if each.unit in ("A", "mA"):
        yield "torque_constant = 0   # FILL IN: N.m/A, from the data sheet of the motor"
    if each.unit == "mm":
        yield "# mm_per_turn = 2.5   # not given: the set-point is the number of mm"
    if each.unit not in ("A", "mA", "N.m", "mN.m"):
        wrap = _wrap(finite)
        if wrap is not None:
            yield f"wrap = {wrap:g}   # it jumps by this: check"
    yield "sign = 1"
    yield "zero = 0   # what the column shows at the zero of the port"


def _parameters(
    log: Log, found: Mapping[str, Guess], T: float, defaults: Mapping[str, float]
) -> Iterator[str]:
    yield "[parameters]   # of StiffnessEstimator.fmu, by their names; others keep their start"
    yield f"samplePeriod = {T:.12g}   # [s]"
    sensor = "tau" not in found and "tau_e_sensor" in found
    yield 'method = "MatchedFilter"   # or Paper2011, which needs exact motor data'
    yield f"modality = {_text('Sensor' if sensor else 'Residual')}   # Residual, Sensor or Model"
    units = {"motor.B": "kg.m2", "motor.D_theta": "N.m.s/rad", "motor.gamma": "gear ratio"}
    if not sensor:
        for name, value in defaults.items():
            yield f"{name} = {value:.12g}   # [{units[name]}] of the AwAS: put yours"
    for name in ("theta", "q"):
        if name in found and found[name].unit != "counts":
            turn = {"rad": 2 * np.pi, "deg": 360.0, "turn": 1.0}.get(found[name].unit, 0.0)
            counts = turn / _step(log.read(found[name].column))
            comment = f"its step is 1/{counts:.0f} turn" if counts else "not quantised"
            yield f"encoder.{name} = {counts:.0f}   # counts per turn; {comment}"
    if "theta_c" not in found:
        yield "rls.m = 1   # no set-point"
    elif found["theta_c"].unit == "mm":
        yield "setPoint.offset = 0   # set-point = offset + scale theta_c: here the mm"
        yield "setPoint.scale = 1"
    else:
        yield "# set-point = offset + scale theta_c, of order 1 to 100; for the AwAS the lever arm"
        yield "# in mm, which is what is taken if these lines stay comments:"
        yield "# setPoint.offset = 100"
        yield "# setPoint.scale = -0.39789   # per rad"


def _interval(times: Array, unit: str) -> float:
    """Usual time between rows [s], free of the rounding of the times."""
    from sigmahat.logs.units import seconds

    steps = np.diff(times[np.isfinite(times)]) * seconds(unit)
    if not len(steps):
        return 1e-3
    usual = float(np.median(steps))
    even = steps[np.abs(steps / usual - 1) < 0.01]
    return float(f"{even.mean() if len(even) > 0.9 * len(steps) else usual:.6g}")


def _step(values: Array) -> float:
    """Step of a quantised column; inf if it has none."""
    distinct = np.unique(values[np.isfinite(values)][:_DISTINCT])
    steps = np.diff(distinct)
    steps = steps[steps > 1e-9 * max(np.ptp(distinct), 1e-300)] if len(steps) else steps
    if len(steps) < 5:
        return np.inf
    step = float(np.median(steps[steps < 1.5 * steps.min()]))
    ratio = steps / step
    return step if np.mean(np.abs(ratio - np.round(ratio)) < 0.05) > 0.95 else np.inf


def _wrap(finite: Array) -> float | None:
    """Period of a counter that starts again: a power of two, or a full turn in degrees."""
    if len(finite) < 2:
        return None
    jump = float(np.abs(np.diff(finite)).max())
    span = float(np.ptp(finite))
    if span == 0 or jump < 0.9 * span:
        return None
    candidates = [360.0, 2 * np.pi, *(2.0**k for k in range(8, 33))]
    period = min(candidates, key=lambda each: abs(each - span))
    return period if abs(period / span - 1) < 0.02 else None


def _text(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
