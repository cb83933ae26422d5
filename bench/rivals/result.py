"""What a method made of a log, as it is written to a file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path

from rivals.score import Score
from sigmahat.files.csv_table import write_csv


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
