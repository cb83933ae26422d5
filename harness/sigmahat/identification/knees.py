"""The deformations at which the slope of the spring changes at once, as in harmonic drives.

The equation of the motor gets a column max(|phi| - k, 0) sign(phi) for each knee k. It is linear in
its coefficients. So the columns of many places are filtered once, and their equations are solved
for every place and every pair of places. Beside them they have the polynomial and the friction by
load of the estimator: without this friction, the places are less exact.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import product

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


Shares = tuple[float, ...]


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
    best: Shares = ()
    found = _fit(coarse, _SHARES, best)
    for tried in (_each(_SHARES), _pairs(_SHARES, _SHARES)):
        near = [share + _FINER for share in _least(coarse, _SHARES, tried)]
        shares = np.concatenate(near)
        fine = beyond(shares)
        better = _least(fine, shares, _each(shares) if len(near) == 1 else _pairs(*near))
        other = _fit(fine, shares, better)
        if not is_worse(found, other) or _is_one_knee(other):
            break
        best, found = better, other
    return tuple(share * usual for share in best)


def _each(shares: Iterable[float]) -> list[Shares]:
    return [(float(share),) for share in shares]


def _pairs(first: Iterable[float], second: Iterable[float]) -> list[Shares]:
    return [(float(a), float(b)) for a, b in product(first, second) if b - a >= _APART]


def _fit(e: Equations, shares: Array, chosen: Shares) -> Fit:
    """With the columns of some of the shares alone."""
    knees = [extra(int(np.argmin(np.abs(shares - share)))) for share in chosen]
    return fit(e.only([*e.names[: len(e.names) - len(shares)], *knees]))


def _is_one_knee(found: Fit) -> bool:
    """Whether the smaller one of two changes of the slope only corrects the place of the other."""
    changes = [abs(value) for name, value in found.value.items() if name.startswith("extra")]
    return min(changes) < _LEAST_CHANGE * max(changes)


def _least(e: Equations, shares: Array, tried: Sequence[Shares]) -> Shares:
    """The knees with the least error."""

    def error(each: Shares) -> float:
        found = float(np.sum(_fit(e, shares, each).squares))
        return found if math.isfinite(found) else math.inf

    return min(tried, key=error)


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
