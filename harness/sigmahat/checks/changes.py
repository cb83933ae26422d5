"""Proposes other values for the scale of an angle: gear ratio, unit, or counts per turn."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from sigmahat.checks.findings import Proposal
from sigmahat.recording.configuration import Port
from sigmahat.recording.units import factor

_ANGLES = ("rad", "deg", "turn")
_COUNTS = tuple(2.0**k for i in (2, 1, 3, 4, 5, 6) for k in (i, -i))
"""Likely factors of wrong counts, such as two or four counts per line of the encoder."""
_WHOLE = 0.02
"""Largest relative error up to which the nearest integer is proposed as gear ratio."""


@dataclass(frozen=True)
class Change:
    """Another value of a configuration key, and the factor by which the port values change."""

    port: str  # theta or q
    key: str
    value: Proposal
    factor: float
    fits_any: bool = False
    """Whether the value was computed from the slope, and therefore fits any slope."""

    @property
    def on_theta(self) -> float:
        """Factor of theta that has the same effect on the slope of q relative to theta."""
        return self.factor if self.port == "theta" else 1 / self.factor


def changes(name: str, port: Port, gamma: float) -> Iterator[Change]:
    """Yields possible changes of the scale of an angle, likely changes first.

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
    """Proposes the gear ratio for which motor and link move equally far.

    slope       regression slope of q on theta [1]
    half_width  half of the 95 % interval of the slope [1]
    """
    now = abs(theta.gear_ratio)
    gear = _simplest(now / slope, half_width / slope)
    return Change("theta", "ports.theta.gear_ratio", gear, now / gear, fits_any=True)


def _simplest(gear: float, half_width: float) -> float:
    """Rounds a gear ratio to the integer with the most zeros in its interval, whose half width is
    relative [1]; else to the nearest integer, else to four digits."""
    for digits in range(len(f"{gear:.0f}")):
        likely = float(f"{gear:.{digits + 1}g}")
        if likely.is_integer() and abs(likely / gear - 1) < half_width:
            return likely
    whole = float(round(gear))
    return whole if whole and abs(gear / whole - 1) < _WHOLE else float(f"{gear:.4g}")


def distance(one: float, other: float) -> float:
    """Computes the distance of two positive factors on a logarithmic scale [1]."""
    return abs(math.log(one / other))
