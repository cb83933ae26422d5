"""How far the link moves with the motor."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sigmahat.identification.noise import low_pass
from sigmahat.identification.regression import Signals
from sigmahat.logs.log import Array

_SLOW = 1.0  # [Hz]
_ENOUGH = 0.1  # least fraction of slow motion, else the whole motion is used
_CORRELATED = 0.9
_RIGID = 0.99  # correlation of motor and link, beyond which the deformation is small beside both


@dataclass(frozen=True)
class Slope:
    """Slope of q on theta, of the slow motion if the log has any."""

    value: float  # [1]
    is_slow: bool
    is_rigid: bool  # whether the deformation is small beside the motion


def slope_of(pieces: Sequence[Signals], T: float) -> Slope | None:
    """Slope of q on theta by total least squares; None if q and theta do not move together."""
    if not pieces:
        return None
    motions = [np.column_stack([p.theta, p.theta + p.phi]) for p in pieces]
    slow = [_slow(each, T) for each in motions]
    is_slow = all(each is not None for each in slow)
    both = np.concatenate(
        [m - m.mean(axis=0) if s is None else s for m, s in zip(motions, slow, strict=True)]
    )
    variances = np.var(both, axis=0)
    if not np.all(variances > 0):
        return None
    # If both are scaled to variance 1, the axis is the diagonal, whatever the units are.
    correlation = np.corrcoef(both.T)[0, 1]
    if abs(correlation) < _CORRELATED:
        return None
    value = float(np.sign(correlation) * np.sqrt(variances[1] / variances[0]))
    return Slope(value, is_slow, bool(abs(correlation) > _RIGID))


def _slow(motion: Array, T: float) -> Array | None:
    """The slow part of a motion; None if this part is too small."""
    motion = motion - motion.mean(axis=0)
    slow = low_pass(motion, min(_SLOW, 0.1 / T), T)
    return slow if np.all(np.std(slow, axis=0) > _ENOUGH * np.std(motion, axis=0)) else None
