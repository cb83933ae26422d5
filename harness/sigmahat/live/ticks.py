"""One port on the ticks of the estimator while its samples arrive: as logs/resampling.py does it
for a column, and logs/sampling.py for its unit and its counter.
"""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from sigmahat.logs.configuration import Port
from sigmahat.logs.resampling import AT_TICK
from sigmahat.logs.units import scale

_MOST = 10_000
"""Samples that wait for the ticks of slower ports."""


class PortTicks:
    """The samples of a port from which its value at the next tick will be computed."""

    def __init__(self, name: str, port: Port, T: float, longest_gap: float) -> None:
        """T  time between ticks [s]; longest_gap  over which values are interpolated [s]"""
        self.port = port
        self._T = T
        self._longest = longest_gap * (1 + AT_TICK)
        self._scale = scale(name, port)
        self.interpolated = 0
        """Ticks."""
        self.restart()

    def restart(self) -> None:
        """The next sample is the first one."""
        self._before: tuple[float, float] | None = None
        self._next: deque[tuple[float, float]] = deque(maxlen=_MOST)
        self._last = math.nan
        self._jumps = 0.0

    def add(self, t: float, value: float) -> None:
        """The next sample of the column; t is the time since the first tick [s]."""
        period = self.port.wrap
        if not math.isfinite(value):
            return
        if period is not None:
            if self._last == self._last:
                self._jumps -= round((value - self._last) / period)
            self._last = value
            value = value + period * self._jumps
        if self._scale != 1.0 or self.port.zero != 0.0:
            value = (value - self.port.zero) * self._scale
        self._next.append((t - self.port.delay if self.port.delay else t, value))

    def at(self, tick: int) -> float | None:
        """The value at a tick, nan if there is none; None if a later sample will tell.

        Ticks are asked for in their order.
        """
        if self.port.value is not None:
            return self.port.value
        while self._next:
            t, value = self._next[0]
            position = t / self._T
            if abs(position - tick) <= AT_TICK:
                return value
            if position > tick:
                return self._between(tick)
            self._before = self._next.popleft()
        return None

    def _between(self, tick: int) -> float:
        """The value between two samples."""
        after = self._next[0]
        if self._before is None or after[0] - self._before[0] > self._longest:
            return math.nan
        self.interpolated += 1
        times = self._before[0] / self._T, after[0] / self._T
        return float(np.interp(float(tick), times, (self._before[1], after[1])))
