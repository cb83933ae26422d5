"""Columns of time, their units, and the time between rows."""

from __future__ import annotations

import numpy as np

from sigmahat.guessing.facts import Facts
from sigmahat.guessing.words import Meaning
from sigmahat.logs.log import Array
from sigmahat.logs.units import seconds

_MOSTLY = 0.99  # share of the steps of a clock that go up
_EVEN = 0.05  # largest distance of a step from the usual one, relative
_MISSING = 1.8  # usual steps: a longer one holds rows that are lost
_GAP = 3.0  # usual steps: a longer one is a gap
_EPOCH = {"ns": 1e17, "us": 1e14, "ms": 1e11, "s": 1e8}  # from about 1973 on
_FASTEST, _SLOWEST = 2e-5, 0.2  # usual time between rows of a log [s]


def is_clock(meaning: Meaning, facts: Facts, values: Array) -> bool:
    """Whether a column holds times, by its name, or because it goes up by even steps."""
    if facts.text or not facts.varies or facts.increasing < _MOSTLY or facts.wrap is not None:
        return False
    if meaning.quantity is not None:
        return meaning.quantity == "time"
    steps = np.diff(values[np.isfinite(values)])
    return bool(np.mean(np.abs(steps / np.median(steps) - 1) < _EVEN) > 0.9)


def unit_of(meaning: Meaning, facts: Facts, values: Array) -> str:
    """Unit of a column of times: as its name says, else by its size and its steps."""
    if meaning.unit in _EPOCH:
        return str(meaning.unit)
    for unit, least in _EPOCH.items():
        if facts.low > least:
            return unit
    steps = np.diff(values[np.isfinite(values)])
    step = float(np.median(steps)) if len(steps) else 1e-3
    if facts.integer and step >= 1:  # a computer counts in units that are finer than its steps
        return "ms" if step < 100 else "us" if step < 50_000 else "ns"
    for unit in ("s", "ms", "us", "ns"):
        if _FASTEST <= step * seconds(unit) <= _SLOWEST:
            return unit
    return "s"


def interval(times: Array) -> float:
    """Usual time between rows [s], from times in s: without gaps, rounding of the times and jitter.

    1e-3 if there are no two times.
    """
    steps = np.diff(times[np.isfinite(times)])
    steps = steps[steps > 0]
    if not len(steps):
        return 1e-3
    usual = float(np.median(steps))
    near = steps[np.abs(steps / usual - 1) < _EVEN]
    if len(near) > 0.9 * len(steps):
        return float(f"{near.mean():.6g}")
    if _is_coarse(steps, usual):
        return float(f"{steps[steps < _GAP * usual].mean():.4g}")
    steps = steps[steps < _GAP * usual]
    rows = np.where(steps > _MISSING * usual, np.round(steps / usual), 1)
    return _round(float(steps.sum() / rows.sum()))


def _is_coarse(steps: Array, usual: float) -> bool:
    """Whether the times are those of an even clock, rounded: 1, 2, 1, 2 ms for 1.5 ms.

    Then they never are off by more than their resolution, while every row that is lost adds up.
    """
    gaps = np.flatnonzero(steps >= _GAP * usual)
    edges = np.r_[-1, gaps, len(steps)]
    longest = int(np.argmax(np.diff(edges)))
    whole = steps[edges[longest] + 1 : edges[longest + 1]]
    if len(whole) < 8 or len(np.unique(np.round(whole / usual, 3))) > 3:
        return False
    times = np.cumsum(whole)
    off = times - np.polyval(np.polyfit(np.arange(len(times)), times, 1), np.arange(len(times)))
    return bool(np.abs(off).max() < whole.min())


def _round(T: float) -> float:
    """The round number that a clock with jitter was set to, if there is one within 1 %."""
    short = float(f"{T:.2g}")
    rate = 1 / float(f"{1 / T:.2g}")
    best = min((short, rate), key=lambda each: abs(each / T - 1))
    return float(f"{best if abs(best / T - 1) < 0.01 else T:.6g}")
