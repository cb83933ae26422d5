"""Chooses the column of each port of one joint, by the names and the motions of the columns."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from sigmahat.guess.columns import Column
from sigmahat.guess.relations import derivatives, is_copy, line
from sigmahat.guess.relations import scale_of_derivative as scale_of
from sigmahat.guess.words import Meaning
from sigmahat.motor.hypotheses.drive import Drive, drive

# Points of a column as a candidate for a port.
_SAID, _SUGGESTED, _QUANTITY = 4.0, 2.0, 1.0
_REFERENCE, _COMPUTED, _COPY, _APART = -6.0, -3.0, -5.0, -2.0
_MAGNITUDE = -5.0
_OF_PORTS, _NO_PORT = ("position", "deformation", "torque", "current"), -8.0
_CLOSE, _ALIKE, _UNLIKE = 0.98, 0.9, 0.7
"""Correlations of two columns that are sure, likely, and unlikely positions of one joint."""
_SAME = 0.995  # largest correlation of a torque with a position
_BETTER = 0.7  # largest ratio of the unexplained torque after a swap of motor and link
_MOST_COMPARED = 32  # columns of one joint; the time grows with the square of this number
_EXPLAINED = 0.5  # least fraction of an unnamed torque that the motion explains


@dataclass(frozen=True)
class Role:
    column: Column
    why: str


@dataclass(frozen=True)
class Roles:
    ports: Mapping[str, Role]
    drive: Drive  # relation between the torque and the motion

    @property
    def is_complete(self) -> bool:
        torque = "tau" in self.ports or "tau_e_sensor" in self.ports
        return torque and len({"theta", "q", "phi"} & self.ports.keys()) == 2


def assign(columns: Sequence[Column], T: float) -> Roles:
    """Assigns the columns of one joint to ports; samples in the column windows are T apart [s]."""
    moving = _few([each for each in columns if each.facts.varies and len(each.window)])
    positions = _positions(moving, T)
    ports: dict[str, Role] = dict(_pair(positions))
    ports |= _deformation(moving, ports)
    taken = {role.column.name for role in ports.values()}
    rest = [each for each in moving if each.name not in taken]
    rest = [each for each in rest if each.meaning.quantity != "deformation"]
    ports |= _setting(rest, ports)
    taken |= {role.column.name for role in ports.values()}
    ports |= _torques([each for each in rest if each.name not in taken], ports, T)
    found = _drive(ports)
    swapped = _swapped(ports)
    if swapped and 1 - _drive(swapped).explained < _BETTER * (1 - found.explained):
        ports = swapped
        found = _drive(ports)
    order = ("theta", "q", "phi", "theta_c", "tau", "tau_e_sensor")
    return Roles({port: ports[port] for port in order if port in ports}, found)


def _few(columns: list[Column]) -> list[Column]:
    """Limits the columns that are compared in pairs to the columns with the best names."""
    kept = sorted(columns, key=_said, reverse=True)[:_MOST_COMPARED]
    names = {each.name for each in kept}
    return [each for each in columns if each.name in names]


def _said(column: Column) -> float:
    """Scores the name of a column for any port; unknown names are between good and bad names."""
    quantity = column.meaning.quantity
    points = _named(column) + _QUANTITY * (quantity in _OF_PORTS)
    points += _NO_PORT * (quantity not in (*_OF_PORTS, None))
    return points + _REFERENCE * column.meaning.reference


def _named(column: Column) -> float:
    """Scores a name: positive with a side of the joint, negative for computed signals."""
    meaning = column.meaning
    points = _SAID * (meaning.side is not None) + _SUGGESTED * (meaning.suggested is not None)
    return points + _COMPUTED * meaning.computed


def chosen_roles(columns: Mapping[str, Column]) -> Roles:
    """Creates the roles of columns that the user has chosen, by port."""
    ports = {port: Role(column, "chosen") for port, column in columns.items()}
    return Roles(ports, _drive(ports))


def _swapped(ports: Mapping[str, Role]) -> dict[str, Role]:
    """Swaps motor and link; returns no ports if the names decide, or if a port is missing."""
    if not {"theta", "q", "tau"} <= ports.keys():
        return {}
    theta, q = ports["theta"].column, ports["q"].column
    said = _points(theta, "motor") + _points(q, "link")
    other = _points(q, "motor") + _points(theta, "link")
    if said > other and not _only_one_suggests(theta.meaning, q.meaning):
        return {}
    why = "explains the torque better as the"
    return {**ports, "theta": Role(q, f"{why} motor"), "q": Role(theta, f"{why} link")}


def _only_one_suggests(theta: Meaning, q: Meaning) -> bool:
    """Returns whether all that names say of the sides is that one of them suggests a side."""
    return not (theta.side or q.side) and not (theta.suggested and q.suggested)


def _drive(ports: Mapping[str, Role]) -> Drive:
    if "tau" not in ports or len(ports.keys() & {"theta", "q", "phi"}) < 2:
        return Drive(0.0, 0)
    window = {port: role.column.window for port, role in ports.items()}
    if "phi" not in ports:
        return drive(window["theta"], window["q"], window["tau"])
    if "theta" in ports:  # one sign of phi explains the torque as well as the other
        return drive(window["theta"], window["theta"] + window["phi"], window["tau"])
    q, phi = window["q"], window["phi"]
    return max((drive(q - x, q, window["tau"]) for x in (phi, -phi)), key=lambda d: d.explained)


def _positions(columns: Sequence[Column], T: float) -> list[Column]:
    named = [each for each in columns if each.meaning.quantity == "position"]
    derived = zip(columns, derivatives([each.window for each in columns], T), strict=True)
    silent = [each for each, is_one in derived if each.meaning.quantity is None and not is_one]
    every = [each for each in (*named, *silent) if each.meaning.unit != "mm"]
    return [each for each in every if each.meaning.side not in ("setting", "sensor")]


def _pair(columns: Sequence[Column]) -> Mapping[str, Role]:
    if not columns:
        return {}
    if len(columns) == 1:
        (only,) = columns
        port = "theta" if _side(only, "motor") > 0 else "q"
        return {port: Role(only, "by its name" if _side(only, "motor") else "the only position")}
    correlation = np.abs(np.corrcoef([each.window for each in columns]))

    def points(places: tuple[int, int]) -> float:
        """Scores two columns as positions of motor and link, in this order."""
        theta, q = (columns[place] for place in places)
        together = float(correlation[places])
        found = _points(theta, "motor") + _points(q, "link")
        # The motor position before the gear has larger values than the link position.
        found += 0.5 * (abs(line(q.window, theta.window).slope) > 1.5)
        found += (together > _ALIKE) + (together > _CLOSE) + _APART * (together < _UNLIKE)
        return found + _COPY * is_copy(theta.window, q.window)

    best = max(permutations(range(len(columns)), 2), key=points)
    if points(best) <= 0:
        named = max(columns, key=lambda each: _points(each, "link"))
        return {"q": Role(named, "the only position that stands out")}
    how = f"moves like the other position ({correlation[best]:.3g})"
    theta, q = (
        Role(each, f"by its name; {how}" if each.meaning.side or each.meaning.suggested else how)
        for each in (columns[place] for place in best)
    )
    return {"theta": theta, "q": q}


def _deformation(columns: Sequence[Column], ports: Mapping[str, Role]) -> dict[str, Role]:
    """Finds the deformation by its name, in place of the position that the log does not have."""
    named = [each for each in columns if each.meaning.quantity == "deformation"]
    measured = [each for each in named if not each.meaning.reference]
    if not measured or {"theta", "q"} <= ports.keys():
        return {}
    best = max(measured, key=_named)
    if ports:
        return {"phi": Role(best, "by its name")}
    return {"q": Role(best, "a deformation without a position: theta is 0")}


def _side(column: Column, side: str) -> float:
    """Scores a name for a side of the joint: motor or link."""
    meaning = column.meaning
    if meaning.side is not None:
        return _SAID if meaning.side == side else -_SAID
    if meaning.suggested is not None:
        return _SUGGESTED if meaning.suggested == side else -_SUGGESTED
    return 0.0


def _points(column: Column, side: str) -> float:
    """Scores a column as a candidate for the measured position of motor or link."""
    meaning = column.meaning
    points = _side(column, side) + _QUANTITY * (meaning.quantity == "position")
    return points + _REFERENCE * meaning.reference + _COMPUTED * meaning.computed


def _torques(columns: Sequence[Column], ports: Mapping[str, Role], T: float) -> dict[str, Role]:
    """Finds the columns of the motor torque, and of the torque sensor at the link."""
    torques = [each for each in columns if each.meaning.quantity == "torque"]
    currents = [each for each in columns if each.meaning.quantity == "current"]
    possible = [each for each in (*torques, *currents) if each.meaning.side != "setting"]
    sensors = [each for each in torques if _is_sensor(each, [*torques, *currents], ports)]
    named = [each for each in possible if each not in sensors]
    found = {}
    if named:
        found["tau"] = Role(max(named, key=_torque_points), "by its name")
    elif ports.keys() >= {"theta", "q"}:
        found |= _silent_torque([each for each in columns if each not in sensors], ports, T)
    if sensors:
        no_other = "the log has the torque of another motor, or none"
        why = "by its name" if sensors[0].meaning.side else no_other
        found["tau_e_sensor"] = Role(max(sensors, key=_torque_points), why)
    return found


def _is_sensor(column: Column, others: Sequence[Column], ports: Mapping[str, Role]) -> bool:
    """Returns whether a column is a sensor torque, by its name or by the other columns."""
    meaning = column.meaning
    if meaning.side is not None or _is_motor(column):
        return meaning.side in ("sensor", "link")
    motors = [each for each in others if each.meaning.quantity == "current" or _is_motor(each)]
    if not motors:
        return "theta" not in ports  # an angle and a torque: a test bench
    return not any(is_copy(column.window, each.window) for each in motors)


def _is_motor(column: Column) -> bool:
    return column.meaning.side == "motor" or column.meaning.suggested == "motor"


def _torque_points(column: Column) -> float:
    # A torque is better than a current, which needs a torque constant.
    points = _named(column) + _QUANTITY * (column.meaning.quantity == "torque")
    # The magnitude of a current or torque has no sign, and a joint that moves both ways needs one.
    points += _MAGNITUDE * (column.facts.low >= 0)
    return points + 0.5 * _REFERENCE * column.meaning.reference


def _silent_torque(
    columns: Sequence[Column], ports: Mapping[str, Role], T: float
) -> dict[str, Role]:
    """Finds the unnamed column that the motion explains best as a torque."""
    theta, q = (ports[port].column.window for port in ("theta", "q"))
    explained = [
        (drive(theta, q, each.window).explained, each)
        for each in columns
        if each.meaning.quantity is None
        and not each.meaning.reference  # a command, such as v_des, is not what the motor did
        and abs(line(theta, each.window).correlation) < _SAME
        and all(scale_of(angle, each.window, T) is None for angle in (theta, q))
    ]
    share, column = max(explained, key=lambda each: each[0], default=(0.0, None))
    if column is None or share < _EXPLAINED:
        return {}
    return {"tau": Role(column, f"the motion explains {100 * share:.3g} % of it")}


def _setting(columns: Sequence[Column], ports: Mapping[str, Role]) -> dict[str, Role]:
    """Finds the motor that sets the stiffness: by its name, or as a second, independent motor."""
    windows = [role.column.window for role in ports.values()]
    possible = [
        each
        for each in columns
        if each.meaning.quantity in ("position", None)
        # A column of set-points may also contain positions.
        and (
            (each.meaning.side == "setting" and not each.meaning.reference)
            or not any(abs(line(each.window, x).correlation) > _CLOSE for x in windows)
        )
    ]
    named = [each for each in possible if each.meaning.side == "setting"]
    if named:
        measured = [each for each in named if not each.meaning.reference]
        return {"theta_c": Role((measured or named)[0], "by its name")}
    lengths = [each for each in possible if each.meaning.unit == "mm"]
    if lengths:
        return {"theta_c": Role(lengths[0], "the only length, which sets the stiffness of a joint")}
    motors = [each for each in possible if each.meaning.side == "motor"]
    measured = [each for each in motors if not each.meaning.reference]
    second = [each for each in measured if each.meaning.quantity == "position"]
    if len(second) == 1 and "theta" in ports:
        return {
            "theta_c": Role(second[0], "position of a second motor; the link follows the first one")
        }
    return {}
