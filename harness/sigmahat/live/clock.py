"""The stamps of a sender: which samples are in order, and whether the sender has started again."""

from __future__ import annotations

import math

from sigmahat.logs.log import EXACT

_LATE = 1.0
"""A sample that is later than another by less was overtaken on its way [s]."""
LONGEST_PAUSE = 1.0
"""A sample after a longer pause is off, or that of a sender that has started again [s]."""
_STARTED = 20
"""So many in order, far from the others, are those of a sender that has started again."""
_ADAPT = 0.01
_SHORTEST = 1e-6  # [s] between two samples


class Clock:
    """The times of one column, in seconds since its first one."""

    def __init__(self, seconds: float) -> None:
        """seconds  in the unit of the column"""
        self.seconds = seconds
        self.double = self.late = self.strays = self.lost = 0
        """Samples with the time of the one before, late ones, ones far off; samples missing."""
        self.usual = 0.0
        """Usual time between two samples [s]."""
        self.restart()

    def restart(self) -> None:
        """The next sample is the first one."""
        self.shift: int | None = None
        """From which times count: the first one, if it is a whole number that a float64 does not
        hold, else 0; None before it."""
        self.now = self._floor = 0.0
        self._stray = math.nan
        self._in_order = 0

    def take(self, stamp: int | float) -> float | None:
        """The time of the next sample [s]; None if it has to be left out."""
        if stamp != stamp or (self.shift and not isinstance(stamp, int)):
            self.strays += 1
            return None
        is_first = self.shift is None
        if self.shift is None:
            self.shift = stamp if isinstance(stamp, int) and abs(stamp) > EXACT else 0
        t = float(stamp - self.shift) * self.seconds
        if is_first or self._floor < t <= self.now + LONGEST_PAUSE:
            if not is_first:
                self._count(t - self.now)
            self.now = self._floor = t
            self._in_order = 0
            return t
        if self.now - _LATE < t <= max(self.now, self._floor):
            self.double += t == self.now
            self.late += t != self.now
        else:
            follows = self._stray < t < self._stray + LONGEST_PAUSE
            self._in_order = self._in_order + 1 if follows else 1
            self._stray = t
            self.strays += 1
        return None

    @property
    def has_restarted(self) -> bool:
        """Whether the last samples are those of a sender that has started again."""
        return self._in_order >= _STARTED

    def give_up(self, t: float) -> None:
        """Leaves out samples up to this time, if they still come [s]."""
        self._floor = max(self._floor, t)

    def _count(self, step: float) -> None:
        if self.usual == 0.0:
            self.usual = max(step, _SHORTEST)
        self.lost += max(round(step / self.usual) - 1, 0)
        self.usual += _ADAPT * self.usual * (1 if step > self.usual else -1)
