"""The plan of the rivals: all methods on each joint, and the table of all results."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

from rivals.methods import METHODS, Method
from rivals.records import JointLog
from rivals.simulation import make
from sigmahat.experiments.job import Job, Outcome
from sigmahat.files.tables import write_csv
from sigmahat.show.panel import FigureRows

SCORES = ("error", "width", "coverage", "interval_score", "confident", "wrong")
"""Numbers of a score in the results [%]."""
RESULT = ("kind", "seed", "method", "seconds", "remark", *SCORES)
"""Names of the values in the result of a method for a log."""
HEAD = (
    *("joint", "method", "estimates", "error %", "interval width %", "coverage %"),
    *("interval score %", "lowest score %", "time s", "confident %", "confident and wrong %"),
)

Result = dict[str, Any]
"""Values by the names in RESULT: kind, seed, method, wall time [s], and the reason of a failure, or
SCORES. The wall time of a failed method is nan."""


def judged(log: JointLog, methods: Mapping[str, Method]) -> Outcome:
    """Runs methods on a log: a row of numbers for each. A method that raises has a failure."""
    rows: dict[str, dict[str, float]] = {}
    failures: dict[str, str] = {}
    for name, estimate in methods.items():
        try:
            estimated = estimate(log)
            figures = estimated.score(log).figures
        except Exception as error:  # whatever a rival raises is a row of the table
            failures[name] = f"{type(error).__name__}: {error}"
        else:
            scores = {score: figures[score] for score in SCORES}
            rows[name] = {"seconds": estimated.seconds, **scores}
    return Outcome(rows, failures)


def judged_joint(kind: str, seed: int, methods: Sequence[str]) -> Outcome:
    """Does one run of the plan: simulates a joint, and runs the methods of these names."""
    return judged(make(kind, seed), {name: METHODS[name] for name in methods})


@dataclass(frozen=True)
class Rivals:
    """The plan: each kind of joint with each seed, by all methods."""

    kinds: Sequence[str]
    seeds: Sequence[int]
    methods: Sequence[str]

    name = "rivals"

    @cached_property
    def jobs(self) -> list[Job]:
        return [
            Job(
                partial(judged_joint, kind, seed, self.methods),
                fmus=("StiffnessEstimator",),
                about=(kind, seed, self.methods),
            )
            for kind, seed in self._joints
        ]

    @property
    def _joints(self) -> list[tuple[str, int]]:
        return [(kind, seed) for kind in self.kinds for seed in self.seeds]

    def table(self, outcomes: Sequence[Outcome]) -> list[Result]:
        results: list[Result] = []
        for (kind, seed), outcome in zip(self._joints, outcomes, strict=True):
            for method in self.methods:
                about = {"kind": kind, "seed": seed, "method": method}
                remark = outcome.failures.get(method, "")
                numbers = outcome.rows.get(method, {"seconds": math.nan})
                results.append({**about, "remark": remark, **numbers})
        return results

    def write(self, table: Sequence[Result], folder: Path) -> None:
        rows = ([result.get(name) for name in RESULT] for result in table)
        write_csv(folder / "rivals.csv", RESULT, rows)
        (folder / "rivals.md").write_text(page(table), encoding="utf-8")

    def figures(self, _table: Sequence[Result]) -> dict[str, FigureRows]:
        return {}

    def text(self, table: Sequence[Result]) -> str:
        return page(table)

    def values(self, table: Sequence[Result]) -> object:
        return {"units": {"seconds": "s", **dict.fromkeys(SCORES, "%")}, "table": table}


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
    of_method = [r for r in results if r["method"] == method]
    scored = [r for r in of_method if "error" in r]

    def cell(name: str, over: str, digits: int = 3) -> str:
        values = [r[name] for r in scored if not math.isnan(r[name])]
        return f"{getattr(np, over)(values):.{digits}g}" if values else "-"

    lowest = 100 * list(best(results).values()).count(method) / len(of_method)
    return [
        f"{len(scored)} of {len(of_method)}",
        *(cell("error", "median"), cell("width", "median"), cell("coverage", "mean")),
        *(cell("interval_score", "median"), f"{lowest:.3g}", cell("seconds", "median", 2)),
        *(cell("confident", "mean"), cell("wrong", "mean")),
    ]


def best(results: Sequence[Result]) -> dict[tuple[str, int], str]:
    """Finds the method with the lowest interval score, by kind and seed."""
    scored = [r for r in results if not math.isnan(r.get("interval_score", math.nan))]
    scored.sort(key=lambda r: (r["interval_score"], r["method"]), reverse=True)
    return {(r["kind"], r["seed"]): r["method"] for r in scored}  # the last one stays
