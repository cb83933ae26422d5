"""The orders of the polynomial for the flexibility torque, by cross-validation."""

from __future__ import annotations

import math

import numpy as np

from sigmahat.identification.regression import Equations, eta, left_out

Orders = tuple[int, int]
"""n and m of (16), as in rls.n and rls.m."""


def choose(equations: Equations, n_most: int, m_most: int) -> tuple[Orders, Orders]:
    """The orders with the least error on parts that were left out, and the smallest as good ones.

    equations      with all columns up to the orders n_most, m_most

    As good are orders whose error, in the mean over the parts, is not significantly larger (5 %).
    """
    from scipy.special import stdtrit

    others = [name for name in equations.names if name not in eta(n_most, m_most)]
    errors = {
        (n, m): left_out(equations.only([*others, *eta(n, m)]))
        for n in range(1, n_most + 1)
        for m in range(1, m_most + 1)
    }
    best = min(errors, key=lambda each: float(np.mean(errors[each])))

    def as_good(each: Orders) -> bool:
        worse = errors[each] - errors[best]
        limit = float(stdtrit(len(worse) - 1, 0.95))
        return bool(np.mean(worse) <= limit * np.std(worse, ddof=1) / math.sqrt(len(worse)))

    return best, min(filter(as_good, errors), key=lambda each: (each[0] * each[1], each))
