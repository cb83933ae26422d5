"""The runs of a sweep that are done, on disk: one line for each, so that a sweep can go on later.

A line is JSON. The first says which sweep it is, with however many seeds. A run is named by its
setting, the place of scenario and listed values in the plan, and by its seed: so a sweep that gets
more seeds later goes on in the same file.
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
_HINT = "choose another folder with --out, or delete this file"


class Records:
    """The outcomes of a sweep so far, by the number of the run."""

    def __init__(self, path: Path, plan: Plan) -> None:
        """Reads the file if it exists.

        Raises ValueError, which says where and what to do, if it is damaged or of another sweep.
        """
        self.path = path
        self.outcomes: dict[int, Outcome] = {}
        self._seeds = plan.seeds
        lines = path.read_bytes().splitlines(keepends=True) if path.exists() else []
        if lines and not lines[-1].endswith(b"\n"):
            lines.pop()  # what a kill cut off; that run is done again
        head = {"sweep": sweep_digest(replace(plan, seeds=1))}
        contents = [self._parse(line, i) for i, line in enumerate(lines, 1)]
        if contents and contents[0] != head:
            raise ValueError(f"{path} is of another sweep, or of other FMUs; {_HINT}")
        seeds = max((each["seed"] for each in contents[1:]), default=0)
        if seeds > plan.seeds:
            raise ValueError(
                f"{path} is of this sweep with {seeds} seeds; "
                f"expected as many or more, got {plan.seeds}; {_HINT}"
            )
        for i, each in enumerate(contents[1:], 2):
            number = each["setting"] * plan.seeds + each["seed"] - 1
            if number in self.outcomes or not 0 <= number < len(plan):
                raise ValueError(
                    f"{path}, line {i}: run of setting {each['setting']}, seed {each['seed']} is "
                    "there twice; delete this line and start again"
                )
            indices = {name: Indices(*values) for name, values in each["indices"].items()}
            self.outcomes[number] = Outcome(number, indices, each["failure"])
        self._file = path.open("ab")
        self._file.truncate(sum(map(len, lines)))
        if not lines:
            self._write(head)

    def add(self, outcome: Outcome) -> None:
        """Writes an outcome, which a process that is killed later does not lose."""
        self.outcomes[outcome.number] = outcome
        setting, seed = divmod(outcome.number, self._seeds)
        indices = {name: astuple(each) for name, each in outcome.indices.items()}
        place = {"setting": setting, "seed": seed + 1}
        self._write({**place, "indices": indices, "failure": outcome.failure})

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
