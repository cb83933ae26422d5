"""Reads counters, which start again after a period: steps of one column, and gaps in two.

A log is one call of a method for arrays; a stream is a call of a method for one value (`..._one`)
at each sample or tick, because arrays of one value would take it twice as long. Both methods of a
class follow the same rule.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeVar

import numpy as np

from sigmahat.recording.configuration import Configuration, Port
from sigmahat.recording.gaps import stretches
from sigmahat.recording.log import Array
from sigmahat.recording.units import factor

_Step = TypeVar("_Step", float, Array)


class Unwrapping:
    """Unwraps the values of a counter that starts again after a period.

    A step of more than half a period between finite values is a jump.
    """

    def __init__(self, period: float) -> None:
        """period  in the unit of the column"""
        self.jumps = 0  # number of steps at which the counter started again
        self._period = period
        self._last = math.nan  # last finite value
        self._periods = 0.0  # to be added to the next value

    def unwrap(self, values: Array) -> Array:
        """Returns the values of a column unwrapped; nan stays nan [size: samples]."""
        finite = np.isfinite(values)
        given = values[finite]
        if not len(given):
            return values
        jumps: Array = self._jump(np.diff(given, prepend=given[0]))
        self.jumps = int(np.count_nonzero(jumps))
        unwrapped: Array = values.copy()
        unwrapped[finite] += self._period * np.cumsum(jumps)
        return unwrapped

    def unwrap_one(self, value: float) -> float:
        """Returns the next value of a stream unwrapped; it must be finite."""
        if not math.isnan(self._last):
            jump = float(self._jump(value - self._last))
            self.jumps += jump != 0
            self._periods += jump
        self._last = value
        return value + self._period * self._periods

    def _jump(self, step: _Step) -> _Step:
        """Returns the periods by which a value is too small after a step, a whole number."""
        periods: _Step = -np.rint(step / self._period)
        return periods


@dataclass(frozen=True)
class JointCounter:
    """The counter of theta or q that starts again first, and the other position.

    Motor and link move alike, apart from the deformation. So the other position shows by how many
    whole periods this one is wrong.
    """

    port: str  # theta or q
    period: float  # angle after which the counter starts again [rad]
    column: int  # place of the port among the ports
    other: int  # place of the other position

    @staticmethod
    def of(ports: Mapping[str, Port]) -> "JointCounter | None":
        """Returns None if no counter starts again, or if theta or q is missing.

        Raises LogError for a unit that does not fit its port.
        """
        if not {"theta", "q"} <= ports.keys():
            return None
        periods = {name: _period(name, ports[name]) for name in ("theta", "q")}
        port, other = sorted(periods, key=periods.__getitem__)
        if math.isinf(periods[port]):
            return None
        places = list(ports)
        return JointCounter(port, periods[port], places.index(port), places.index(other))

    def missed(self, step: float, other_step: float) -> int:
        """Returns the periods that the counter missed while both positions made steps [rad]."""
        return round((other_step - step) / self.period)

    def periods_into(self, center: float, most: float, values: Array) -> int:
        """Returns the correction in periods that brings the deformation into center +- most.

        It is 0 unless the median deformation is outside and a correction brings it inside.

        center, most  [rad]
        values        of the ports at the ticks [size: ticks x ports], nan for a missing value
        """
        ahead = values[:, self.other] - values[:, self.column]
        ahead = ahead[np.isfinite(ahead)]
        if not len(ahead):
            return 0
        sign = 1 if self.port == "theta" else -1
        away = sign * float(np.median(ahead)) - center
        periods = round(away / self.period)
        if abs(away - periods * self.period) <= most < abs(away):
            return sign * periods
        return 0


def _period(name: str, port: Port) -> float:
    """Returns the angle after which the counter of a port starts again [rad]; inf if never."""
    if port.wrap is None:
        return math.inf
    return abs(factor(name, port) * port.wrap / port.gear_ratio)


@dataclass(frozen=True)
class Missed:
    """Whole periods that a counter missed during a gap."""

    tick: int  # last tick before the gap
    periods: int


class WholePeriods:
    """Corrects theta or q by whole periods of its counter, after gaps and at the start.

    After a gap, both positions must have moved equally far. A counter that was switched on in
    another turn is wrong from the start: the deformation is brought into range.phi, if it is given
    and a correction does so. A log decides this by its median, a stream by its first values.
    """

    def __init__(self, counter: JointCounter, range_phi: float | None) -> None:
        """range_phi  largest deformation [rad], None if it is not given"""
        self.counter = counter
        self.at_start = 0  # correction from the start [periods]
        self._range_phi = range_phi
        self._tick = 0  # of the next value of a stream
        self._periods = 0  # missed in all gaps until now
        self._last_tick: int | None = None  # last tick with both positions
        self._last = math.nan, math.nan  # the counter and the other position there, not corrected

    @staticmethod
    def of(configuration: Configuration) -> "WholePeriods | None":
        """Returns None if no counter of the joint starts again.

        Raises LogError for a unit that does not fit its port.
        """
        counter = JointCounter.of(configuration.ports)
        if counter is None:
            return None
        range_phi = configuration.parameters.get("range.phi")
        return WholePeriods(counter, None if range_phi is None else float(range_phi))

    def put_right(self, values: Array) -> list[Missed]:
        """Corrects the values of a log, and returns what the counter missed in gaps.

        values  of the ports at the ticks [size: ticks x ports], nan if missing; changed in place
        """
        counter = self.counter
        both = values[:, [counter.column, counter.other]]
        begins, ends = stretches(np.isfinite(both).all(axis=1))
        gaps = list[Missed]()
        corrections = [(0, 0)]  # tick, and periods from there on
        firsts, lasts = both[begins].tolist(), both[ends - 1].tolist()
        for begin, end, first, last in zip(begins, ends, firsts, lasts, strict=True):
            missed = self._missed_before(int(begin), first)
            if missed is not None:
                gaps.append(missed)
                corrections.append((begin, self._periods))
            self._last_tick, self._last = int(end) - 1, last
        for (begin, periods), (end, _) in pairwise([*corrections, (len(values), 0)]):
            values[begin:end, counter.column] += periods * counter.period
        self._decide_at_start(values)
        if self.at_start:
            values[:, counter.column] += self.at_start * counter.period
        return gaps

    def put_right_one(self, values: Array) -> None:
        """Corrects the values at the next tick of a stream.

        values  of the ports [size: ports], nan if missing; changed in place
        """
        counter = self.counter
        both = float(values[counter.column]), float(values[counter.other])
        if math.isfinite(both[0]) and math.isfinite(both[1]):
            if self._last_tick is None:
                self._decide_at_start(values.reshape(1, -1))
            self._missed_before(self._tick, both)
            self._last_tick, self._last = self._tick, both
        self._tick += 1
        for periods in (self._periods, self.at_start):
            if periods:
                values[counter.column] += periods * counter.period

    def _missed_before(self, tick: int, both: Sequence[float]) -> Missed | None:
        """Counts the periods missed since the last tick with both positions, if there was a gap.

        both  counter and other position at this tick, not corrected [rad]
        """
        if self._last_tick is None or tick == self._last_tick + 1:
            return None
        periods = self.counter.missed(both[0] - self._last[0], both[1] - self._last[1])
        self._periods += periods
        return Missed(self._last_tick, periods) if periods else None

    def _decide_at_start(self, values: Array) -> None:
        if self._range_phi is not None:
            self.at_start = self.counter.periods_into(0.0, self._range_phi, values)
