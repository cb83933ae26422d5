"""Computes the slope of the motions of motor and link, and the gear between them.

The guess of a configuration (`init`) and its check ask the same functions.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sigmahat.motor.hypotheses.hypothesis import whole_gear
from sigmahat.motor.noise import low_pass
from sigmahat.recording.log import Array

_SLOW = 1.0  # [Hz]
_ENOUGH = 0.1  # least fraction of slow motion; with less, the whole motion is used
_CORRELATED = 0.9
_RIGID = 0.99  # with a higher correlation of motor and link, the deformation is negligible
_AFTER_GEAR = 1.4  # largest ratio of motor to link motion if the encoder is after the gear
_STIFF = 0.005  # largest ratio of deformation to motion if the motion determines the gear ratio
_WHOLE = 0.002  # relative difference up to which a gear ratio is an integer


@dataclass(frozen=True)
class Slope:
    """Slope of q on theta, from the slow motion if the log contains slow motion."""

    value: float  # in the units of both
    correlation: float
    is_slow: bool
    rest: float
    """Standard deviation of what is not proportional in the whole motion, relative to the motion.
    """

    @property
    def is_clear(self) -> bool:
        """Whether motor and link move alike."""
        return abs(self.correlation) >= _CORRELATED

    @property
    def is_rigid(self) -> bool:
        """Whether the deformation is small compared with the motion."""
        return abs(self.correlation) > _RIGID


def slope_of(motions: Sequence[Array], T: float) -> Slope | None:
    """Computes the slope of q on theta by total least squares; None if an angle does not move, or
    without any correlation.

    motions  theta and q of stretches without a gap [size: samples x 2]
    T        time between samples [s]
    """
    if not motions:
        return None
    motions = [motion - motion.mean(axis=0) for motion in motions]
    slow = [low_pass(motion, min(_SLOW, 0.1 / T), T) for motion in motions]
    enough = [
        bool(np.all(np.std(s, axis=0) > _ENOUGH * np.std(m, axis=0)))
        for s, m in zip(slow, motions, strict=True)
    ]
    both = np.concatenate([s if e else m for s, m, e in zip(slow, motions, enough, strict=True)])
    variances = np.var(both, axis=0)
    if not np.all(variances > 0):
        return None
    # With both signals scaled to variance 1, the principal axis is the diagonal.
    correlation = float(np.corrcoef(both.T)[0, 1])
    if correlation == 0:
        return None
    value = float(np.sign(correlation) * np.sqrt(variances[1] / variances[0]))
    whole = np.corrcoef(np.concatenate(motions).T)[0, 1]
    return Slope(value, correlation, all(enough), math.sqrt(max(1 - whole**2, 0.0)))


@dataclass(frozen=True)
class Gear:
    """Gear between two positions, by their motions."""

    ratio: float  # turns of the motor per turn of the link
    is_after: bool  # whether the motor's encoder is after the gear, so that both move alike
    whole: float | None  # integer, if the motion determines it


def gear_between(slope: Slope, turn_of_theta: float, turn_of_q: float) -> Gear:
    """Computes the gear ratio of theta from a slope; one turn of each position, in its unit."""
    ratio = turn_of_q / turn_of_theta / abs(slope.value)
    is_after = 1 / _AFTER_GEAR < ratio < _AFTER_GEAR
    return Gear(ratio, is_after, whole_gear(ratio, _WHOLE) if slope.rest < _STIFF else None)
