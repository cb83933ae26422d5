"""Gives the ticks of the estimator their values, from the samples of one port at other times.

A tick has the value of a sample within a thousandth of the period from it, unchanged. A tick
between two samples has a value on the line through both, if they are not further apart than the
longest gap. The value at any other tick is nan, and the estimator skips this tick.

A log has all its ticks at once, resample(); a stream has one after the other, PortSamples. Both ask
the same functions whether a tick has a value. They do not share the loop, because arrays of one
sample would take a stream several times as long.
"""

import math
from collections import deque
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from sigmahat.recording.configuration import Port
from sigmahat.recording.counters import Unwrapping
from sigmahat.recording.log import Array
from sigmahat.recording.units import Conversion

AT_TICK = 1e-3  # largest distance of a sample from its tick, in periods
_USUAL_INTERVALS = 3.0
_PART = 1 << 16  # samples that are compared at a time, to limit the memory
_MOST = 10_000  # samples of a stream that wait for their ticks

_Position = TypeVar("_Position", float, Array)  # in periods: the first tick is at 0


def _is_at(position: _Position, tick: _Position) -> "bool | NDArray[np.bool_]":
    """Whether a sample counts as a sample at a tick."""
    return abs(position - tick) <= AT_TICK


def _are_near(
    before: _Position, after: _Position, longest_gap: float
) -> "bool | NDArray[np.bool_]":
    """Whether the ticks between two samples are interpolated; all times in seconds."""
    return after - before <= with_tolerance(longest_gap)


def with_tolerance(longest_gap: float) -> float:
    """Returns the longest gap [s] with the tolerance of the ticks, as times are rounded."""
    return longest_gap * (1 + AT_TICK)


def usual_gap(interval: float) -> float:
    """Returns the longest gap [s] for samples with this interval [s], if none is configured."""
    return _USUAL_INTERVALS * interval


@dataclass(frozen=True)
class Resampled:
    """The values of a port at all ticks of a log."""

    values: Array  # [size: ticks], nan at ticks without a value
    interval: float  # median time between two samples [s]
    is_even: bool  # whether nearly every tick has a sample
    samples: int  # number of samples
    between: int = 0  # samples that are not at a tick
    interpolated: int = 0  # ticks whose values are interpolated


def resample(t: Array, values: Array, T: float, ticks: int, longest_gap: float | None) -> Resampled:
    """Computes the values at all ticks of a log. Samples with nan as time or value are left out.

    t            times since the first tick [s], increasing; nan where unknown; [size: samples]
    values       [size: samples], nan where a sample is missing; at least one sample is finite
    T            time between ticks [s]
    longest_gap  longest time between two interpolated samples [s]; None: three intervals, and no
                 interpolation for a port with a sample at nearly every tick
    """
    finite = np.isfinite(t) & np.isfinite(values)
    if not finite.all():
        t, values = t[finite], values[finite]
    if longest_gap is None and len(t) == ticks and _is_one_for_each_tick(t, T):
        return Resampled(values, T, True, len(t))  # the usual case, with the least memory
    position = t / T
    nearest = np.round(position)
    at = _is_at(position, nearest) & (nearest >= 0) & (nearest < ticks)
    resampled = np.full(ticks, np.nan)
    resampled[nearest[at][::-1].astype(np.int64)] = values[at][::-1]  # of two samples, the first
    interval = float(np.median(np.diff(t))) if len(t) > 1 else T
    between = int(np.count_nonzero(~at))
    is_even = abs(interval / T - 1) < AT_TICK and len(t) - between > 0.99 * len(t)
    if longest_gap is None:
        longest_gap = 0.0 if is_even else usual_gap(interval)
    empty = np.flatnonzero(np.isnan(resampled))
    after = np.searchsorted(position, empty)
    inside = (after > 0) & (after < len(t))
    empty, after = empty[inside], after[inside]
    empty = empty[_are_near(t[after - 1], t[after], longest_gap)]
    resampled[empty] = np.interp(empty.astype(np.float64), position, values)
    return Resampled(resampled, interval, is_even, len(t), between, len(empty))


def _is_one_for_each_tick(t: Array, T: float) -> bool:
    for first in range(0, len(t), _PART):
        part = t[first : first + _PART]
        tick = np.arange(first, first + len(part), dtype=np.float64)
        if not np.all(_is_at(part / T, tick)):
            return False
    return True


class PortSamples:
    """The samples of a port in a stream, from which the value at the next tick is computed."""

    def __init__(self, name: str, port: Port, T: float, longest_gap: float) -> None:
        """T  time between ticks [s]; longest_gap  longest gap that is interpolated [s]"""
        self.port = port
        self.interpolated = 0  # number of interpolated ticks
        self._conversion = Conversion.of(name, port)
        self._T = T
        self._longest_gap = longest_gap
        self.restart()

    def restart(self) -> None:
        """Forgets all samples: the next sample is the first of another recording."""
        self._unwrapping = None if self.port.wrap is None else Unwrapping(self.port.wrap)
        self._before = -math.inf, math.nan  # time and value of the last sample before the tick
        self._waiting: deque[tuple[float, float]] = deque(maxlen=_MOST)

    def add(self, t: float, value: float) -> None:
        """Adds the next sample of the column; t is the time since the first tick [s]."""
        if not math.isfinite(value):
            return
        if self._unwrapping is not None:
            value = self._unwrapping.unwrap_one(value)
        self._waiting.append((t - self.port.delay, self._conversion.apply(value)))

    def value_at(self, tick: int) -> float | None:
        """Returns the value at a tick, nan without a value; None if a later sample is needed.

        The ticks of successive calls must increase.
        """
        if self.port.value is not None:
            return self.port.value
        while self._waiting:
            t, value = self._waiting[0]
            position = t / self._T
            if _is_at(position, tick):
                return value
            if position > tick:
                return self._between(tick, t, value)
            self._before = self._waiting.popleft()
        return None

    def _between(self, tick: int, t: float, value: float) -> float:
        """Returns the value at a tick between the last sample before it and the next, at t [s]."""
        before, old = self._before
        if not _are_near(before, t, self._longest_gap):
            return math.nan
        self.interpolated += 1
        positions = before / self._T, t / self._T
        return float(np.interp(float(tick), positions, (old, value)))
