"""Commands that simulate: reproduce, compare, scenarios, sweep."""

from importlib import import_module
from pathlib import Path

import click

from sigmahat.commands import common


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
    from sigmahat.experiments.metrics import MSREP_IN_WORDS
    from sigmahat.files.output import output_folder
    from sigmahat.paper.reproduction import as_dict, conditions, reproduce, table, write_results
    from sigmahat.paper.scenarios import scenario as named

    with common.errors_in_one_line(out):
        chosen = named(scenario)
    common.need_fmus(*chosen.fmus)
    if seeds > 1:
        import_module("scipy")  # intervals need scipy: report a missing package before the runs
    numbers = range(1, seeds + 1)
    with common.errors_in_one_line(out), output_folder(out) as folder:
        with common.progress("Running", seeds if seeds > 1 else chosen.steps) as bar:
            result = reproduce(chosen, numbers, progress=bar.update)
        from sigmahat.paper.figures import FIGURES
        from sigmahat.show.figure import in_rows, save

        with common.progress("Drawing", len(chosen.figures)) as bar:
            for title in chosen.figures:
                save(in_rows, FIGURES[title](result.recording), folder / title)
                bar.update(1)
        write_results(result, folder)

    common.answer(
        f"{chosen.name}: {chosen.description}\n{conditions(result)}\n{MSREP_IN_WORDS}\n\n"
        f"{table(result)}\n\nFigures (PNG, SVG) and CSV files are in {out.resolve()}",
        as_dict(result),
    )


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
    (_misfits if misfits else _methods)(seeds, jobs, out)


def _methods(seeds: int, jobs: int | None, out: Path) -> None:
    from sigmahat.compare.conditions import JOINTS, TRUE
    from sigmahat.compare.job import CALIBRATED, compare
    from sigmahat.compare.table import as_dicts, table, write
    from sigmahat.experiments.metrics import MSREP_IN_WORDS
    from sigmahat.files.output import output_folder

    for joint in JOINTS:
        common.need_fmus(*joint.scenario.fmus)

    with common.errors_in_one_line(out), output_folder(out) as folder:
        with common.progress("Running", len(JOINTS) * seeds) as bar:
            rows = compare(JOINTS, range(1, seeds + 1), jobs, progress=bar.update)
        from sigmahat.compare.figure import draw
        from sigmahat.show.figure import save

        save(draw, rows, folder / "compare")
        write(rows, seeds, folder / "compare.csv")

    common.answer(
        f"MSREP [%] of both methods. FilteredRegression from {CALIBRATED:g} s on: sigma_std\n"
        "relative to the true stiffness, and fraction of the time in which the error is below\n"
        "1.96 sigma_std. Estimated motor data at the end; the true ones are "
        f"{TRUE['D_theta']:g} N.m.s/rad\nand {TRUE['B']:g} kg.m2. "
        f"Mean over {_counted(seeds)}. {MSREP_IN_WORDS}.\n\n"
        f"{table(rows)}\n\n"
        f"Figure (PNG, SVG) and CSV file are in {out.resolve()}",
        as_dicts(rows),
    )


def _misfits(seeds: int, jobs: int | None, out: Path) -> None:
    from sigmahat.compare.misfits.conditions import CONDITIONS
    from sigmahat.compare.misfits.experiment import JOINTS
    from sigmahat.compare.misfits.job import ESTIMATOR, SETTLED, compare, pairs
    from sigmahat.compare.misfits.motion import PLANT
    from sigmahat.compare.misfits.table import as_dicts, table, write
    from sigmahat.files.output import output_folder

    common.need_fmus(PLANT, ESTIMATOR)
    with common.errors_in_one_line(out), output_folder(out) as folder:
        with common.progress("Running", len(pairs(CONDITIONS, JOINTS)) * seeds) as bar:
            rows = compare(CONDITIONS, JOINTS, range(1, seeds + 1), jobs, bar.update)
        from sigmahat.compare.misfits.figure import draw
        from sigmahat.show.figure import save

        save(draw, rows, folder / "misfits")
        write(rows, seeds, folder / "misfits.csv")

    common.answer(
        f"FilteredRegression on a catalogue of joints and misfits. Error, claim (sigma_std): RMS, "
        f"relative to the true\nstiffness. Coverage: fraction of instants with the truth within "
        f"1.96 sigma_std. Dangerous: over 10 % off while\nclaiming under 2 %. Wrong: "
        f"confident and over 20 % off. Instants after {SETTLED:g} s, outside of a dead zone, of\n"
        f"{_counted(seeds)}.\n\n"
        f"{table(rows)}\n\n"
        f"Figure (PNG, SVG) and CSV file are in {out.resolve()}",
        as_dicts(rows),
    )


def _counted(seeds: int) -> str:
    return f"{seeds} seed{'s' if seeds > 1 else ''}"


@common.command("scenarios --json")
@common.json_option
def scenarios() -> None:
    """List the scenarios."""
    from sigmahat.paper.scenarios import SCENARIOS

    width = max(map(len, SCENARIOS)) + 2
    every = SCENARIOS.values()
    common.answer(
        "\n".join(f"{each.name:{width}}{each.description}" for each in every),
        [{"name": each.name, "description": each.description} for each in every],
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
    from sigmahat.paper.scenarios import scenario as named
    from sigmahat.sweep.job import sweep as run
    from sigmahat.sweep.plan import read_plan
    from sigmahat.sweep.summary import as_dicts, conditions, summary

    with common.errors_in_one_line(out):
        plan = read_plan(scenario, seeds, modality, settings)
        for name in plan.scenarios:
            common.need_fmus(*named(name).fmus)
        with common.progress("Running", plan.count) as bar:
            result = run(plan, out, scheduler, progress=bar.update)
    common.answer(
        f"{conditions(plan)}\n\n{summary(result)}\n\n"
        f"Table (Parquet), summary (CSV) and figures (PNG, SVG) are in {out.resolve()}",
        as_dicts(result),
    )
