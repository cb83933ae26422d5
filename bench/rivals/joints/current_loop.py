"""The torque of a motor follows its command late: dead time, then a lag of the first order."""

from __future__ import annotations

import math
from collections import deque


class Delay:
    """Gives what it was given `seconds` ago, to the nearest step; zero before that."""

    def __init__(self, seconds: float, step: float) -> None:
        length = round(seconds / step)
        self._past = deque([0.0] * length, maxlen=length) if length else None

    def __call__(self, value: float) -> float:
        if self._past is None:
            return value
        oldest = self._past[0]
        self._past.append(value)
        return oldest


class CurrentLoop:
    """Torque on the motor's axis [N.m], advanced by one step of the physics at each call."""

    def __init__(self, delay: float, lag: float, step: float) -> None:
        """Dead time and time constant [s]."""
        self._delay = Delay(delay, step)
        self._share = -math.expm1(-step / lag)
        self._torque = 0.0

    def __call__(self, command: float) -> float:
        """The torque during the step that begins now, for a command that holds during it."""
        self._torque += self._share * (self._delay(command) - self._torque)
        return self._torque
