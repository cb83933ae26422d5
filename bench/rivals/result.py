"""What a method made of a log, as it is written to a file."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path

from rivals.records import Estimate, JointLog
from rivals.score import Score, score
from sigmahat.files.tables import write_csv


@dataclass(frozen=True)
class Result:
    """One method on one log."""

    kind: str
    engine: str
    seed: int
    method: str
    seconds: float
    """Wall time; nan if the method failed."""
    score: Score | None
    """None if the method has no answer."""
    remark: str
    """Why it has none."""


def judge(method: str, estimate: Callable[[JointLog], Estimate], log: JointLog) -> Result:
    """Result of a method on a log. A method that raises an exception has no answer."""
    result = partial(Result, log.kind, log.engine, log.seed, method)
    try:
        found = estimate(log)
        if found.remark:
            return result(found.seconds, None, found.remark)
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
