"""Commands that simulate: reproduce, compare, scenarios, sweep."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sigmahat.commands import common

if TYPE_CHECKING:
    from sigmahat.experiments.engine import Plan


def _run(
    plan: Plan[Any],
    out: Path,
    files: str,
    processes: int | None = None,
    scheduler: str | None = None,
) -> None:
    """Runs a plan, writes its files into a folder and prints its table; files: what is written.

    Raises ClickException if an FMU is not built, and for what is wrong with a value or a file.
    """
    from sigmahat.experiments.engine import recorded_table, write_files

    _need_fmus(plan)
    with common.errors_in_one_line(out):
        with common.progress("Running", len(plan.jobs)) as bar:
            table = recorded_table(plan, out, processes, scheduler, bar.update)
        with common.progress("Drawing", len(plan.figures(table))) as bar:
            write_files(plan, table, out, bar.update)
    written = f"{files} are in {out.resolve()}"
    common.answer(f"{plan.text(table)}\n\n{written}", plan.values(table))


def _need_fmus(plan: Plan[Any]) -> None:
    common.need_fmus(*sorted({fmu for job in plan.jobs for fmu in job.fmus}))


def _need_intervals(seeds: int) -> None:
    """Imports scipy, which intervals need: a missing package is reported before the runs."""
    if seeds > 1:
        import_module("scipy")


def _names(_: click.Context, __: click.Parameter, begin: str) -> list[str]:
    from sigmahat.paper.scenarios import SCENARIOS

    return [name for name in SCENARIOS if name.startswith(begin)]


@common.command("reproduce --scenario as-printed --seeds 20 --out as-printed")
@common.option("--scenario", default="table1", shell_complete=_names, help="What to run.")
@common.option(
    "--seeds", default=1, type=common.COUNT, help="Number of runs, each with different noise."
)
@common.out_option("Folder for figures and CSV files.", "{scenario}")
@common.answer_options
def reproduce(scenario: str, seeds: int, out: Path) -> None:
    """Run a scenario; print its table, draw its figures."""
    from sigmahat.paper.scenarios import scenario as named

    with common.errors_in_one_line(out):
        chosen = named(scenario)
    common.need_fmus(*chosen.fmus)
    _need_intervals(seeds)
    from sigmahat.studies.reproduce import Reproduction

    _run(Reproduction(chosen, range(1, seeds + 1)), out, "Figures (PNG, SVG) and CSV files")


@common.command("compare --seeds 20 --out compare")
@click.option(
    "--misfits",
    is_flag=True,
    help="Test only FilteredRegression, on joints with hysteresis, backlash, high friction, bad "
    "sensors and other effects.",
)
@common.option(
    "--seeds",
    default=5,
    type=common.COUNT,
    help="Number of runs of each joint, each with different noise.",
)
@click.option("--jobs", type=common.COUNT, help="Processes to use.  [default: all cores]")
@common.out_option("Folder for figure and CSV file.", "compare")
@common.answer_options
def compare(misfits: bool, seeds: int, jobs: int | None, out: Path) -> None:
    """Compare the estimation methods on joints with wrong motor data."""
    numbers = range(1, seeds + 1)
    if misfits:
        from sigmahat.studies.misfit_experiment import JOINTS as KINDS
        from sigmahat.studies.misfits import CONDITIONS, Misfits

        plan: Plan[Any] = Misfits(CONDITIONS, KINDS, numbers)
    else:
        from sigmahat.studies.compare import JOINTS, MethodComparison

        _need_intervals(seeds)
        plan = MethodComparison(JOINTS, numbers)
    _run(plan, out, "Figure (PNG, SVG) and CSV file", processes=jobs)


@common.command("scenarios --json")
@common.json_option
def scenarios() -> None:
    """List the scenarios."""
    from sigmahat.paper.scenarios import SCENARIOS

    width = max(map(len, SCENARIOS)) + 2
    common.answer(
        "\n".join(f"{s.name:{width}}{s.description}" for s in SCENARIOS.values()),
        [{"name": s.name, "description": s.description} for s in SCENARIOS.values()],
    )


def _listed(_: click.Context, __: click.Parameter, text: str | None) -> tuple[str, ...]:
    return () if text is None else tuple(name.strip() for name in text.split(","))


@common.command(
    "sweep --seeds 100 --modality RESIDUAL \\\n    "
    "--set estimator.motor.D_theta=0.9e-3:1.1e-3:5 --out friction"
)
@common.option("--scenario", callback=_listed, default="table1", help="One or more, a,b.")
@common.option("--seeds", default=1, type=common.COUNT, help="Number of runs of each setting.")
@click.option("--modality", callback=_listed, help="Estimators to run, a,b.  [default: all]")
@click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="NAME=VALUES",
    help="Parameter plant.X, estimator.X or MODALITY.X; values 1,2,3 or first:last:count, or "
    "drawn for each seed: uniform(low,high), normal(mean,deviation). Repeatable.",
)
@click.option(
    "--scheduler", metavar="ADDRESS", help="Dask scheduler, tcp://host:port.  [default: all cores]"
)
@common.out_option("Folder for table and figures.", "sweep")
@common.answer_options
def sweep(
    scenario: tuple[str, ...],
    seeds: int,
    modality: tuple[str, ...],
    settings: tuple[str, ...],
    scheduler: str | None,
    out: Path,
) -> None:
    """Run scenarios over seeds and parameters, in parallel; Monte Carlo.

    After an interruption, the same command does the missing runs; with more seeds, only the runs
    of the new seeds.
    """
    from sigmahat.studies.sweep import Sweep, check
    from sigmahat.studies.sweep_grid import read_grid

    with common.errors_in_one_line(out):
        plan = Sweep(read_grid(scenario, seeds, modality, settings))
        _need_fmus(plan)
        check(plan.grid)
    files = "Table (Parquet), summary (CSV) and figures (PNG, SVG)"
    _run(plan, out, files, scheduler=scheduler)
