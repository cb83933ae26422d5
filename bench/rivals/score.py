"""Scores of an estimate of a log and its interval, and the table of all results."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from rivals.records import Array, Estimate, JointLog

SETTLED = 2.0  # an estimate is judged from this time on [s]
INTERVAL = 0.95  # probability of the intervals
QUANTILE = 1.96  # the interval is the estimate and this many standard deviations to both sides
WRONG = 0.2  # relative error above which a confident estimate is wrong
SCORES = ("error", "width", "coverage", "interval_score", "confident", "wrong")
RESULT = ("kind", "seed", "method", "seconds", "remark", *SCORES)
"""Names of the values in the result of a method for a log."""
HEAD = (
    *("joint", "method", "estimates", "error %", "interval width %", "coverage %"),
    *("interval score %", "lowest score %", "time s", "confident %", "confident and wrong %"),
)

Result = dict[str, Any]
"""Values by the names in RESULT: kind, seed, method, wall time [s], and the reason of a failure, or
SCORES. The wall time of a failed method is nan."""


def score(log: JointLog, estimate: Estimate) -> dict[str, float]:
    """The score of an estimate [%]: of the true stiffness, or of the instants after SETTLED.

    RMS of the error; mean width, coverage and mean score of the intervals, nan without intervals;
    share of instants that are confident, and confident with an error above WRONG.

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
    holds = np.mean((low <= true) & (true <= high)) if np.isfinite(std).any() else math.nan
    values = (
        *(np.sqrt(np.mean(error**2)), np.mean((high - low) / true), holds),
        *(np.mean(winkler(true, low, high) / true), np.mean(confident)),
        np.mean(confident & (error > WRONG)),
    )
    return {name: 100 * float(value) for name, value in zip(SCORES, values, strict=True)}


def winkler(true: Array, low: Array, high: Array) -> Array:
    """The interval score: the width, and 2/(1 - INTERVAL) times what the truth is outside.

    R. L. Winkler, "A decision-theoretic approach to interval estimation", J. American Statistical
    Association 67(337):187-191, 1972; T. Gneiting and A. E. Raftery, same journal
    102(477):359-378, 2007, (43). Smaller is better.
    """
    outside = np.maximum(low - true, 0.0) + np.maximum(true - high, 0.0)
    return high - low + 2 / (1 - INTERVAL) * outside


def judge(method: str, estimate: Callable[[JointLog], Estimate], log: JointLog) -> Result:
    """Result of a method on a log. A method that raises an exception has no score."""
    result = {"kind": log.kind, "seed": log.seed, "method": method}
    try:
        found = estimate(log)
        return {**result, "seconds": found.seconds, "remark": "", **score(log, found)}
    except Exception as error:  # whatever a rival raises is a row of the table
        return {**result, "seconds": math.nan, "remark": f"{type(error).__name__}: {error}"}


def page(results: Sequence[Result]) -> str:
    """Formats the results as Markdown, with a row for each kind of joint and method."""
    lines = [
        "Error (root mean square), interval width, interval score and time are medians over the "
        "logs, the others means. The interval is that of 95 %. *Lowest score*: the share of the "
        "logs on which the interval score of this method is the lowest. `rivals.csv` has every "
        "log, and why an estimate is missing.",
        "",
        *("| " + " | ".join(cells) + " |" for cells in (HEAD, ["---"] * len(HEAD))),
    ]
    for kind, method in dict.fromkeys((r["kind"], r["method"]) for r in results):
        cells = _cells([r for r in results if r["kind"] == kind], method)
        lines.append(f"| {kind} | {method} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _cells(results: Sequence[Result], method: str) -> list[str]:
    """Computes the cells of a method, from the results of all methods on one kind of joint."""
    own = [r for r in results if r["method"] == method]
    scored = [r for r in own if "error" in r]

    def cell(name: str, over: str, digits: int = 3) -> str:
        values = [r[name] for r in scored if not math.isnan(r[name])]
        return f"{getattr(np, over)(values):.{digits}g}" if values else "-"

    lowest = 100 * list(best(results).values()).count(method) / len(own)
    return [
        f"{len(scored)} of {len(own)}",
        *(cell("error", "median"), cell("width", "median"), cell("coverage", "mean")),
        *(cell("interval_score", "median"), f"{lowest:.3g}", cell("seconds", "median", 2)),
        *(cell("confident", "mean"), cell("wrong", "mean")),
    ]


def best(results: Sequence[Result]) -> dict[tuple[str, int], str]:
    """Finds the method with the lowest interval score, by kind and seed."""
    scored = [r for r in results if not math.isnan(r.get("interval_score", math.nan))]
    scored.sort(key=lambda r: (r["interval_score"], r["method"]), reverse=True)
    return {(r["kind"], r["seed"]): r["method"] for r in scored}  # the last one stays
