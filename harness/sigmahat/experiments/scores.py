"""The score of an estimate of the stiffness with its uncertainty, by any method."""

from __future__ import annotations

import math
from dataclasses import asdict, astuple, dataclass
from operator import add

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SETTLED = 2.0  # time after the start of the torque from which an estimate is judged [s]
INTERVAL = 0.95  # probability of the intervals
QUANTILE = 1.96  # the interval is the estimate and this many standard deviations to both sides
WRONG = 0.2  # error above which a confident estimate is wrong [1]
DANGEROUS_ERROR, DANGEROUS_CLAIM = 0.1, 0.02
"""Limits of a dangerous instant: error above, and standard deviation / estimate below [1]."""
_LARGEST = 10.0  # upper limit of a relative error or of a relative standard deviation


@dataclass(frozen=True)
class Score:
    """Sums over instants, so that scores of several logs can be added.

    Errors, claims (standard deviations) and intervals are relative to the true stiffness.
    """

    instants: float = 0
    error: float = 0.0  # squares of the error [1]
    claim: float = 0.0  # squares of the standard deviation [1]
    width: float = 0.0  # of the 95 % intervals [1]
    coverage: float = 0.0  # instants with the truth in the interval
    interval_score: float = 0.0  # scores of the intervals by winkler() [1]
    dangerous: float = 0  # instants
    confident: float = 0  # instants
    wrong: float = 0  # instants that are confident, with an error above WRONG

    def __add__(self, other: Score) -> Score:
        return Score(*map(add, astuple(self), astuple(other)))

    @property
    def figures(self) -> dict[str, float]:
        """RMS of error and claim; means of width and interval score; percentages of instants with
        the truth in the interval, and of dangerous, confident, and confident and wrong instants.

        All in %, nan without instants; the figures of the interval are nan without intervals.
        """
        sums = asdict(self)
        instants = sums.pop("instants") or math.nan
        means = {name: total / instants for name, total in sums.items()}
        for name in ("error", "claim"):
            means[name] = math.sqrt(means[name])
        return {name: 100 * mean for name, mean in means.items()}


FIGURES = tuple(Score().figures)
"""Names of the numbers of a score [%]."""


def score(
    true: Array,
    stiffness: Array,
    confident: NDArray[np.bool_],
    std: Array | None = None,
    interval: tuple[Array, Array] | None = None,
) -> Score:
    """The score of an estimate at the instants that are judged.

    true       true stiffness [N.m/rad]; instants at which it is not positive are left out, because
               the spring is in its dead zone
    stiffness  estimate [N.m/rad]
    confident  whether the method trusts its estimate
    std        standard deviation of the estimate [N.m/rad], for an interval of 1.96 of them to both
               sides; nan or None: the method gives none
    interval   lower and upper ends of the 95 % interval [N.m/rad], instead of std

    All arrays have the shape (N,). Raises ValueError if the estimate is not finite at an instant.
    """
    engaged = true > 0
    true, stiffness, confident = true[engaged], stiffness[engaged], confident[engaged]
    if not np.isfinite(stiffness).all():
        raise ValueError(f"not finite at {np.count_nonzero(~np.isfinite(stiffness))} instants")
    if interval is not None:
        low, high = interval[0][engaged], interval[1][engaged]
        std = (high - low) / (2 * QUANTILE)
        inside = (low <= true) & (true <= high)
    else:
        std = np.full(len(true), np.nan) if std is None else std[engaged]
        low, high = stiffness - QUANTILE * std, stiffness + QUANTILE * std
        inside = np.abs(stiffness - true) <= QUANTILE * std
    error = np.abs(stiffness / true - 1)
    dangerous = (error > DANGEROUS_ERROR) & (std < DANGEROUS_CLAIM * np.abs(stiffness))
    has_intervals = len(std) == 0 or bool(np.isfinite(std).any())
    return Score(
        instants=len(true),
        error=float(np.sum(np.minimum(error, _LARGEST) ** 2)),
        claim=float(np.sum(np.minimum(std / true, _LARGEST) ** 2)),
        width=float(np.sum((high - low) / true)),
        coverage=float(np.sum(inside)) if has_intervals else math.nan,
        interval_score=float(np.sum(winkler(true, low, high) / true)),
        dangerous=int(np.sum(dangerous)),
        confident=int(np.sum(confident)),
        wrong=int(np.sum(confident & (error > WRONG))),
    )


def winkler(true: Array, low: Array, high: Array) -> Array:
    """The interval score: the width, and 2/(1 - INTERVAL) times what the truth is outside.

    R. L. Winkler, "A decision-theoretic approach to interval estimation", J. American Statistical
    Association 67(337):187-191, 1972; T. Gneiting and A. E. Raftery, same journal
    102(477):359-378, 2007, (43). Smaller is better.
    """
    outside = np.maximum(low - true, 0.0) + np.maximum(true - high, 0.0)
    return high - low + 2 / (1 - INTERVAL) * outside
