"""The time stamps of a sender: order of the samples, and restarts of the sender."""

import math

from sigmahat.recording.log import EXACT

_LATE = 1.0  # a sample that is late by less than this time was overtaken by other samples [s]
LONGEST_PAUSE = 1.0  # [s] after a longer one, the time is wrong or the sender has restarted
_STARTED = 20  # number of ordered samples at other times that shows a restart of the sender
_ADAPT = 0.01
_SHORTEST = 1e-6  # [s] between two samples


class Clock:
    """The times of one column, in seconds since `shift`."""

    def __init__(self, seconds: float) -> None:
        """seconds  in the unit of the column"""
        self.seconds = seconds
        self.double = self.late = self.strays = self.lost = 0
        """Numbers of samples: with the previous time, late, far off in time, and missing."""
        self.usual = 0.0  # usual time between two samples [s]
        self.restart()

    def restart(self) -> None:
        self.shift: int | None = None
        """Zero of the times: the first time, if it is an integer that a float64 does not hold,
        else 0; None before the first time."""
        self.now = self._floor = 0.0
        self._stray = math.nan
        self._in_order = 0

    def take(self, stamp: int | float) -> float | None:
        """Returns the time of the next sample [s]; None if the sample must be left out."""
        if stamp != stamp or (self.shift and not isinstance(stamp, int)):
            self.strays += 1
            return None
        is_first = self.shift is None
        if self.shift is None:
            self.shift = stamp if isinstance(stamp, int) and abs(stamp) > EXACT else 0
        t = float(stamp - self.shift) * self.seconds
        if is_first or self._floor < t <= self.now + LONGEST_PAUSE:
            if not is_first:
                step = t - self.now
                self.usual = self.usual or max(step, _SHORTEST)
                self.lost += max(round(step / self.usual) - 1, 0)
                self.usual += _ADAPT * self.usual * (1 if step > self.usual else -1)
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
        """Whether the last samples show that the sender has started again."""
        return self._in_order >= _STARTED

    @property
    def last(self) -> float:
        """Time of the last sample in order, as the sender counts it [s]."""
        return self.now + (self.shift or 0) * self.seconds

    @property
    def newest(self) -> float:
        """Time of the last sample far off, as the sender counts it [s]."""
        return self._stray + (self.shift or 0) * self.seconds

    @property
    def jump(self) -> float:
        """From the last sample in order to the last one far off [s]."""
        return self._stray - self.now

    def give_up(self, t: float) -> None:
        """Leaves out later samples whose time is not after t [s]."""
        self._floor = max(self._floor, t)
