"""The errors of an estimate of a log and of its intervals, and the table of all results."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

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

Result = dict[str, Any]
"""A method on a joint: seed and method; wall time `seconds` [s]; the scores of `score`."""


def score(log: JointLog, estimate: Estimate) -> dict[str, float]:
    """The score of an estimate [%]: of the true stiffness, or of the instants after SETTLED.

    Root mean square of the error; mean width of the intervals, share of instants whose interval
    holds the truth and mean interval score, nan without intervals; share of instants that are
    confident, and confident with an error above WRONG.

    Instants at which the true stiffness is not positive are left out: the spring is not engaged.
    """
    time = log.sample_period * np.arange(len(log.stiffness))
    judged = (time >= SETTLED) & (log.stiffness > 0)
    confident = estimate.confident[judged]
    true, found, std = (a[judged] for a in (log.stiffness, estimate.stiffness, estimate.std))
    error = np.abs(found / true - 1)
    low, high = found - QUANTILE * std, found + QUANTILE * std
    holds = np.mean((low <= true) & (true <= high)) if np.isfinite(std).any() else math.nan
    shares = {
        "error": np.sqrt(np.mean(error**2)),
        "width": np.mean((high - low) / true),
        "coverage": holds,
        "interval_score": np.mean(winkler(true, low, high) / true),
        "confident": np.mean(confident),
        "wrong": np.mean(confident & (error > WRONG)),
    }
    return {name: 100 * float(share) for name, share in shares.items()}


def winkler(true: Array, low: Array, high: Array) -> Array:
    """The interval score: the width, and 2/(1 - INTERVAL) times what the truth is outside.

    R. L. Winkler, "A decision-theoretic approach to interval estimation", J. American Statistical
    Association 67(337):187-191, 1972; T. Gneiting and A. E. Raftery, same journal
    102(477):359-378, 2007, (43). Smaller is better.
    """
    outside = np.maximum(low - true, 0.0) + np.maximum(true - high, 0.0)
    return high - low + 2 / (1 - INTERVAL) * outside


COLUMNS: dict[str, tuple[str, Callable[[list[float]], Any]]] = {
    "error": ("error %", np.median),
    "width": ("interval width %", np.median),
    "coverage": ("coverage %", np.mean),
    "interval_score": ("interval score %", np.median),
    "lowest": ("lowest score %", np.mean),
    "seconds": ("time s", np.median),
    "confident": ("confident %", np.mean),
    "wrong": ("confident and wrong %", np.mean),
}
"""Title and mean of each number in the table."""


def page(results: Sequence[Result]) -> str:
    """The table as Markdown: a row for each method."""
    titles = ["method", *(title for title, _ in COLUMNS.values())]
    rows = [titles, ["---"] * len(titles)]
    lowest = _lowest(results)
    for method in dict.fromkeys(result["method"] for result in results):
        own = [
            {**result, "lowest": 100.0 * (lowest[result["seed"]] == method)}
            for result in results
            if result["method"] == method
        ]
        means = [mean([each[name] for each in own]) for name, (_, mean) in COLUMNS.items()]
        rows.append([method, *("-" if math.isnan(x) else f"{x:.3g}" for x in means)])
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


def _lowest(results: Sequence[Result]) -> dict[int, str]:
    """The method with the lowest interval score, by seed."""
    scored = [r for r in results if not math.isnan(r["interval_score"])]
    scored.sort(key=lambda r: r["interval_score"], reverse=True)
    return {r["seed"]: r["method"] for r in scored}  # the last one stays
