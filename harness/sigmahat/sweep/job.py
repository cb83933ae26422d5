"""The job of `sigmahat sweep`: does the runs that are not done yet, and writes the results."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from functools import partial
from pathlib import Path

from sigmahat.files.output import output_folder
from sigmahat.runs.engine import Progress
from sigmahat.runs.pool import WorkersLostError, spread
from sigmahat.sweep.cluster import spread_on_cluster
from sigmahat.sweep.plan import Outcome, Plan
from sigmahat.sweep.preparation import check, execute, fmu_digest
from sigmahat.sweep.records import Records, records
from sigmahat.sweep.rows import build
from sigmahat.sweep.summary import write_summary
from sigmahat.sweep.table import SweepTable, write


def sweep(
    plan: Plan,
    out: Path,
    scheduler: str | None = None,
    progress: Progress = lambda runs: None,
) -> SweepTable:
    """Does what is not done of a sweep, here or on a Dask cluster, and writes all files into out.

    scheduler  address of the scheduler of the cluster, "tcp://host:port"
    progress   called with the number of runs done since the last call, first with those that
               an earlier, interrupted call had done

    Raises ValueError for a plan that does not fit its scenarios, for records that do not fit and
    if every run failed, FmuError if an FMU refuses a listed value, WorkerError for workers that
    are not there or lost, OSError for files that cannot be written.
    """
    check(plan)
    with records(out, plan) as done:
        progress(len(done.outcomes))
        _run(plan, done, scheduler, progress)
        failures = [o.failure for _, o in sorted(done.outcomes.items()) if o.failure]
        if len(failures) == len(plan):
            done.outcomes.clear()  # nothing is worth keeping
            raise ValueError(f"every run failed, the first with: {failures[0]}")
        table = build(plan, done.outcomes)
        with output_folder(out) as folder:
            write(table, folder / "sweep.parquet")
            write_summary(table, folder / "summary.csv")
            _draw(table, folder)
    return table


def _run(plan: Plan, done: Records, scheduler: str | None, progress: Progress) -> None:
    """Does the runs that are not done, and writes each into the records."""
    digests = {name: fmu_digest([name]) for name in plan.scenarios}
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
        raise WorkersLostError(f"{error}; the same command goes on from what is done") from error


def _draw(table: SweepTable, folder: Path) -> None:
    from sigmahat.plotting.figure import stacked
    from sigmahat.plotting.save import save
    from sigmahat.sweep.panels import against_parameters, distributions

    save(stacked, distributions(table), folder / "distributions")
    if panels := list(against_parameters(table)):
        save(stacked, panels, folder / "parameters")
