"""The deformations at which the slope of the spring changes at once, as in harmonic drives.

The equation of the motor gets a column max(|phi| - k, 0) sign(phi) for each knee k. It is linear in
its coefficients. So the columns of many places are filtered once, and their equations are solved
for every place and every pair of places. Beside them they have the polynomial and the friction by
load of the estimator: without this friction, the places are less exact.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from sigmahat.identification.regression import (
    Equations,
    Fit,
    Form,
    Signals,
    equations,
    extra,
    fit,
    is_worse,
)
from sigmahat.logs.log import Array

_SHARES = np.linspace(0.1, 0.9, 17)  # of the usual deformation: places that are compared
_USUAL = 0.995  # quantile of the deformation that is not rare
_FINER = np.linspace(-0.04, 0.04, 9)  # added to the best ones, for places near them
_APART = 0.1  # least distance of two knees
_LEAST_CHANGE = 0.25  # of the slope at a knee, over that at the other one
_MOST = 100_000  # samples that are used


def knees(
    pieces: Sequence[Signals], T: float, gamma: float, form: Form, zero: float
) -> tuple[float, ...]:
    """Places of up to two knees, from the zero [rad], in increasing order.

    T      time between samples [s]
    gamma  gear ratio
    form   polynomial of the estimator, and filters
    zero   deformation at which the spring has no torque [rad]
    """
    used, form = _first(pieces), replace(form, load_friction=True)
    phi = np.abs(np.concatenate([piece.phi for piece in used]) - zero)
    usual = float(np.quantile(phi, _USUAL))

    def beyond(shares: Array) -> Equations:
        places = shares * usual
        with_knees = [replace(p, extra=_beyond(p.phi - zero, places)) for p in used]
        return equations(with_knees, T, gamma, form)

    coarse = beyond(_SHARES)
    best, found = _least(coarse, _SHARES, 0)
    for number in (1, 2):
        near, _ = _least(coarse, _SHARES, number)
        shares = np.unique(np.add.outer(near, _FINER))
        better, other = _least(beyond(shares), shares, number)
        if not is_worse(found, other) or _is_one_knee(other):
            break
        best, found = better, other
    return tuple((best * usual).tolist())


def _least(e: Equations, shares: Array, number: int) -> tuple[Array, Fit]:
    """So many of the shares with the least error, and the fit with their columns alone."""
    own = e.names[: len(e.names) - len(shares)]

    def fitted(chosen: Sequence[int]) -> tuple[Array, Fit]:
        return shares[list(chosen)], fit(e.only([*own, *map(extra, chosen)]))

    def error(each: tuple[Array, Fit]) -> float:
        found = float(np.sum(each[1].squares))
        return found if math.isfinite(found) else math.inf

    tried = combinations(range(len(shares)), number)
    return min((fitted(c) for c in tried if _are_apart(shares[list(c)])), key=error)


def _are_apart(shares: Array) -> bool:
    return bool(np.all(np.diff(shares) >= _APART))


def _is_one_knee(found: Fit) -> bool:
    """Whether the smaller one of two changes of the slope only corrects the place of the other."""
    changes = [abs(value) for name, value in found.value.items() if name.startswith("extra")]
    return min(changes) < _LEAST_CHANGE * max(changes)


def _beyond(phi: Array, places: Array) -> Array:
    beyond: Array = phi[:, None] - np.clip(phi[:, None], -places, places)
    return beyond


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
