"""Other values of the scale of an angle: of its gear ratio, its unit or its counts per turn."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from sigmahat.checks.findings import Proposal
from sigmahat.logs.configuration import Port
from sigmahat.logs.units import factor

_ANGLES = ("rad", "deg", "turn")
_COUNTS = tuple(2.0**k for i in (2, 1, 3, 4, 5, 6) for k in (i, -i))
"""Likely factors of wrong counts: two or four counts per line, and wraps mistaken for turns."""
_WHOLE = 0.02
"""Most gear ratios are integers: up to this relative error, the nearest integer is proposed."""


@dataclass(frozen=True)
class Change:
    """Another value of a key, and the factor by which the values of the port change."""

    port: str  # theta or q
    key: str
    value: Proposal
    factor: float
    fits_any: bool = False
    """Whether the value was computed from the slope in the log, so that any slope fits."""

    @property
    def on_theta(self) -> float:
        """The factor of theta that has the same effect on the slope."""
        return self.factor if self.port == "theta" else 1 / self.factor


def changes(name: str, port: Port, gamma: float) -> Iterator[Change]:
    """Changes of the scale of an angle, likely changes first.

    name   theta or q
    gamma  gear ratio of the motor
    """
    where, gear = f"ports.{name}", abs(port.gear_ratio)
    if name == "theta" and gear != abs(gamma):
        yield Change(name, f"{where}.gear_ratio", abs(gamma), gear / abs(gamma))
    if gear != 1:
        yield Change(name, f"{where}.gear_ratio", 1.0, gear)
    if port.scale is None and port.unit in (None, *_ANGLES):
        now = factor(name, port)
        for unit in _ANGLES:
            other = factor(name, Port(port.column, unit=unit))
            if other != now:
                yield Change(name, f"{where}.unit", unit, other / now)
    if port.unit == "counts" and port.counts_per_turn is not None:
        for times in _COUNTS:
            value = port.counts_per_turn * times
            yield Change(name, f"{where}.counts_per_turn", value, 1 / times)


def gear_of(theta: Port, slope: float, half_width: float = 0.0) -> Change:
    """The gear ratio with which the motor moves as far as the link.

    slope       of q on theta [1]
    half_width  half of the 95 % interval of the slope [1]
    """
    now = abs(theta.gear_ratio)
    gear = _simplest(now / slope, half_width / slope)
    return Change("theta", "ports.theta.gear_ratio", gear, now / gear, fits_any=True)


def _simplest(gear: float, half_width: float) -> float:
    """The integer with the most zeros in an interval, whose half width is relative [1]; else the
    nearest integer, else four digits."""
    for digits in range(len(f"{gear:.0f}")):
        likely = float(f"{gear:.{digits + 1}g}")
        if likely.is_integer() and abs(likely / gear - 1) < half_width:
            return likely
    whole = float(round(gear))
    return whole if whole and abs(gear / whole - 1) < _WHOLE else float(f"{gear:.4g}")


def distance(one: float, other: float) -> float:
    """Distance of two positive factors on a logarithmic scale [1]."""
    return abs(math.log(one / other))
