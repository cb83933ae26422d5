"""The tables of a comparison as Markdown, from records."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeVar

import numpy as np

from rivals.score import Result, Score

LABELS = {
    "least_squares": "least squares (IDIM-LS)",
    "idim_iv": "IDIM-IV",
    "kalman": "extended Kalman filter",
}
KINDS = {
    "series_elastic": "Series elastic joint",
    "variable_stiffness": "Variable-stiffness pair",
    "arm": "Arm under gravity with contact",
}
_T = TypeVar("_T")
_HEAD = (
    "method",
    "estimates",
    "error %",
    "interval width %",
    "coverage %",
    "interval score %",
    "lowest score",
    "time s",
    "confident %",
    "confident and wrong %",
)


def page(results: Sequence[Result]) -> str:
    """All tables: each kind of joint, what was confident and wrong, and what has no estimate."""
    parts = [
        "Error (root mean square), interval width, interval score and time are medians over the "
        "logs, the others means. The interval is that of 95 %. *Lowest score*: the share of the "
        "logs on which the interval score of this method is the lowest."
    ]
    for kind in _unique(r.kind for r in results):
        parts += [f"### {KINDS[kind]}", _joint([r for r in results if r.kind == kind])]
    parts += ["### Confident and over 20 % wrong", _wrong(results)]
    parts += ["### No estimate", _without_estimate(results)]
    return "\n\n".join(parts) + "\n"


def best(results: Sequence[Result]) -> dict[tuple[str, int], str]:
    """The method with the lowest interval score, by kind and seed."""
    found: dict[tuple[str, int], tuple[float, str]] = {}
    for result in results:
        if result.score is None or math.isnan(result.score.interval_score):
            continue
        log = (result.kind, result.seed)
        candidate = (result.score.interval_score, result.method)
        found[log] = min(found.get(log, candidate), candidate)
    return {log: method for log, (_, method) in found.items()}


def _joint(results: Sequence[Result]) -> str:
    """The table of one kind of joint."""
    lowest = list(best(results).values())
    logs = len({r.seed for r in results})
    rows = []
    for method in _unique(r.method for r in results):
        own = [r for r in results if r.method == method]
        scores = [r.score for r in own if r.score is not None]
        rows.append(
            [
                LABELS.get(method, method),
                f"{len(scores)} of {len(own)}",
                *(_figure(scores, name, np.median) for name in ("error", "width")),
                _figure(scores, "coverage", np.mean, 0),
                _figure(scores, "interval_score", np.median),
                f"{100 * lowest.count(method) / logs:.0f} %",
                _number(float(np.median([r.seconds for r in own if r.score] or [math.nan]))),
                _figure(scores, "confident", np.mean, 0),
                _figure(scores, "wrong", np.mean, 1),
            ]
        )
    return _markdown(_HEAD, rows)


def _wrong(results: Sequence[Result]) -> str:
    rows = [
        [
            *(r.kind, str(r.seed), LABELS.get(r.method, r.method)),
            *(f"{r.score.wrong:.1f}", _number(r.score.error), _number(r.score.width)),
        ]
        for r in results
        if r.score is not None and r.score.wrong > 0
    ]
    return _markdown(
        ("joint", "seed", "method", "of the time %", "error %", "interval width %"), rows
    )


def _without_estimate(results: Sequence[Result]) -> str:
    """One row for each method and reason, with the logs."""
    reasons: dict[tuple[str, str, str], list[int]] = {}
    for r in results:
        if r.score is None:
            reasons.setdefault((r.method, r.kind, r.remark), []).append(r.seed)
    rows = [
        [LABELS.get(method, method), kind, ", ".join(map(str, seeds)), remark]
        for (method, kind, remark), seeds in reasons.items()
    ]
    return _markdown(("method", "joint", "seeds", "reason"), rows)


def _figure(
    scores: Sequence[Score],
    name: str,
    over: Callable[[list[float]], Any],
    digits: int | None = None,
) -> str:
    values = [getattr(score, name) for score in scores if not math.isnan(getattr(score, name))]
    if not values:
        return "-"
    value = float(over(values))
    return _number(value) if digits is None else f"{value:.{digits}f}"


def _number(value: float) -> str:
    """Two digits, or all before the point."""
    if math.isnan(value):
        return "-"
    if abs(value) >= 1e4 or value == 0:
        return f"{value:.2g}"
    digits = max(1 - math.floor(math.log10(abs(value))), 0)
    return f"{value:.{digits}f}"


def _unique(values: Iterable[_T]) -> list[_T]:
    return list(dict.fromkeys(values))


def _markdown(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    if not rows:
        return "None."
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)
