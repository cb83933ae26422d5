"""Guesses units, signs, zeros and gear of the columns for the ports of one joint."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sigmahat.guess.columns import Column, Columns
from sigmahat.guess.relations import line, scale_of_derivative, share_of_motor
from sigmahat.guess.roles import Role, Roles
from sigmahat.motor.hypotheses.drive import drive
from sigmahat.motor.hypotheses.hypothesis import unit_of_same_turn
from sigmahat.motor.hypotheses.slope import Slope, gear_between, slope_of
from sigmahat.recording.column import counts_of_steps, is_decimal, unit_of_steps
from sigmahat.recording.configuration import AS, FILL_IN, QUESTIONS
from sigmahat.recording.log import Array
from sigmahat.recording.units import TURN

_ANGLES = ("theta", "q", "phi")
_AS_OTHER = "CHECK: as the other position, with the gear that the motor moves farther by"
_OF_ROS = "of a JointState of ROS (REP 103)"
_LOADED = 0.1  # ratio of the least torque to the range beyond which the column is nowhere near 0
_OFFSET = 1.0
"""The same ratio beyond which integers around a power of 2 are those of a converter, whose middle
is at no torque. The torque of a weight mostly varies by more."""
_NEAR_0 = 0.02  # ratio of the least to the largest torque of what may be a magnitude
_SAME_TURN = 0.02  # as _AS_FAR, where a gear may explain the ratio as well
_AS_FAR = 0.15  # largest relative difference between the motions of motor and link after the gear
_APART = 4.0  # largest mean of the deformation with equal zeros, in standard deviations
_RADIANS = 6.6  # largest magnitude of a joint position in rad; a larger position is in degrees
_MILLI = 100.0  # largest magnitude of a current in A; a larger current is in mA
_SINGLE_TURN = (2.0**10, 2.0**15)  # wraps of absolute encoders; 16 and 32 bits are counters
_SURE = 0.8  # least correlation with the deformation that determines the sign of a torque sensor


@dataclass
class PortGuess:
    """The column of a port, as the keys of a configuration describe it."""

    column: str
    why: str  # reason for the choice of the column
    low: float
    high: float  # range of its values
    unit: str | None
    """None if the user has to fill in `scale`, FILL_IN if the user has to fill in the unit, and
    "as theta" or "as q" if the user fills in the unit of that port."""
    wrap: float | None
    """Period of a counter that starts again, in the unit of the column; None without a period."""
    time: str | None  # the time column of the port, if it differs from the time column of the joint
    notes: dict[str, str]  # comments for the user by key of the configuration
    sign: int = 1  # 1 or -1
    zero: float = 0.0  # zero of the port, in the unit of the column
    gear_ratio: float | None = 1.0  # None if the user has to fill in the gear ratio
    moves: float | None = None
    """For theta: approximate ratio of its motion to the motion of the link; None if not known.

    For a motor in counts, the number of counts per turn of the link.
    """
    counts_per_turn: float | None = None
    """For the unit counts; None if the user has to fill in the number."""
    step: float | None = None
    """Step in which the values change, in the unit of the column, if this unit is not counts; None
    if the values have no steps."""

    @property
    def is_asked(self) -> bool:
        """Whether the user has to fill in the unit."""
        return self.unit == FILL_IN


def guess_ports(roles: Roles, columns: Columns, main: str | None) -> dict[str, PortGuess]:
    """Guesses every port that has a column; main is the time column of the joint."""
    ports = {port: _plain(port, role, main) for port, role in roles.ports.items()}
    angles = {port: roles.ports[port].column for port in _ANGLES if port in ports}
    for port, column in angles.items():
        _set_unit(ports[port], column, columns, port == "q")
    if {"theta", "q"} <= angles.keys():
        motor, link = angles["theta"], angles["q"]
        _set_together(ports["theta"], ports["q"], motor, link, columns.window_T)
    elif {"theta", "phi"} <= angles.keys():
        _set_by_motor(ports["theta"], ports["phi"], angles["theta"], angles["phi"])
    elif {"q", "phi"} <= angles.keys():
        _set_by_link(ports["q"], ports["phi"], roles)
    if "tau" in ports:
        _set_torque(ports, roles)
    if "tau_e_sensor" in ports:
        _set_sensor(ports, roles)
    return ports


def _plain(port: str, role: Role, main: str | None) -> PortGuess:
    """Creates a port with the unit from the name of the column."""
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
    """Guesses the unit of a position, and the reason; "" if the column name contains a unit."""
    if column.meaning.unit is not None:
        return column.meaning.unit, ""
    if column.meaning.message:
        return "rad", _OF_ROS
    if column.facts.integer:
        return "counts", "whole numbers"
    unit = unit_of_steps(column.facts.step)
    if unit:
        return unit, f"by its steps, 1/{counts_of_steps(column.facts.step, unit)} turn"
    unit = _unit_by_velocity(column, columns.signals, columns.window_T)
    if unit:
        return unit, "by its velocity"
    farthest = max(abs(column.facts.low), abs(column.facts.high))
    for unit, turn in TURN.items():
        if column.facts.wrap == turn:
            return unit, "by its wrap"
    if is_link and farthest > _RADIANS:
        return "deg", "CHECK: too far for rad"
    return FILL_IN, _asked("unit", "theta", "no unit in the name, and the log does not show it")


def _asked(key: str, port: str, why: str) -> str:
    """Formats the comment of a value that only the user knows."""
    return f"{FILL_IN}: {QUESTIONS[key, port]} ({why})"


def _unit_by_velocity(column: Column, signals: Sequence[Column], T: float) -> str | None:
    """Finds the unit of a position by a column with its velocity, whose name contains a unit."""
    for other in signals:
        speed = other.meaning.speed
        unit, _, minute = (speed or "").partition("/")
        if unit not in TURN or not len(other.window):
            continue
        scale = scale_of_derivative(column.window, other.window, T)
        if scale is None:
            continue
        turn = TURN[unit] * (60 if minute else 1) / abs(scale)  # one turn in the unit of the column
        best = min(TURN, key=lambda each: abs(math.log(turn / TURN[each])))
        if abs(math.log(turn / TURN[best])) < 0.05:
            return best
    return None


def _set_unit(port: PortGuess, column: Column, columns: Columns, is_link: bool) -> None:
    port.unit, how = _angle(column, columns, is_link)
    if math.isfinite(column.facts.step) and port.unit != "counts":
        counts = 0 if port.is_asked else counts_of_steps(column.facts.step, port.unit)
        if counts or port.is_asked:
            port.step = TURN[port.unit] / counts if counts else column.facts.step
            if is_decimal(column.facts.step):
                port.notes["step"] = "a decimal place of the text"
            elif counts:
                port.notes["step"] = f"1/{counts} turn"
    if how:
        port.notes["unit"] = how
    wrap, (least, most) = column.facts.wrap, _SINGLE_TURN
    if port.unit == "counts" and is_link and wrap is not None and least <= wrap <= most:
        port.counts_per_turn = wrap
        port.notes["counts_per_turn"] = "CHECK: the counter starts again after this number"


def _set_together(theta: PortGuess, q: PortGuess, motor: Column, link: Column, T: float) -> None:
    """Guesses gear, sign and zeros of both positions, from the common motion of motor and link."""
    slope = slope_of([np.column_stack([motor.window, link.window])], T)
    if slope is None:
        return
    _set_units(theta, q, slope)
    _set_gear(theta, q, slope)
    if _AS_OTHER in (theta.notes.get("unit"), q.notes.get("unit")):
        theta.gear_ratio = None  # known in this unit only
        theta.notes["gear_ratio"] = theta.notes["gear_ratio"].replace("CHECK", FILL_IN)
    ratio = _ratio(theta, q)
    if slope.value < 0:
        q.sign, q.notes["sign"] = -1, "it moves against the motor"
    of_motor = math.copysign(ratio or abs(slope.value), slope.value)
    deformation = link.window - of_motor * motor.window
    spread = max(slope.rest * float(np.std(link.window)), float(np.std(deformation)))
    if abs(float(np.mean(deformation))) > _APART * spread:
        for port, column in ((theta, motor), (q, link)):
            port.zero = _mean(column)
            port.notes["zero"] = "CHECK: mean of the column, as the zeros of both do not agree"


def _set_units(theta: PortGuess, other: PortGuess, slope: Slope) -> None:
    """Guesses a unit from that of the other position; one answer serves two unknown units."""
    if theta.is_asked and other.is_asked:
        _take_unit_of("theta", other)
    elif theta.is_asked:
        _set_unit_by_other(theta, other, 1 / abs(slope.value))
    elif other.is_asked:
        _set_unit_by_other(other, theta, abs(slope.value))


def _take_unit_of(name: str, port: PortGuess) -> None:
    """Gives a position the unit that the user fills in for another port."""
    port.unit = AS[name]
    port.notes["unit"] = "CHECK: both look alike; name its own unit if it differs"


def _set_unit_by_other(port: PortGuess, other: PortGuess, ratio: float) -> None:
    """Guesses the unit of a position from the other position; ratio: of both values.

    Values that are larger for the motor may be of a finer unit, or of a motor before its gear.
    """
    if other.unit not in TURN:
        return
    same = unit_of_same_turn(other.unit, ratio, _AS_FAR)
    if same is None:
        # The user fills in the gear, and `check` finds a unit that contradicts it.
        port.unit = other.unit
        port.notes["unit"] = _AS_OTHER
    elif same == other.unit or unit_of_same_turn(other.unit, ratio, _SAME_TURN):
        port.unit = same
        port.notes["unit"] = "CHECK: from the other position, which turns as far"
    else:
        gear = max(ratio, 1 / ratio)
        port.notes["unit"] = (
            f"{FILL_IN}: {same} if the motor is measured after its gear, {other.unit} if it is "
            f"measured before a gear of about {gear:.3g}"
        )


def _turns(theta: PortGuess, other: PortGuess) -> tuple[float, float] | None:
    """Returns one turn in the unit of each position; both are 1 if one answer of the user is the
    unit of both; None if they are not known."""
    if other.unit == AS["theta"]:
        return 1.0, 1.0
    if theta.unit not in TURN or other.unit not in TURN:
        return None
    return TURN[theta.unit], TURN[other.unit]


def _set_by_motor(theta: PortGuess, phi: PortGuess, motor: Column, spring: Column) -> None:
    """Guesses gear, units and sign of a deformation beside the position of the motor."""
    share = share_of_motor(motor.window, spring.window)
    if share is None:
        if theta.is_asked and phi.is_asked:
            _take_unit_of("theta", phi)
        phi.notes["sign"] = "CHECK: the log does not show it; 1 for q - theta, -1 for theta - q"
        theta.gear_ratio = None
        theta.notes["gear_ratio"] = _asked("gear_ratio", "theta", "the log does not show it")
        return
    # Where the link does not follow, the deformation is the motion of the motor.
    slope = Slope(-share, 1.0, is_slow=False, rest=1.0)
    _set_units(theta, phi, slope)
    _set_gear(theta, phi, slope)
    phi.sign = -1 if share > 0 else 1
    phi.notes["sign"] = f"it is {'theta - q' if share > 0 else 'q - theta'} in fast motion"


def _set_by_link(q: PortGuess, phi: PortGuess, roles: Roles) -> None:
    """Guesses units and sign of a deformation beside the position of the link."""
    if q.is_asked and phi.is_asked:
        _take_unit_of("q", phi)
    phi.notes["sign"] = "CHECK: 1 for q - theta, -1 for theta - q"
    if "tau" in roles.ports:
        link, spring, tau = (roles.ports[port].column.window for port in ("q", "phi", "tau"))
        with_sign = [drive(link - sign * spring, link, tau).explained for sign in (1, -1)]
        phi.sign = 1 if with_sign[0] >= with_sign[1] else -1


def _set_gear(theta: PortGuess, q: PortGuess, slope: Slope) -> None:
    """Sets the gear ratio if both units are known and the joint is stiff; else adds a note."""
    turns = _turns(theta, q)
    if turns is not None:
        gear = gear_between(slope, *turns)
        if gear.is_after:
            note = "it moves as far as the link, so it is measured after the gear"
        else:
            theta.gear_ratio, theta.moves = gear.whole, gear.ratio
            first = "FILL IN" if gear.whole is None else "CHECK"
            note = f"{first}: the motor moves {gear.ratio:.4g} times as far as the link"
    else:
        theta.gear_ratio = None
        note = "FILL IN: 1 if theta is measured after the gear"
        if q.unit in TURN:
            theta.moves = TURN[q.unit] / abs(slope.value)
        elif theta.unit == "counts" and q.unit == "counts" and q.counts_per_turn:
            theta.moves = q.counts_per_turn / abs(slope.value)
        if theta.moves is not None:
            note = f"FILL IN: gear_ratio times counts_per_turn is about {theta.moves:.4g}"
    theta.notes["gear_ratio"] = note


def _ratio(theta: PortGuess, q: PortGuess) -> float | None:
    """Returns the ratio of q to theta without deformation; None for an unknown ratio."""
    turns = _turns(theta, q)
    if turns is None or not theta.gear_ratio:
        return None
    return turns[1] / turns[0] / theta.gear_ratio


def _mean(column: Column) -> float:
    mean = float(np.mean(column.window))
    return float(round(mean)) if column.facts.integer else float(f"{mean:.6g}")


def _set_torque(ports: Mapping[str, PortGuess], roles: Roles) -> None:
    port, column = ports["tau"], roles.ports["tau"].column
    notes, meaning, facts = port.notes, column.meaning, column.facts
    port.wrap = None
    port.unit = port.unit if port.unit != "counts" else None
    farthest = max(abs(facts.low), abs(facts.high))
    if port.unit is None and meaning.quantity == "current":
        port.unit = "mA" if facts.integer or farthest > _MILLI else "A"
        notes["unit"] = (
            "CHECK: no unit in the name; for counts of the device, scale [N.m] in place of unit "
            "and torque_constant"
        )
    elif port.unit is None and not facts.integer:
        _set_unit_of_torque("tau", port, column)
    extent = facts.high - facts.low
    middle = 2.0 ** round(math.log2(max(facts.low + facts.high, 2.0) / 2))
    is_around = facts.integer and facts.low < middle < facts.high
    if is_around and facts.low > _OFFSET * extent:
        port.zero = _mean(column)
        notes["zero"] = "CHECK: mean of the column, which is nowhere near 0; its value at no torque"
    elif max(facts.low, -facts.high) > _LOADED * extent:
        notes["zero"] = (
            f"CHECK: value of the column at no torque; its mean, {_mean(column):g}, may be that of "
            "a weight"
        )
    if roles.drive.sign < 0:
        port.sign = -1
        notes["sign"] = "CHECK: else the motor would gain power from friction"
    elif roles.drive.sign == 0:
        notes["sign"] = (
            "CHECK: the log does not show it; 1 if a positive torque increases theta, else -1"
        )
    if 0 <= facts.low < _NEAR_0 * facts.high:
        notes["sign"] = (
            "CHECK: the column is never negative. If it is a magnitude, without the sign of the "
            "torque, no stiffness follows from it: choose or record a column with a sign"
        )
    _set_side(port, column, ports.get("theta"))


def _set_unit_of_torque(name: str, port: PortGuess, column: Column) -> None:
    if column.meaning.message:
        port.unit, port.notes["unit"] = "N.m", _OF_ROS
    else:
        port.unit, port.notes["unit"] = FILL_IN, _asked("unit", name, "no unit in the name")


def _set_side(port: PortGuess, column: Column, theta: PortGuess | None) -> None:
    """Guesses on which side of the gear a torque is, by its name or format; else asks."""
    meaning = column.meaning
    of_joint = meaning.suggested == "link" or meaning.side == "link"
    if meaning.quantity == "current" or port.unit in ("A", "mA"):
        port.notes["gear_ratio"] = "a current is of the motor, before the gear"
        if theta is not None and theta.gear_ratio in (None, 1.0) and meaning.unit is None:
            port.notes["gear_ratio"] = (
                "CHECK: the ratio of the gear if torque_constant is of a servo, after its gear"
            )
    elif meaning.side == "motor" and not meaning.effort:
        port.notes["gear_ratio"] = "by its name of the motor, before the gear"
    elif of_joint or (meaning.message and meaning.effort and meaning.side is None):
        why = "of the joint, after the gear" if of_joint else "of the joint, as effort of ROS"
        port.gear_ratio = None
        if theta is not None and theta.gear_ratio not in (None, 1):
            port.gear_ratio = theta.gear_ratio
            port.notes["gear_ratio"] = f"CHECK: by its name {why}"
        else:
            port.notes["gear_ratio"] = f"{FILL_IN}: ratio of the gear; by its name {why}"
    else:
        port.gear_ratio = None
        port.notes["gear_ratio"] = _asked("gear_ratio", "tau", "the log does not show it")


def _set_sensor(ports: Mapping[str, PortGuess], roles: Roles) -> None:
    port, column = ports["tau_e_sensor"], roles.ports["tau_e_sensor"].column
    port.wrap = None
    port.unit = port.unit if port.unit not in ("counts", "A", "mA") else None
    if port.unit is None and not column.facts.integer:
        _set_unit_of_torque("tau_e_sensor", port, column)
    deformation = _deformation(ports, roles)
    if deformation is not None and line(deformation, column.window).correlation <= -_SURE:
        port.sign, port.notes["sign"] = -1, "opposite to the deformation"


def _deformation(ports: Mapping[str, PortGuess], roles: Roles) -> Array | None:
    """Computes q - theta in the unit of q, or q without theta; None if the gear is unknown."""
    if "phi" in ports:
        phi: Array = ports["phi"].sign * roles.ports["phi"].column.window
        return phi
    if "q" not in ports:
        return None
    q: Array = ports["q"].sign * roles.ports["q"].column.window
    if "theta" not in ports:
        return q
    ratio = _ratio(ports["theta"], ports["q"])
    return None if ratio is None else q - ratio * roles.ports["theta"].column.window
