"""The runs of a sweep that are done, on disk: one line for each, so that a sweep can go on later.

A line is JSON. The first says which sweep it is. If the sweep gets more seeds later, another such
line is appended, and the numbers of the runs behind it are those of the larger plan.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import astuple, replace
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from sigmahat.files.output import created_folder
from sigmahat.runs.metrics import Indices
from sigmahat.sweep.plan import Outcome, Plan
from sigmahat.sweep.preparation import sweep_digest

NAME = "runs.jsonl"


class Records:
    """The outcomes of a sweep so far, by the number of the run."""

    def __init__(self, path: Path, plan: Plan) -> None:
        """Reads the file if it exists.

        Raises ValueError, which says where and what to do, if it is damaged or of another sweep.
        """
        self.path = path
        self.outcomes: dict[int, Outcome] = {}
        self._plan = plan
        lines = path.read_bytes().splitlines(keepends=True) if path.exists() else []
        if lines and not lines[-1].endswith(b"\n"):
            lines.pop()  # what a kill cut off; that run is done again
        self._seeds = 0  # of the last line that says which sweep it is
        for i, line in enumerate(lines, 1):
            content = self._parse(line, i)
            if i == 1 or "sweep" in content:
                self._seeds = self._seeds_of(content)
            else:
                self._take(content, i)
        self._file = path.open("ab")
        self._file.truncate(sum(map(len, lines)))

    def add(self, outcome: Outcome) -> None:
        """Writes an outcome, which a process that is killed later does not lose."""
        if self._seeds != self._plan.seeds:  # before the first of the runs that are new
            self._seeds = self._plan.seeds
            self._write(_head(self._plan))
        self.outcomes[outcome.number] = outcome
        indices = {name: astuple(each) for name, each in outcome.indices.items()}
        self._write({"number": outcome.number, "indices": indices, "failure": outcome.failure})

    def close(self) -> None:
        """Closes the file."""
        self._file.close()

    def _write(self, content: dict[str, Any]) -> None:
        self._file.write(json.dumps(content).encode() + b"\n")
        self._file.flush()

    def _parse(self, line: bytes, number: int) -> Any:
        try:
            return json.loads(line)
        except ValueError as error:
            what = "delete this file" if number == 1 else "delete this line"
            raise ValueError(
                f"{self.path}, line {number}: damaged; {what} and start again"
            ) from error

    def _seeds_of(self, head: Any) -> int:
        """How many seeds the records behind this line are of."""
        plan, hint = self._plan, "choose another folder with --out, or delete this file"
        seeds = int(head.get("runs", 0)) * plan.seeds // len(plan)
        if seeds < 1 or head != _head(replace(plan, seeds=seeds)):
            raise ValueError(f"{self.path} is of another sweep, or of other FMUs; {hint}")
        if seeds > plan.seeds:
            raise ValueError(
                f"{self.path} is of this sweep with {seeds} seeds; "
                f"expected as many or more, got {plan.seeds}; {hint}"
            )
        return seeds

    def _take(self, content: Any, line: int) -> None:
        number = content["number"]
        setting, seed = divmod(number, self._seeds)
        numbered = setting * self._plan.seeds + seed
        if numbered in self.outcomes or not 0 <= numbered < len(self._plan):
            raise ValueError(
                f"{self.path}, line {line}: run {number} is there twice; "
                "delete this line and start again"
            )
        indices = {name: Indices(*values) for name, values in content["indices"].items()}
        self.outcomes[numbered] = Outcome(numbered, indices, content["failure"])


def _head(plan: Plan) -> dict[str, Any]:
    """Says which sweep records are of."""
    return {"sweep": sweep_digest(plan), "runs": len(plan)}


@contextmanager
def records(folder: Path, plan: Plan) -> Iterator[Records]:
    """The records of a sweep in a folder, for one process at a time. Raises as Records does."""
    lock = folder / f".{NAME}.lock"
    with created_folder(folder, ignored=lock.name):
        try:
            with FileLock(lock, timeout=0):
                opened = Records(folder / NAME, plan)
                try:
                    yield opened
                finally:
                    opened.close()
                    if not opened.outcomes:
                        opened.path.unlink()
        except Timeout as error:
            raise ValueError(f"another sweep is writing to {folder}; wait for it") from error
