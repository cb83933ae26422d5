"""Notices that a position jumps as no joint can: its unit or its zero is another one since then."""

import math
from dataclasses import dataclass

_SPEED = 20.0  # [rad/s] A step that is slower may be a motion,
_RATIO = 20.0  # and so may one that is less than this many times as large as the steps before.


@dataclass
class Jumps:
    """The jumps of one position, from tick to tick."""

    T: float  # time between two ticks [s]
    largest: float = 0.0  # step between two ticks so far, jumps aside [rad]
    offset: float = 0.0  # sum of the jumps; 0 if the position is where it was [rad]
    _last: float = math.nan

    def add(self, position: float) -> float:
        """Returns the jump to the position at the next tick [rad], 0 without one.

        position  [rad]; nan at a tick without a value, after which any position may follow
        """
        step = position - self._last
        self._last = position
        if not math.isfinite(step):
            return 0.0
        motion = _RATIO * self.largest
        if self.largest == 0 or abs(step) < max(_SPEED * self.T, motion):
            self.largest = max(self.largest, abs(step))
            return 0.0
        self.offset += step
        if abs(self.offset) < motion:
            self.offset = 0.0
        return step
