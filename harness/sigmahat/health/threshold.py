"""The limit of |z| for a rate of false alarms."""

import math

from scipy.optimize import brentq

LOGS_A_YEAR = 365  # of one log a day
START = 1e-3  # false alarms in a year of daily logs of a joint, all quantities together
FIT = (-3.025, 2.199)
"""Level and power of z in ln(false alarms per log of a quantity), from 12 000 series of 365 normal
results, each looked at after every log: bench/health/false_alarms.py."""
_RANGE = (2.5, 12.0)  # limits of |z| within which the fit is used


def false_alarms(z: float) -> float:
    """Returns the rate of false alarms per log of one quantity with the limit z of |z|."""
    level, power = FIT
    return math.exp(level + power * math.log(z) - z**2 / 2)


def limit(rate: float, quantities: int) -> float:
    """Returns the limit of |z| with which a joint has this rate of false alarms.

    rate        false alarms in LOGS_A_YEAR logs of a joint [1], > 0
    quantities  that are looked at, >= 1: each may have its share of the false alarms
    """
    wanted = rate / LOGS_A_YEAR / max(quantities, 1)
    low, high = _RANGE
    if wanted >= false_alarms(low):
        return low
    if wanted <= false_alarms(high):
        return high
    return float(brentq(lambda z: math.log(false_alarms(z) / wanted), low, high))
