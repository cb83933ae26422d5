"""Defines a hypothesis about a configuration, and lists the likely ones for the scale of an angle:
gear ratio, unit, or counts per turn."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from sigmahat.motor.log_view import LogView
from sigmahat.recording.configuration import Configuration, Port
from sigmahat.recording.units import TURN, factor

Setting = float | bool | str  # value of a key, as it stands in the configuration

_ANGLES = ("rad", "deg", "turn")
_COUNTS = tuple(2.0**k for i in (2, 1, 3, 4, 5, 6) for k in (i, -i))
"""Likely factors of wrong counts, such as two or four counts per line of the encoder."""
_POWERS_OF_TEN = (-3, -2, -1, 1, 2, 3)  # decimal places by which a gear ratio may be mistyped
_WHOLE = 0.02
"""Largest relative error up to which the nearest integer is proposed as gear ratio."""


@dataclass(frozen=True)
class Hypothesis:
    """Another value of a configuration key, with its effect on the signals of a log."""

    key: str  # as "ports.theta.gear_ratio" or "motor.B"
    value: Setting | None  # None if the log does not show the value
    port: str = ""  # theta, q or tau, if the value scales the signals of this port
    factor: float = 1.0  # of these signals
    fits_any: bool = False
    """Whether the value was computed from the slope of q on theta, and therefore fits any slope."""

    @property
    def on_theta(self) -> float:
        """Factor of theta that has the same effect on the slope of q relative to theta."""
        return 1 / self.factor if self.port == "q" else self.factor

    def applied(self, view: LogView) -> LogView:
        """Changes the signals of a log as the value would do."""
        return view.scaled(self.port, self.factor)


@dataclass(frozen=True)
class Evidence:
    """What a log shows against its configuration, and the hypotheses that explain it."""

    measured: float
    hypotheses: Sequence[Hypothesis]  # at least one, the most likely first


def with_value(configuration: Configuration, key: str, value: Any) -> Configuration:
    """Changes the value of a configuration key, such as "ports.tau.sign" or "motor.gamma"."""
    section, _, name = key.partition(".")
    if section == "time":
        return replace(configuration, time=replace(configuration.time, **{name: value}))
    if section != "ports":
        return replace(configuration, parameters={**configuration.parameters, key: value})
    port, _, name = name.partition(".")
    changed = replace(configuration.ports[port], **{name: value})
    return replace(configuration, ports={**configuration.ports, port: changed})


def scales(name: str, port: Port, gamma: float) -> Iterator[Hypothesis]:
    """Yields hypotheses about the scale of an angle, likely ones first.

    name   theta or q
    gamma  gear ratio of the motor
    """
    gear = abs(port.gear_ratio)
    if name == "theta" and gear != abs(gamma):
        yield _gear(name, gear, abs(gamma))
    if gear != 1:
        yield _gear(name, gear, 1.0)
    if port.scale is None and port.unit in (None, *_ANGLES):
        now = factor(name, port)
        for unit in _ANGLES:
            other = factor(name, Port(port.column, unit=unit))
            if other != now:
                yield Hypothesis(f"ports.{name}.unit", unit, name, other / now)
    if port.unit == "counts" and port.counts_per_turn is not None:
        for times in _COUNTS:
            value = port.counts_per_turn * times
            yield Hypothesis(f"ports.{name}.counts_per_turn", value, name, 1 / times)


def mistyped_gears(theta: Port) -> Iterator[Hypothesis]:
    """Yields gear ratios of theta that are upside down, or have a zero too many or too few."""
    gear = abs(theta.gear_ratio)
    for other in (1 / gear, *(gear * 10.0**k for k in _POWERS_OF_TEN)):
        yield _gear("theta", gear, other)


def gear_of_slope(theta: Port, slope: float, half_width: float = 0.0) -> Hypothesis:
    """Proposes the gear ratio for which motor and link move equally far.

    slope       slope of q on theta [1]
    half_width  half of the 95 % interval of the slope [1]
    """
    now = abs(theta.gear_ratio)
    return replace(_gear("theta", now, _simplest(now / slope, half_width / slope)), fits_any=True)


def _gear(name: str, now: float, other: float) -> Hypothesis:
    return Hypothesis(f"ports.{name}.gear_ratio", other, name, now / other)


def _simplest(gear: float, half_width: float) -> float:
    """Rounds a gear ratio to the integer with the most zeros in its interval, whose half width is
    relative [1]; else to the nearest integer, else to four digits."""
    for digits in range(len(f"{gear:.0f}")):
        likely = float(f"{gear:.{digits + 1}g}")
        if likely.is_integer() and abs(likely / gear - 1) < half_width:
            return likely
    whole = whole_gear(gear, _WHOLE)
    return float(f"{gear:.4g}") if whole is None else whole


def whole_gear(gear: float, tolerance: float) -> float | None:
    """Returns the integer next to a gear ratio; None if the relative difference is too large."""
    whole = max(float(round(gear)), 1.0)
    return whole if abs(gear / whole - 1) < tolerance else None


def unit_of_same_turn(other: str, ratio: float, tolerance: float) -> str | None:
    """Finds the unit of an angle that turns as far as another angle; None without such a unit.

    other      unit of the other angle
    ratio      values of this angle divided by values of the other angle
    tolerance  largest relative difference of the turns
    """
    turn = ratio * TURN[other]
    same = (unit for unit in TURN if abs(turn / TURN[unit] - 1) < tolerance)
    return next(same, None)


def distance(one: float, other: float) -> float:
    """Computes the distance of two positive factors on a logarithmic scale [1]."""
    return abs(math.log(one / other))
