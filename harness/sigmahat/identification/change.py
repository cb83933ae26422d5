"""A stiffness that changes at some time in the log: with one spring, what changes would look like
inertia and friction of the motor.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sigmahat.identification.regression import Equations, Form, Signals, equations, eta, units
from sigmahat.logs.log import Array

_PLACES = 16  # times that are tried first, then each block between two of them
_EXPLAINED = 0.3
"""Largest squared error of two springs, over that of one. A change by a fifth leaves 0.04; without
a change, at least 0.6 was left on 38 logs with hysteresis, backlash and friction of other forms."""
_ORDER = 4  # powers of the torque of each of the two springs


def change_of_spring(pieces: Sequence[Signals], T: float, gamma: float, f_0: float) -> int | None:
    """The sample from which on another spring explains the log far better; None if none does, or
    if the log has a set-point.

    Samples are counted over all pieces. T, gamma and f_0 as for fit_motor().
    """
    if any(np.ptp(piece.set_point) > 0 for piece in pieces):
        return None
    form = Form(f_0, min(2.5 * f_0, 0.1 / T), n=_ORDER, symmetric=False)
    system = equations(pieces, T, gamma, form)
    blocks = len(system.rows)
    step = max(1, blocks // _PLACES)
    places = range(step, blocks, step)
    if not len(places):
        return None
    first = min(places, key=lambda place: _error(system, place))
    near = range(max(first - step + 1, 1), min(first + step, blocks))
    best = min(near, key=lambda place: _error(system, place))
    if not _error(system, best) < _EXPLAINED * _error(system, blocks):
        return None
    return int(system.rows[:best].sum())


def _error(system: Equations, place: int) -> float:
    """Sum of the squared errors with another spring from this block on."""
    scale = system.scale
    X = system.R[:, :, :-1] / np.where(scale > 0, scale, 1.0)
    spring = [system.names.index(name) for name in eta(_ORDER, 1)]
    later = X[:, :, spring] * (np.arange(len(X)) >= place)[:, None, None]
    both = np.concatenate([X, later], axis=2).reshape(-1, X.shape[2] + len(spring))
    y = system.R[:, :, -1].ravel()
    error = y - both @ np.linalg.lstsq(both, y, rcond=1e-10)[0]
    return float(error @ error)


def with_two_springs(pieces: Sequence[Signals], first: int) -> list[Signals]:
    """Pieces with regressors for what the spring has in addition from this sample on."""
    unit, begin, found = units(pieces)[0], 0, []
    for piece in pieces:
        later = np.arange(begin, begin + len(piece.phi)) >= first
        powers: Array = np.vander(piece.phi / unit, _ORDER, increasing=True)
        found.append(replace(piece, extra=powers * later[:, None]))
        begin += len(piece.phi)
    return found
