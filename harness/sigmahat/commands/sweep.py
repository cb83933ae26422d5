"""sigmahat sweep"""

from __future__ import annotations

from pathlib import Path

import click

from sigmahat.commands import common


def _names(_: click.Context, __: click.Parameter, text: str | None) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",")) if text else ()


@click.command()
@click.argument("plan", required=False, type=click.Path(path_type=Path, dir_okay=False))
@click.option("--scenario", callback=_names, help="One or more, a,b.  [default: table1]")
@click.option(
    "--seeds", type=click.IntRange(min=1), help="Number of runs of each setting.  [default: 1]"
)
@click.option("--modality", callback=_names, help="Estimators to run, a,b.  [default: all]")
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
@click.option(
    "--out",
    callback=common.folder,
    help="Folder for table and figures.  [default: sigmahat-results/sweep]",
)
@common.json_option
@common.quiet_option
def sweep(
    plan: Path | None,
    scenario: tuple[str, ...],
    seeds: int | None,
    modality: tuple[str, ...],
    settings: tuple[str, ...],
    scheduler: str | None,
    out: Path | None,
) -> None:
    """Run scenarios over seeds and parameters, in parallel; Monte Carlo.

    PLAN is a TOML file with the keys scenario, seeds, modality and a table [parameters]; options
    replace them. After an interruption the same command does the runs that are missing; with more
    seeds, those of the new seeds.

    \b
    Example: sigmahat sweep --seeds 100 --modality RESIDUAL \\
        --set estimator.motor.D_theta=0.9e-3:1.1e-3:5 --out friction
    """
    from sigmahat.sweep.job import sweep as run
    from sigmahat.sweep.plan_file import read_plan
    from sigmahat.sweep.summary import as_dicts, conditions, summary

    out = out or Path("sigmahat-results", "sweep")
    with common.errors_in_one_line(out):
        read = read_plan(plan, scenario, seeds, modality, settings)
        for name in read.scenarios:
            common.ready_scenario(name)
        with common.progress("Running", len(read)) as bar:
            result = run(read, out, scheduler, progress=bar.update)
    common.answer(
        f"{conditions(read)}\n\n{summary(result)}\n\n"
        f"Table (Parquet), summary (CSV) and figures (PNG, SVG) are in {out.resolve()}",
        as_dicts(result),
    )
