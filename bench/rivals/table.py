"""The table of a comparison as Markdown, from records."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from rivals.score import Result

HEAD = (
    *("joint", "method", "estimates", "error %", "interval width %", "coverage %"),
    *("interval score %", "lowest score %", "time s", "confident %", "confident and wrong %"),
)


def page(results: Sequence[Result]) -> str:
    """A row for each kind of joint and method."""
    lines = [
        "Error (root mean square), interval width, interval score and time are medians over the "
        "logs, the others means. The interval is that of 95 %. *Lowest score*: the share of the "
        "logs on which the interval score of this method is the lowest. `rivals.csv` has every "
        "log, and why an estimate is missing.",
        "",
        *("| " + " | ".join(cells) + " |" for cells in (HEAD, ["---"] * len(HEAD))),
    ]
    for kind, method in dict.fromkeys((r.kind, r.method) for r in results):
        cells = row([r for r in results if r.kind == kind], method)
        lines.append(f"| {kind} | {method} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def row(results: Sequence[Result], method: str) -> list[str]:
    """The cells of a method, from the results of all methods on one kind of joint."""
    own = [r for r in results if r.method == method]
    scores = [r.score for r in own if r.score is not None]

    def cell(name: str, over: str) -> str:
        values = [getattr(each, name) for each in scores]
        values = [value for value in values if not math.isnan(value)]
        return f"{getattr(np, over)(values):.3g}" if values else "-"

    seconds = [r.seconds for r in own if r.score is not None]
    lowest = 100 * list(best(results).values()).count(method) / len(own)
    return [
        f"{len(scores)} of {len(own)}",
        *(cell("error", "median"), cell("width", "median"), cell("coverage", "mean")),
        *(cell("interval_score", "median"), f"{lowest:.3g}"),
        f"{np.median(seconds):.2g}" if seconds else "-",
        *(cell("confident", "mean"), cell("wrong", "mean")),
    ]


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
