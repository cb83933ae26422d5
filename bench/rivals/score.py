"""How right an estimate of a log and its interval are, and the file of all results."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path

import numpy as np

from rivals.records import Array, Estimate, JointLog
from sigmahat.files.tables import write_csv

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
    """Mean width of the intervals; nan without them, as are coverage and interval score."""
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
    has_intervals = bool(np.isfinite(std).any())
    coverage = np.mean((low <= true) & (true <= high)) if has_intervals else math.nan
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


@dataclass(frozen=True)
class Result:
    """One method on one log."""

    kind: str
    seed: int
    method: str
    seconds: float
    """Wall time; nan if the method failed."""
    score: Score | None
    """None if the method has no estimate."""
    remark: str
    """Why it has none."""


def judge(method: str, estimate: Callable[[JointLog], Estimate], log: JointLog) -> Result:
    """Result of a method on a log. A method that raises an exception has none."""
    result = partial(Result, log.kind, log.seed, method)
    try:
        found = estimate(log)
        return result(found.seconds, score(log, found), "")
    except Exception as error:  # whatever a rival raises is a row of the table
        return result(math.nan, None, f"{type(error).__name__}: {error}")


def write_results(path: Path, results: Sequence[Result]) -> None:
    """Writes a row a result; fields of a score that is not there are empty."""
    scores = [field.name for field in fields(Score)]
    of_result = [field.name for field in fields(Result) if field.name != "score"]
    write_csv(
        path,
        [*of_result, *scores],
        (
            [
                *(getattr(result, name) for name in of_result),
                *(getattr(result.score, name, None) for name in scores),
            ]
            for result in results
        ),
    )
