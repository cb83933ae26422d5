"""Converts the columns of a log to the units of their ports."""

import math
import re
from dataclasses import dataclass
from difflib import get_close_matches
from typing import TypeVar

from sigmahat.fmi.quoted import quoted
from sigmahat.recording.configuration import PORTS, Port
from sigmahat.recording.log import Array, LogError

TURN = {
    "rad": 2 * math.pi,
    "mrad": 2000 * math.pi,
    "deg": 360.0,
    "turn": 1.0,
    "arcmin": 21600.0,
    "arcsec": 1296000.0,
}
"""Size of one turn in each unit of angle."""
_Values = TypeVar("_Values", float, Array)
_USUAL = ("rad", "mrad", "deg", "turn", "counts", "N.m", "mN.m", "kN.m", "lbf.in", "A", "mA", "mm")
_USUAL_TIMES = ("s", "ms", "us", "ns", "min", "h", "day")
_LONGEST = 40  # characters of a unit
_SMALL = "\u2070\u00b9\u00b2\u00b3\u2074-\u2079"  # digits that are written as exponents
_TOWER = re.compile(rf"[\d){_SMALL}]\s*(\*\*|\^|[{_SMALL}])|(\*\*|\^)\s*[+-]?\s*(\d\d|[^\d\s+-])")
"""Pattern of a power of a number, or a long exponent: to compute 9**9**9 would take too long."""
_MOST_COUNTS = 1e15  # per turn of the joint; an encoder with a gear has 1e9


def seconds(unit: str) -> float:
    """Returns the seconds in one unit of time. Raises LogError for any other unit."""
    return _in("time.unit", unit, "s", _USUAL_TIMES)


def counts_of_joint(name: str, port: Port) -> float | None:
    """Returns the counts of the encoder per turn of the joint; None for a port without counts and
    steps.

    Raises LogError for a unit that does not fit the port.
    """
    if port.unit == "counts" and port.counts_per_turn is not None:
        return port.counts_per_turn * abs(port.gear_ratio)
    if port.step is None or PORTS[name] != "rad":
        return None
    step = abs(factor(name, port) * port.step)
    # Of a step that is far smaller than any encoder has, the quotient would be infinite.
    counts = 2 * math.pi / step if step else math.inf
    if not counts * abs(port.gear_ratio) < _MOST_COUNTS:
        raise LogError(
            f"ports.{name}.step: expected at most {_MOST_COUNTS:g} steps per turn, got a step of "
            f"{port.step:g}; fill in the step in the unit of the column"
        )
    return round(counts) * abs(port.gear_ratio)


def factor(name: str, port: Port) -> float:
    """Returns the factor from the column to the unit of the port, without sign, zero and gear.

    Raises LogError for a unit that is unknown or does not fit, and for a missing key that the unit
    needs.
    """
    where = f"ports.{name}"
    target = PORTS[name]
    if port.scale is not None:
        if port.unit is not None:
            raise LogError(f"{where}: expected scale or unit, got both; remove one of them")
        return port.scale
    if port.unit is None or port.unit == target:
        return 1.0
    if port.unit == "counts":
        if target != "rad":
            raise LogError(
                f"{where}: expected a unit of torque, got counts, an angle; set scale instead"
            )
        return 2 * math.pi / _needed(where, port, "counts_per_turn", "counts")
    if target == "N.m" and _is(port.unit, "A"):
        return _in(where, port.unit, "A") * _needed(where, port, "torque_constant", port.unit)
    if name == "theta_c" and _is(port.unit, "mm"):
        per_turn = port.mm_per_turn
        return _in(where, port.unit, "mm") * (2 * math.pi / per_turn if per_turn else 1.0)
    return _in(where, port.unit, target)


def scale(name: str, port: Port) -> float:
    """Returns the factor from the column to the unit of the port, with sign and gear."""
    return port.sign * factor(name, port) / port.gear_ratio


@dataclass(frozen=True)
class Conversion:
    """Converts unwrapped values of a column to the unit of its port: (value - zero) scale."""

    zero: float  # in the unit of the column
    scale: float

    @staticmethod
    def of(name: str, port: Port) -> "Conversion":
        """Raises LogError for a unit that does not fit the port."""
        return Conversion(port.zero, scale(name, port))

    def apply(self, values: _Values) -> _Values:
        """Converts numbers or arrays; values that need no conversion are not copied."""
        if (self.zero, self.scale) == (0.0, 1.0):
            return values
        converted: _Values = values - self.zero
        converted *= self.scale
        return converted


def _needed(where: str, port: Port, key: str, unit: str) -> float:
    value = getattr(port, key)
    if value is None:
        raise LogError(f"{where}: unit {quoted(unit)} needs {key}; add it to [{where}]")
    return float(value)


def _is(unit: str, kind: str) -> bool:
    try:
        _in("", unit, kind)
    except LogError:
        return False
    return True


def _in(where: str, unit: str, target: str, usual: tuple[str, ...] = _USUAL) -> float:
    if unit == target:  # as usual; pint takes long to import
        return 1.0
    if len(unit) > _LONGEST or _TOWER.search(unit):  # pint would compute the power
        raise LogError(f"{where}: unknown unit {quoted(unit)}{_meant('', usual)}")
    import pint

    try:
        # N.m is N*m in the notation of pint.
        quantity = pint.Quantity(1.0, unit.replace(".", "*"))
        return float(quantity.to(target.replace(".", "*")).magnitude)
    except pint.DimensionalityError as error:
        raise LogError(
            f"{where}: unit {quoted(unit)} cannot be converted to {target}{_meant('', usual)}"
        ) from error
    except Exception as error:  # any: the parser of pint raises many kinds
        raise LogError(f"{where}: unknown unit {quoted(unit)}{_meant(unit, usual)}") from error


def _meant(unit: str, usual: tuple[str, ...]) -> str:
    similar = get_close_matches(unit, usual, n=2, cutoff=0.5)
    if similar:
        return "; did you mean " + " or ".join(map(repr, similar)) + "?"
    return f"; usual units are {', '.join(usual)}"
