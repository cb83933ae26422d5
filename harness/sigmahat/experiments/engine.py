"""The engine of all studies: runs of a plan over seeds, with records, progress, table and figures.

A plan says what is run and what is made of the numbers. The engine does the runs in processes or on
a Dask cluster, longest first, keeps what is done, and writes tables and figures. The plans of this
package are in sigmahat.studies; a plan of your own may be anywhere that Python can import.
"""

import errno
import sqlite3
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Protocol, TypeVar

from sigmahat.experiments.cluster import spread_on_cluster
from sigmahat.experiments.job import Job, Outcome
from sigmahat.experiments.pool import Progress, WorkerError, WorkersLostError, spread
from sigmahat.experiments.records import NAME, Records
from sigmahat.files.output import created_folder, output_folder
from sigmahat.show.panel import FigureRows

Table = TypeVar("Table")


class Plan(Protocol[Table]):
    """What is run, and what is made of the outcomes. Table is what the plan computes of them."""

    @property
    def name(self) -> str:
        """One word for messages: "sweep"."""

    @property
    def jobs(self) -> Sequence[Job]:
        """Every entry of the plan with every seed."""

    def table(self, outcomes: Sequence[Outcome]) -> Table:
        """Computes the table; the outcomes have the order of the jobs."""

    def write(self, table: Table, folder: Path) -> None:
        """Writes the files of the table."""

    def figures(self, table: Table) -> Mapping[str, FigureRows]:
        """The figures of the table, by the names of their files without a suffix."""

    def text(self, table: Table) -> str:
        """The table for people, with its conditions."""

    def values(self, table: Table) -> object:
        """The table for JSON: identifiers as keys, and the units of the numbers."""


def study(
    plan: Plan[Table],
    out: Path,
    processes: int | None = None,
    scheduler: str | None = None,
    progress: Progress = lambda done: None,
) -> Table:
    """Does the runs of a plan that the folder `out` has no record of, and writes all files into it.

    processes  largest number of processes, by default one per processor; no effect on results
    scheduler  address of the scheduler of a Dask cluster, "tcp://host:port", to run there
    progress   called with the number of runs that are done since the last call, first with the
               recorded runs

    Raises what a run raises, ValueError if every run failed, WorkerError without workers, and
    OSError if a file cannot be written.
    """
    table = recorded_table(plan, out, processes, scheduler, progress)
    write_files(plan, table, out)
    return table


def recorded_table(
    plan: Plan[Table],
    out: Path,
    processes: int | None = None,
    scheduler: str | None = None,
    progress: Progress = lambda done: None,
) -> Table:
    """Computes the table as study() does, and writes nothing into `out` but the records."""
    with created_folder(out):
        try:
            with closing(Records(out / NAME)) as records:
                return computed_table(plan, processes, scheduler, records, progress)
        except sqlite3.DatabaseError as error:
            reason = f"{error}; another {plan.name} writes to this folder, or the file is damaged"
            raise OSError(errno.EIO, reason, str(out / NAME)) from error


def computed_table(
    plan: Plan[Table],
    processes: int | None = None,
    scheduler: str | None = None,
    records: Records | None = None,
    progress: Progress = lambda done: None,
) -> Table:
    """Computes the table as study() does, from records and runs, and writes no other file."""
    outcomes = all_outcomes(plan.jobs, processes, scheduler, records, progress)
    failures = [reason for outcome in outcomes for reason in outcome.failures.values()]
    if failures and not any(outcome.rows for outcome in outcomes):
        raise ValueError(f"every run failed; message of the first: {failures[0]}")
    return plan.table(outcomes)


def write_files(
    plan: Plan[Table], table: Table, out: Path, progress: Progress = lambda drawn: None
) -> None:
    """Writes the files and figures of a table into a folder, all of them or none.

    progress   called with 1 for every figure that is drawn
    """
    from sigmahat.show.figure import in_rows, save  # Matplotlib takes long to import

    with output_folder(out) as folder:
        plan.write(table, folder)
        for name, rows in plan.figures(table).items():
            save(in_rows, rows, folder / name)
            progress(1)


def all_outcomes(
    jobs: Sequence[Job],
    processes: int | None = None,
    scheduler: str | None = None,
    records: Records | None = None,
    progress: Progress = lambda done: None,
) -> list[Outcome]:
    """Returns the outcomes of all jobs in their order; jobs without a record are done now."""
    outcomes: dict[int, Outcome] = {}
    for place, job in enumerate(jobs):
        recorded = None if records is None else records.outcome(job)
        if recorded is not None:
            outcomes[place] = recorded
    progress(len(outcomes))
    # Longest runs first, so that no process waits for another process at the end.
    missing = [place for place in range(len(jobs)) if place not in outcomes]
    missing.sort(key=lambda place: -jobs[place].effort)
    calls = [partial(execute, jobs[place], jobs[place].identity) for place in missing]
    try:
        with closing(_spread(calls, processes, scheduler)) as done:
            for number, outcome in done:
                place = missing[number]
                outcomes[place] = outcome
                if records is not None and outcome.is_recorded:
                    records.add(jobs[place], outcome)
                progress(1)
    except WorkersLostError as error:
        raise WorkersLostError(f"{error}; run the command again for the missing runs") from error
    return [outcomes[place] for place in range(len(jobs))]


def _spread(
    calls: Sequence[Callable[[], Outcome]], processes: int | None, scheduler: str | None
) -> Generator[tuple[int, Outcome], None, None]:
    if scheduler is not None and calls:
        return spread_on_cluster(calls, scheduler)
    return spread(calls, processes)


def execute(job: Job, known_as: str) -> Outcome:
    """Does a job that has this identity. Raises WorkerError if FMUs or plan here are different."""
    if job.identity != known_as:
        raise WorkerError(
            "the FMUs or the plan of a worker differ from those here; "
            "install the same sigmahat on both"
        )
    return job.run()
