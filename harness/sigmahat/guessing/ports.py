"""Units, signs, zeros and gear of the columns that feed the ports of one joint."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sigmahat.guessing.columns import TURN, Column, Columns, counts_per_turn, unit_of_steps
from sigmahat.guessing.relations import line, scale_of_derivative
from sigmahat.guessing.roles import Role, Roles
from sigmahat.logs.log import Array

_AFTER_GEAR = 1.4  # ratio of motor to link: below, the motor is measured after its gear
_AS_FAR = 0.15  # largest relative difference between the motions of motor and link after the gear
_WHOLE = 0.002  # relative difference up to which a gear ratio is rounded to an integer
_STIFF = 0.005  # ratio of deformation to motion: above, the motion does not determine the gear
_APART = 4.0  # standard deviations of the deformation: if its mean is larger, the zeros differ
_RADIANS = 6.6  # a joint that turns by more is in degrees
_MILLI = 100.0  # amperes: a larger current is in mA
_SINGLE_TURN = (2.0**10, 2.0**15)  # wraps of absolute encoders; 16 and 32 bits are counters
_SURE = 0.8  # from this correlation with the deformation, the sign of a torque sensor is sure


@dataclass(frozen=True)
class PortGuess:
    """The column of a port, as the keys of a configuration describe it."""

    column: str
    why: str  # why this column
    low: float
    high: float  # range of its values
    unit: str | None  # None if the unit cannot be guessed: then the user has to fill in `scale`
    wrap: float | None
    """Period of a counter that starts again, in the unit of the column; None without a period."""
    time: str | None  # the time column of the port, if it differs from the time column of the joint
    notes: Mapping[str, str]  # what to know or to check, by key
    sign: int = 1  # 1 or -1
    zero: float = 0.0  # zero of the port, in the unit of the column
    gear_ratio: float | None = 1.0  # None if the user has to fill in the gear ratio
    moves: float | None = None
    """For theta: approximate ratio of its motion to the motion of the link; None if not known.

    For a motor in counts, the number of counts per turn of the link.
    """
    counts_per_turn: float | None = None
    """For the unit counts; None if the user has to fill in the number."""
    steps: int = 0
    """Steps of the values per turn, if the unit is not counts; 0 if the values have no steps."""

    def noted(self, key: str, note: str, **changes: Any) -> PortGuess:
        """The guess with a note to a key, and other changes."""
        return replace(self, notes={**self.notes, key: note}, **changes)


def guess_ports(roles: Roles, columns: Columns, main: str | None) -> dict[str, PortGuess]:
    """The guess for every port that has a column; main is the time column of the joint."""
    ports = {port: _plain(port, role, main) for port, role in roles.ports.items()}
    angles = {port: roles.ports[port].column for port in ("theta", "q") if port in ports}
    for port, column in angles.items():
        ports[port] = _with_unit(ports[port], column, _angle(column, columns, port == "q"), port)
    if len(angles) == 2:
        ports |= _together(ports, *angles.values())
    if "tau" in ports:
        ports["tau"] = _torque(ports["tau"], roles)
    if "tau_e_sensor" in ports:
        ports["tau_e_sensor"] = _sensor(ports, roles)
    return ports


def _plain(port: str, role: Role, main: str | None) -> PortGuess:
    """A port whose unit is known only from the name of its column."""
    column = role.column
    facts, unit = column.facts, column.meaning.unit
    notes: dict[str, str] = {}
    if port == "theta_c" and unit is None:
        unit = "counts" if facts.integer else "rad"
        notes["unit"] = "CHECK: no unit in the name"
    wrap = facts.wrap if unit not in ("A", "mA", "N.m", "mN.m") else None
    if wrap is not None:
        notes["wrap"] = "CHECK: the column jumps by this value"
    time = column.clock if column.clock != main else None
    return PortGuess(column.name, role.why, facts.low, facts.high, unit, wrap, time, notes)


def _angle(column: Column, columns: Columns, is_link: bool) -> tuple[str, str]:
    """Unit of a position, and how the unit was found; "" if the name of the column has a unit."""
    if column.meaning.unit is not None:
        return column.meaning.unit, ""
    if column.facts.integer:
        return "counts", "whole numbers"
    unit = unit_of_steps(column.facts)
    if unit:
        return unit, f"by its steps, 1/{counts_per_turn(column.facts, unit)} turn"
    unit = _unit_by_velocity(column, columns.signals, columns.window_T)
    if unit:
        return unit, "by its velocity"
    farthest = max(abs(column.facts.low), abs(column.facts.high))
    for unit, turn in TURN.items():
        if column.facts.wrap == turn:
            return unit, "by its wrap"
    if is_link and farthest > _RADIANS:
        return "deg", "CHECK: too far for rad"
    return "rad", "CHECK: no unit in the name"


def _unit_by_velocity(column: Column, signals: Sequence[Column], T: float) -> str | None:
    """Unit of a position, from a column with its derivative whose name has a unit."""
    for other in signals:
        speed = other.meaning.speed
        unit, _, minute = (speed or "").partition("/")
        if unit not in TURN or not len(other.window):
            continue
        scale = scale_of_derivative(column.window, other.window, T)
        if scale is None:
            continue
        turn = TURN[unit] * (60 if minute else 1) / abs(scale)  # of the position, in its unit
        best = min(TURN, key=lambda each: abs(math.log(turn / TURN[each])))
        if abs(math.log(turn / TURN[best])) < 0.05:
            return best
    return None


def _with_unit(port: PortGuess, column: Column, found: tuple[str, str], name: str) -> PortGuess:
    (unit, how), wrap = found, column.facts.wrap
    port = replace(port, unit=unit, steps=counts_per_turn(column.facts, unit))
    if how:
        port = port.noted("unit", how)
    least, most = _SINGLE_TURN
    if unit == "counts" and name == "q" and wrap is not None and least <= wrap <= most:
        note = "CHECK: the counter starts again after this number"
        port = port.noted("counts_per_turn", note, counts_per_turn=wrap)
    return port


def _together(ports: Mapping[str, PortGuess], motor: Column, link: Column) -> dict[str, PortGuess]:
    """Gear, sign and zeros of both positions, from the motion of the link with the motor."""
    theta, q = ports["theta"], ports["q"]
    fitted = line(motor.window, link.window)
    if fitted.slope == 0:
        return {}
    if _is_vague(theta):
        theta = _unit_by_other(theta, q, 1 / abs(fitted.slope))
    elif _is_vague(q):
        q = _unit_by_other(q, theta, abs(fitted.slope))
    theta = _gear(theta, q, 1 / abs(fitted.slope), fitted.rest)
    ratio = _ratio(theta, q)
    if fitted.slope < 0:
        q = q.noted("sign", "it moves against the motor", sign=-1)
    slope = math.copysign(ratio or abs(fitted.slope), fitted.slope)
    deformation = link.window - slope * motor.window
    spread = max(fitted.rest * float(np.std(link.window)), float(np.std(deformation)))
    if abs(float(np.mean(deformation))) > _APART * spread:
        note = "CHECK: mean of the column, as the zeros of both do not agree"
        theta = theta.noted("zero", note, zero=_mean(motor))
        q = q.noted("zero", note, zero=_mean(link))
    return {"theta": theta, "q": q}


def _is_vague(port: PortGuess) -> bool:
    return port.notes.get("unit", "").startswith("CHECK")


def _unit_by_other(port: PortGuess, other: PortGuess, slope: float) -> PortGuess:
    """The unit of a vague position, whose values are slope times those of the other position."""
    if other.unit not in TURN:
        return port
    same = [unit for unit in TURN if abs(slope * TURN[other.unit] / TURN[unit] - 1) < _AS_FAR]
    unit = same[0] if same else other.unit
    return port.noted("unit", "CHECK: from the other position, which turns as far", unit=unit)


def _gear(theta: PortGuess, q: PortGuess, slope: float, rest: float) -> PortGuess:
    """The gear ratio if both units are known and the joint is stiff; else a note with a hint.

    slope  ratio of the values of theta to the values of q
    rest   standard deviation of the residual of this slope, relative to q
    """
    if theta.unit in TURN and q.unit in TURN:
        gear = slope * TURN[q.unit] / TURN[theta.unit]
        if 1 / _AFTER_GEAR < gear < _AFTER_GEAR:
            note = "it moves as far as the link, so it is measured after the gear"
            return theta.noted("gear_ratio", note, gear_ratio=1.0)
        whole = max(round(gear), 1)
        sure = rest < _STIFF and abs(gear / whole - 1) < _WHOLE
        note = f"the motor moves {gear:.4g} times as far as the link"
        note = f"{'CHECK' if sure else 'FILL IN'}: {note}"
        ratio = float(whole) if sure else None
        return theta.noted("gear_ratio", note, gear_ratio=ratio, moves=gear)
    product = None
    note = "FILL IN: 1 if theta is measured after the gear"
    if q.unit in TURN:
        product = slope * TURN[q.unit]
    elif theta.unit == "counts" and q.unit == "counts" and q.counts_per_turn:
        product = slope * q.counts_per_turn
    if product is not None:
        note = f"FILL IN: gear_ratio times counts_per_turn is about {product:.4g}"
    return theta.noted("gear_ratio", note, gear_ratio=None, moves=product)


def _ratio(theta: PortGuess, q: PortGuess) -> float | None:
    """Ratio of the values of q to theta without deformation; None if not known."""
    if theta.unit not in TURN or q.unit not in TURN or not theta.gear_ratio:
        return None
    return TURN[q.unit] / TURN[theta.unit] / theta.gear_ratio


def _mean(column: Column) -> float:
    mean = float(np.mean(column.window))
    return float(round(mean)) if column.facts.integer else float(f"{mean:.6g}")


def _torque(port: PortGuess, roles: Roles) -> PortGuess:
    column = roles.ports["tau"].column
    meaning, facts, notes = column.meaning, column.facts, dict(port.notes)
    unit = port.unit if port.unit != "counts" else None
    farthest = max(abs(facts.low), abs(facts.high))
    if unit is None and meaning.quantity == "current":
        unit = "mA" if facts.integer or farthest > _MILLI else "A"
        notes["unit"] = "CHECK: no unit in the name"
    elif unit is None and not facts.integer:
        unit = "N.m"
        said = meaning.quantity == "torque"
        notes["unit"] = f"CHECK: no unit in the name{'' if said else '; or is it a current, in A?'}"
    if roles.drive.sign < 0:
        notes["sign"] = "CHECK: else the motor would gain power from friction"
    elif roles.drive.sign == 0:
        notes["sign"] = "CHECK: the log does not show it; 1 if a torque above 0 turns theta upwards"
    sign = -1 if roles.drive.sign < 0 else 1
    notes["gear_ratio"] = "CHECK: ratio of the gear if the torque is measured after the gear"
    return replace(port, unit=unit, sign=sign, wrap=None, notes=notes)


def _sensor(ports: Mapping[str, PortGuess], roles: Roles) -> PortGuess:
    port, column = ports["tau_e_sensor"], roles.ports["tau_e_sensor"].column
    notes = dict(port.notes)
    unit = port.unit if port.unit not in ("counts", "A", "mA") else None
    if unit is None and not column.facts.integer:
        unit, notes["unit"] = "N.m", "CHECK: no unit in the name"
    port = replace(port, unit=unit, wrap=None, notes=notes)
    deformation = _deformation(ports, roles)
    together = 0.0 if deformation is None else line(deformation, column.window).correlation
    if together > -_SURE:
        return port
    return port.noted("sign", "opposite to the deformation", sign=-1)


def _deformation(ports: Mapping[str, PortGuess], roles: Roles) -> Array | None:
    """q - theta in the unit of q, or q alone; None if the ratio of both is not known."""
    if "q" not in ports:
        return None
    q: Array = ports["q"].sign * roles.ports["q"].column.window
    if "theta" not in ports:
        return q
    ratio = _ratio(ports["theta"], ports["q"])
    return None if ratio is None else q - ratio * roles.ports["theta"].column.window
