"""What a port would be with another sign, unit, gear ratio or number of counts."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from sigmahat.checks.findings import Proposal
from sigmahat.logs.configuration import Port
from sigmahat.logs.units import factor

_ANGLES = ("rad", "deg", "turn")
_COUNTS = tuple(2.0**k for i in (2, 1, 3, 4, 5, 6) for k in (i, -i))
"""Other numbers of counts: the evaluation of lines is two- or four-fold, and wraps are no turns."""
_LIKE = math.log(2.0)
"""A spring deforms, so q and theta do not move alike: a factor is recognised up to this."""


@dataclass(frozen=True)
class Change:
    """Another value of a key, and by what it multiplies the values of the port."""

    key: str
    value: Proposal
    factor: float


def changes(name: str, port: Port, gamma: float) -> Iterator[Change]:
    """Changes of the scale of an angle, the likely ones first.

    name   theta or q
    gamma  gear ratio of the motor
    """
    where, gear = f"ports.{name}", abs(port.gear_ratio)
    if name == "theta" and gear == 1:
        yield Change(f"{where}.gear_ratio", abs(gamma), 1 / abs(gamma))
    if gear != 1:
        yield Change(f"{where}.gear_ratio", 1.0, gear)
    if port.scale is None and port.unit in (None, *_ANGLES):
        now = factor(name, port)
        for unit in _ANGLES:
            other = factor(name, Port(port.column, unit=unit))
            if other != now:
                yield Change(f"{where}.unit", unit, other / now)
    if port.unit == "counts" and port.counts_per_turn is not None:
        for times in _COUNTS:
            value = port.counts_per_turn * times
            yield Change(f"{where}.counts_per_turn", value, 1 / times)


def like(one: float, other: float) -> bool:
    """Whether two positive factors may be the same."""
    return distance(one, other) < _LIKE


def distance(one: float, other: float) -> float:
    """Distance of two positive factors on a logarithmic scale [1]."""
    return abs(math.log(one / other))
