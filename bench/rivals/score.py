"""How right an estimate of a log is, and how right what it says of itself."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rivals.records import Array, Estimate, JointLog

SETTLED = 2.0
"""An estimate is judged from this time on [s]."""
INTERVAL = 0.95
"""Probability of the intervals."""
QUANTILE = 1.96
"""The interval is the estimate and this many standard deviations to both sides."""
WRONG = 0.2
"""Relative error above which a confident estimate is wrong."""


@dataclass(frozen=True)
class Score:
    """All in percent: of the true stiffness, or of the instants after SETTLED."""

    error: float
    """Root mean square."""
    width: float
    """Mean width of the intervals; nan without a claim, as are coverage and interval score."""
    coverage: float
    """Share of instants whose interval holds the truth."""
    interval_score: float
    """Mean interval score of Winkler."""
    confident: float
    """Share of instants that are confident."""
    wrong: float
    """Share of instants that are confident with an error above WRONG."""


def score(log: JointLog, estimate: Estimate) -> Score:
    """The score of an estimate.

    Instants at which the true stiffness is not positive are left out: the spring is not engaged.
    Raises ValueError if none is left, or if the estimate is not finite at one of them.
    """
    time = log.sample_period * np.arange(len(log.stiffness))
    judged = (time >= SETTLED) & (log.stiffness > 0)
    if not judged.any():
        raise ValueError(f"the log has no stiffness after {SETTLED:g} s")
    confident = estimate.confident[judged]
    true, found, std = (a[judged] for a in (log.stiffness, estimate.stiffness, estimate.std))
    if not np.isfinite(found).all():
        raise ValueError(f"not finite at {np.count_nonzero(~np.isfinite(found))} instants")
    error = np.abs(found / true - 1)
    low, high = found - QUANTILE * std, found + QUANTILE * std
    claims = bool(np.isfinite(std).any())
    coverage = np.mean((low <= true) & (true <= high)) if claims else math.nan
    return Score(
        error=100 * float(np.sqrt(np.mean(error**2))),
        width=100 * float(np.mean((high - low) / true)),
        coverage=100 * float(coverage),
        interval_score=100 * float(np.mean(winkler(true, low, high) / true)),
        confident=100 * float(np.mean(confident)),
        wrong=100 * float(np.mean(confident & (error > WRONG))),
    )


def winkler(true: Array, low: Array, high: Array) -> Array:
    """The interval score: the width, and 2/(1 - INTERVAL) times what the truth is outside.

    R. L. Winkler, "A decision-theoretic approach to interval estimation", J. American Statistical
    Association 67(337):187-191, 1972; T. Gneiting and A. E. Raftery, same journal
    102(477):359-378, 2007, (43). Smaller is better.
    """
    outside = np.maximum(low - true, 0.0) + np.maximum(true - high, 0.0)
    return high - low + 2 / (1 - INTERVAL) * outside
