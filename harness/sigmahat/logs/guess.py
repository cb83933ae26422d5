"""What the columns of a log may be, guessed from their names and values."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sigmahat.logs.configuration import PORTS
from sigmahat.logs.errors import LogError
from sigmahat.logs.log import Array, Log
from sigmahat.logs.units import seconds

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
"""Patterns of column names for each port, the most specific first. The ports choose in this order:
a column that an earlier one has is not there for a later one."""

_TIME = r"(^|[./])(t|time|stamp|timestamp|sec|seconds)(?![a-z])"
_DERIVED = r"dot|vel|speed|acc|true|temp"
_UNITS = {
    r"deg(rees?)?": "deg",
    r"counts?|ticks?|enc|cnt": "counts",
    r"turns?|revs?": "turn",
    r"amps?|a|ampere": "A",
    r"ma": "mA",
    r"n\.?m": "N.m",
    r"mn\.?m": "mN.m",
    **{unit: unit for unit in ("rad", "mrad", "mm", "s", "ms", "us", "ns")},
}
"""Patterns of units at the end of a column name."""
_TURN = {"rad": 2 * np.pi, "deg": 360.0, "turn": 1.0}
_DISTINCT = 20000  # values among which the step of an encoder is looked for


@dataclass(frozen=True)
class PortGuess:
    """The column of a port."""

    column: str
    unit: str
    time: str | None
    """The column of its times, if that is not the time column of the log."""
    low: float
    high: float
    """Range of its values in its unit; nan if it holds no number."""
    wrap: float | None
    """Period after which it starts again, in its unit; None if it does not."""
    counts_per_turn: int
    """Of its encoder by the steps of its values; 0 if they have none, or the unit is counts."""


@dataclass(frozen=True)
class Guess:
    """All that was guessed of a log."""

    time: str | None
    """The time column; None if rows are T apart."""
    time_unit: str
    T: float
    """Time between rows [s]."""
    ports: dict[str, PortGuess]
    """By port, in the order of PORTS."""


def guess(log: Log) -> Guess:
    """Guesses the time column, and the column of each port that has one.

    Raises LogError if no column looks like a port.
    """
    times = [name for name in log.columns if re.search(_TIME, name, re.IGNORECASE)]
    columns = _columns([name for name in log.columns if name not in times])
    if not columns:
        raise LogError(
            f"{log.path}: no column looks like a port ({', '.join(PORTS)}) by its name; "
            f"there are: {', '.join(log.columns)}"
        )
    clocks = {port: _clock(log, column, times) for port, column in columns.items()}
    main = next(clocks[port] for port in PORTS if port in clocks)
    ports = {
        port: _port(log, port, columns[port], clocks[port] if clocks[port] != main else None)
        for port in PORTS
        if port in columns
    }
    time_unit = "s" if main is None else _unit(main, "s")
    return Guess(main, time_unit, 1e-3 if main is None else _interval(log, main, time_unit), ports)


def _columns(names: Sequence[str]) -> dict[str, str]:
    """The column of each port that has one."""
    free = [name for name in names if not re.search(_DERIVED, name, re.IGNORECASE)]
    columns = {}
    for port, patterns in _NAMES.items():
        column = next(
            (n for p in patterns for n in free if re.search(p, n.split("/")[-1], re.IGNORECASE)),
            None,
        )
        if column is not None:
            free.remove(column)
            columns[port] = column
    return columns


def _clock(log: Log, column: str, times: Sequence[str]) -> str | None:
    """The times of a column: those of its group or topic, else any of the same length."""
    same = [time for time in times if log.columns[time] == log.columns[column]]
    group = column.rpartition(".")[0]
    return next((time for time in same if time.rpartition(".")[0] == group), next(iter(same), None))


def _port(log: Log, port: str, column: str, time: str | None) -> PortGuess:
    values = log.read(column)
    finite = values[np.isfinite(values)]
    unit = _unit(column, PORTS[port])
    angle = PORTS[port] == "rad"
    return PortGuess(
        column,
        unit,
        time,
        low=float(finite.min()) if len(finite) else np.nan,
        high=float(finite.max()) if len(finite) else np.nan,
        wrap=_wrap(finite) if unit not in ("A", "mA", "N.m", "mN.m") else None,
        counts_per_turn=round(_TURN[unit] / _step(finite)) if angle and unit in _TURN else 0,
    )


def _unit(column: str, target: str) -> str:
    """Unit at the end of a name, as in theta_deg, "q [deg]" or i(A); target if there is none."""
    match = re.search(r"[\s_\[(.]+([a-zA-Z.]+?)[\])]?$", column)
    text = match.group(1) if match else ""
    found = (u for pattern, u in _UNITS.items() if re.fullmatch(pattern, text, re.IGNORECASE))
    return next(found, target)


def _interval(log: Log, time: str, unit: str) -> float:
    """Usual time between rows [s], without the rounding of the times."""
    times = log.read(time)
    steps = np.diff(times[np.isfinite(times)]) * seconds(unit)
    if not len(steps):
        return 1e-3
    usual = float(np.median(steps))
    even = steps[np.abs(steps / usual - 1) < 0.01]
    return float(f"{even.mean() if len(even) > 0.9 * len(steps) else usual:.6g}")


def _step(finite: Array) -> float:
    """Step of a quantised column; inf if it has none."""
    distinct = np.unique(finite[:_DISTINCT])
    steps = np.diff(distinct)
    steps = steps[steps > 1e-9 * max(np.ptp(distinct), 1e-300)] if len(steps) else steps
    if len(steps) < 5:
        return np.inf
    step = float(np.median(steps[steps < 1.5 * steps.min()]))
    ratio = steps / step
    return step if np.mean(np.abs(ratio - np.round(ratio)) < 0.05) > 0.95 else np.inf


def _wrap(finite: Array) -> float | None:
    """Period of a counter that starts again: a power of two, or a full turn."""
    if len(finite) < 2:
        return None
    jump = float(np.abs(np.diff(finite)).max())
    span = float(np.ptp(finite))
    if span == 0 or jump < 0.9 * span:
        return None
    candidates = [360.0, 2 * np.pi, *(2.0**k for k in range(8, 33))]
    period = min(candidates, key=lambda each: abs(each - span))
    return period if abs(period / span - 1) < 0.02 else None
