"""The job of `sigmahat sweep`: does the runs that are not done yet, and writes the results.

A file has a line of JSON for each run that is done, so that a sweep can continue later. The first
line identifies the sweep, with any number of seeds. Each run has its setting, which is the place of
scenario and listed values in the plan, and its seed. So a sweep with more seeds can continue in the
same file.
"""

import json
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from dataclasses import astuple, replace
from functools import partial
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from sigmahat.files.output import created_folder, output_folder
from sigmahat.runs.engine import Progress
from sigmahat.runs.metrics import Indices
from sigmahat.runs.pool import WorkersLostError, spread
from sigmahat.sweep.cluster import spread_on_cluster
from sigmahat.sweep.plan import Outcome, Plan
from sigmahat.sweep.preparation import check, execute, fmu_digest, sweep_digest
from sigmahat.sweep.summary import write_summary
from sigmahat.sweep.table import SweepTable, of_outcomes, write

NAME = "runs.jsonl"
_HINT = "choose another folder with --out, or delete this file"


class Records:
    """The outcomes of a sweep so far, by the number of the run."""

    def __init__(self, path: Path, plan: Plan) -> None:
        """Reads the file if it exists.

        Raises ValueError, which says where and what to do, for a damaged file or another sweep.
        """
        self.path = path
        self.outcomes: dict[int, Outcome] = {}
        self._seeds = plan.seeds
        lines = path.read_bytes().splitlines(keepends=True) if path.exists() else []
        if lines and not lines[-1].endswith(b"\n"):
            lines.pop()  # an incomplete line after a kill; its run is done again
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
            if number in self.outcomes or not 0 <= number < plan.count:
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
        """Writes an outcome to the file at once, so that a later kill does not lose it."""
        self.outcomes[outcome.number] = outcome
        setting, seed = divmod(outcome.number, self._seeds)
        indices = {name: astuple(each) for name, each in outcome.indices.items()}
        place = {"setting": setting, "seed": seed + 1}
        self._write({**place, "indices": indices, "failure": outcome.failure})

    def close(self) -> None:
        """Closes the file, and removes it if it has no outcome."""
        self._file.close()
        if not self.outcomes:
            self.path.unlink()

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
            with FileLock(lock, timeout=0), closing(Records(folder / NAME, plan)) as opened:
                yield opened
        except Timeout as error:
            raise ValueError(f"another sweep is writing to {folder}; wait for it") from error


def sweep(
    plan: Plan, out: Path, scheduler: str | None = None, progress: Progress = lambda runs: None
) -> SweepTable:
    """Does the remaining runs of a sweep, here or on a Dask cluster, and writes all files into out.

    scheduler  address of the scheduler of the cluster, "tcp://host:port"
    progress   called with the number of runs done since the last call, first with the runs of
               an earlier, interrupted call

    Raises ValueError for a plan that does not fit its scenarios, for records that do not fit and
    if every run failed, FmuError if an FMU refuses a listed value, WorkerError for workers that
    are missing or lost, OSError for files that cannot be written.
    """
    check(plan)
    with records(out, plan) as done:
        progress(len(done.outcomes))
        _run(plan, done, scheduler, progress)
        failures = [o.failure for _, o in sorted(done.outcomes.items()) if o.failure]
        if len(failures) == plan.count:
            done.outcomes.clear()  # nothing is worth keeping
            raise ValueError(f"every run failed, the first with: {failures[0]}")
        table = of_outcomes(plan, done.outcomes)
        from sigmahat.plotting.figure import save, stacked
        from sigmahat.sweep.panels import against_parameters, distributions

        with output_folder(out) as folder:
            write(table, folder / "sweep.parquet")
            write_summary(table, folder / "summary.csv")
            save(stacked, distributions(table), folder / "distributions")
            if panels := list(against_parameters(table)):
                save(stacked, panels, folder / "parameters")
    return table


def _run(plan: Plan, done: Records, scheduler: str | None, progress: Progress) -> None:
    """Does the remaining runs, and writes each outcome into the records."""
    digests = {name: fmu_digest(name) for name in plan.scenarios}
    jobs: list[Callable[[], Outcome]] = [
        partial(execute, run, digests[run.scenario])
        for run in plan.runs
        if run.number not in done.outcomes
    ]
    if not jobs:
        return
    outcomes = spread_on_cluster(jobs, scheduler) if scheduler else spread(jobs)
    try:
        with closing(outcomes):
            for _, outcome in outcomes:
                done.add(outcome)
                progress(1)
    except WorkersLostError as error:
        raise WorkersLostError(f"{error}; the same command does the remaining runs") from error
