"""A stiffness that changes at some time in the log: with one spring, what changes would look like
inertia and friction of the motor.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sigmahat.identification.regression import (
    WIDEST,
    Equations,
    Form,
    Signals,
    equations,
    eta,
    factor,
    units,
)
from sigmahat.logs.log import Array

_PLACES = 16  # steps in which the time is looked for, then in smaller ones around the best
_EXPLAINED = 0.3
"""Largest squared error of two springs, over that of one. A change by a fifth leaves 0.04; without
a change, at least 0.6 was left on 38 logs with hysteresis, backlash and friction of other forms."""
_ORDER = 4  # powers of the torque of each of the two springs


def plain_equations(pieces: Sequence[Signals], T: float, gamma: float, f_0: float) -> Equations:
    """The equations of one spring with even and odd powers, without a set-point.

    T, gamma and f_0 as for fit_motor().
    """
    form = Form(f_0, min(2.5 * f_0, WIDEST / T), n=_ORDER, symmetric=False)
    return equations(pieces, T, gamma, form)


def change_of_spring(system: Equations, pieces: Sequence[Signals]) -> int | None:
    """The sample from which on another spring explains the log far better; None if none does, or
    if the log has a set-point.

    Samples are counted over all pieces, of which these are the plain equations.
    """
    if any(np.ptp(piece.set_point) > 0 for piece in pieces):
        return None
    scale = system.scale
    R = system.R / np.append(np.where(scale > 0, scale, 1.0), 1.0)
    spring = [system.names.index(name) for name in eta(_ORDER, 1)]

    def error(place: int) -> float:
        """Sum of the squared errors with another spring from this block on."""
        before, later = (factor(each.reshape(-1, R.shape[2])) for each in (R[:place], R[place:]))
        one, other = np.concatenate([before, later]), np.concatenate([0 * before, later])
        both, y = np.column_stack([one[:, :-1], other[:, spring]]), one[:, -1]
        left = y - both @ np.linalg.lstsq(both, y, rcond=1e-10)[0]
        return float(left @ left)

    blocks = step = len(system.rows)
    best = 0
    while step > 1:
        step = max(1, step // _PLACES)
        near = range(best - _PLACES * step, best + _PLACES * step + 1, step)
        best = min((n for n in near if 0 < n < blocks), key=error)
    if not error(best) < _EXPLAINED * error(blocks):
        return None
    return int(system.rows[:best].sum())


def with_two_springs(pieces: Sequence[Signals], first: int) -> list[Signals]:
    """Pieces with regressors for what the spring has in addition from this sample on."""
    unit, begin, found = units(pieces)[0], 0, []
    for piece in pieces:
        later = np.arange(begin, begin + len(piece.phi)) >= first
        powers: Array = np.vander(piece.phi / unit, _ORDER, increasing=True)
        found.append(replace(piece, extra=powers * later[:, None]))
        begin += len(piece.phi)
    return found
