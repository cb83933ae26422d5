"""How a log moved the joint, in three numbers that do not depend on its stiffness.

Where a model does not hold exactly, the estimates depend on the motion and on the payload. A
comparison of logs therefore has to know whether they moved alike.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.result.stored import NO_OTHER_KEYS


@dataclass(frozen=True)
class Excitation:
    """Root mean squares over the ticks with data; 0 without such ticks."""

    __pydantic_config__ = NO_OTHER_KEYS

    velocity: float  # of the motor, after the gear [rad/s]
    acceleration: float  # of the motor, after the gear [rad/s2]
    torque: float  # flexibility torque of the fitted model [N.m]


class ExcitationSums:
    """Sums over the ticks of a log, chunk by chunk."""

    def __init__(self, T: float) -> None:
        """T  time between ticks [s]"""
        self._T = T
        self._squares = np.zeros(3)
        self._counts = np.zeros(3)

    def add(self, outputs: Mapping[str, NDArray[Any]]) -> None:
        """Adds the outputs theta_dot, tau_e and valid of the next ticks."""
        valid = outputs["valid"].astype(bool)
        velocity, torque = outputs["theta_dot"], outputs["tau_e"]
        steps = np.diff(velocity)[valid[1:] & valid[:-1]] / self._T
        for i, values in enumerate((velocity[valid], steps, torque[valid])):
            self._squares[i] += values @ values
            self._counts[i] += len(values)

    @property
    def excitation(self) -> Excitation:
        return Excitation(*np.sqrt(self._squares / np.maximum(self._counts, 1)).tolist())
