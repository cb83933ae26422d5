"""The job of `sigmahat sweep`: does the runs that are not done yet, and writes the results."""

import errno
import json
import sqlite3
from contextlib import closing
from dataclasses import astuple
from functools import partial
from pathlib import Path

from sigmahat.experiments.engine import Progress
from sigmahat.experiments.metrics import Indices
from sigmahat.experiments.pool import WorkersLostError, spread
from sigmahat.files.output import created_folder, output_folder
from sigmahat.sweep.cluster import spread_on_cluster
from sigmahat.sweep.plan import Outcome, Plan, Run
from sigmahat.sweep.preparation import check, execute, identity
from sigmahat.sweep.summary import write_summary
from sigmahat.sweep.table import SweepTable, of_outcomes, write

NAME = "runs.sqlite"
_TABLE = """
PRAGMA locking_mode = EXCLUSIVE;
BEGIN EXCLUSIVE;
CREATE TABLE IF NOT EXISTS runs (run TEXT PRIMARY KEY, indices TEXT);
COMMIT;
"""


class Records:
    """An SQLite file with the results of all completed runs in a folder.

    A later sweep with the same run does not repeat it, whatever else its plan has. A run that
    failed is not recorded.
    """

    def __init__(self, path: Path) -> None:
        """Opens or creates the file, for one process at a time. Raises sqlite3.DatabaseError."""
        self._path = path
        self._file = sqlite3.connect(path, timeout=0, isolation_level=None)
        try:
            self._file.executescript(_TABLE)
            self._indices = dict(self._file.execute("SELECT run, indices FROM runs"))
        except sqlite3.DatabaseError:
            self._file.close()
            raise

    def outcome(self, run: Run) -> Outcome | None:
        """Returns the outcome of a run; None for a run without a recorded outcome."""
        text = self._indices.get(identity(run))
        if text is None:
            return None
        return Outcome({name: Indices(*each) for name, each in json.loads(text).items()}, None)

    def add(self, run: Run, outcome: Outcome) -> None:
        """Writes the outcome of a run immediately, to keep the outcome after an interruption."""
        indices = {name: astuple(each) for name, each in outcome.indices.items()}
        row = identity(run), json.dumps(indices)
        self._file.execute("INSERT INTO runs VALUES (?, ?)", row)
        self._indices.update([row])

    def close(self) -> None:
        """Closes the file, and removes it if it has no run."""
        self._file.close()
        if not self._indices:
            self._path.unlink()


def sweep(
    plan: Plan, out: Path, scheduler: str | None = None, progress: Progress = lambda runs: None
) -> SweepTable:
    """Does the remaining runs of a sweep, here or on a Dask cluster, and writes all files into out.

    scheduler  address of the scheduler of the cluster, "tcp://host:port"
    progress   called with the number of runs done since the last call, first with the runs of
               earlier calls

    Raises ValueError if the plan does not fit its scenarios or every run failed. Raises FmuError if
    an FMU refuses a listed value, WorkerError without workers, OSError if a file cannot be written.
    """
    check(plan)
    with created_folder(out):
        try:
            with closing(Records(out / NAME)) as records:
                outcomes = all_outcomes(plan, records, scheduler, progress)
        except sqlite3.DatabaseError as error:
            reason = f"{error}; another sweep writes to this folder, or the file is damaged"
            raise OSError(errno.EIO, reason, str(out / NAME)) from error
        failures = [each.failure for each in outcomes if each.failure]
        if len(failures) == plan.count:
            raise ValueError(f"every run failed; message of the first: {failures[0]}")
        table = of_outcomes(plan, outcomes)
        from sigmahat.show.figure import save, stacked
        from sigmahat.sweep.panels import against_parameters, distributions

        with output_folder(out) as folder:
            write(table, folder / "sweep.parquet")
            write_summary(table, folder / "summary.csv")
            save(stacked, distributions(table), folder / "distributions")
            if panels := list(against_parameters(table)):
                save(stacked, panels, folder / "parameters")
    return table


def all_outcomes(
    plan: Plan, records: Records, scheduler: str | None, progress: Progress
) -> list[Outcome]:
    """Returns the outcomes of all runs in order; runs without a recorded outcome are done now."""
    outcomes = [records.outcome(run) for run in plan.runs]
    missing = [run for run, found in zip(plan.runs, outcomes, strict=True) if found is None]
    progress(plan.count - len(missing))
    jobs = [partial(execute, run, identity(run)) for run in missing]
    done = spread_on_cluster(jobs, scheduler) if scheduler and jobs else spread(jobs)
    try:
        with closing(done):
            for place, outcome in done:
                outcomes[missing[place].number] = outcome
                if outcome.failure is None:
                    records.add(missing[place], outcome)
                progress(1)
    except WorkersLostError as error:
        raise WorkersLostError(f"{error}; run the command again for the missing runs") from error
    return [each for each in outcomes if each is not None]
