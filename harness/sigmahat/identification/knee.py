"""The deformation at which the slope of the spring changes at once, as in harmonic drives.

The equation of the motor gets a column max(|phi| - k, 0) sign(phi) more. It is linear in its
coefficient, so the errors are compared for many places k, with the polynomial that the estimator
has.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sigmahat.identification.regression import Fit, Form, Signals, equations, fit, is_worse
from sigmahat.logs.log import Array

_SHARES = np.linspace(0.1, 0.9, 17)  # of the usual deformation: places that are compared
_USUAL = 0.995  # quantile of the deformation that is not rare
_FINER = np.array(
    [-0.04, -0.03, -0.02, -0.01, 0.01, 0.02, 0.03, 0.04]
)  # added to the best one, for places near it
_MOST = 100_000  # samples that are used


def knee(pieces: Sequence[Signals], T: float, gamma: float, form: Form, zero: float) -> float:
    """Place of the knee, from the zero [rad]; nan if the log shows none.

    T      time between samples [s]
    gamma  gear ratio
    form   polynomial of the estimator, and filters
    zero   deformation at which the spring has no torque [rad]
    """
    used = _first(pieces)
    phi = np.abs(np.concatenate([piece.phi for piece in used]) - zero)
    usual = float(np.quantile(phi, _USUAL))

    def fitted(share: float) -> Fit:
        k = share * usual
        with_knee = [replace(p, extra=_beyond(p.phi - zero, k)) for p in used]
        return fit(equations(with_knee, T, gamma, form))

    without = fit(equations(used, T, gamma, form))
    fits = {share: fitted(share) for share in _SHARES}
    best = min(fits, key=lambda share: _error(fits[share]))
    fits |= {share: fitted(share) for share in best + _FINER}
    best = min(fits, key=lambda share: _error(fits[share]))
    return float(best) * usual if is_worse(without, fits[best]) else math.nan


def _beyond(phi: Array, k: float) -> Array:
    beyond: Array = phi - np.clip(phi, -k, k)
    return beyond


def _error(found: Fit) -> float:
    return float(np.sum(found.squares))


def _first(pieces: Sequence[Signals]) -> list[Signals]:
    """The first pieces without a sensor, up to a number of samples: more show the place no better.

    With the torque of a sensor, the equation has no polynomial.
    """
    used, left = [], _MOST
    for piece in pieces:
        if left > 0:
            used.append(replace(piece, tau_e=None).up_to(left))
            left -= len(piece.theta)
    return used
