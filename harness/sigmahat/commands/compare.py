"""sigmahat compare"""

from __future__ import annotations

from pathlib import Path

import click

from sigmahat.commands import common


@click.command()
@click.option(
    "--misfits",
    is_flag=True,
    help="FilteredRegression on joints with hysteresis, backlash, bad friction and sensors, ..., "
    "in place of both methods.",
)
@click.option(
    "--seeds",
    default=5,
    show_default=True,
    type=click.IntRange(min=1),
    help="Number of runs of each joint, each with other noise.",
)
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    help="Processes to use.  [default: all cores]",
)
@click.option(
    "--out",
    default="sigmahat-results/compare",
    show_default=True,
    callback=common.folder,
    help="Folder for figure and CSV file.",
)
@common.json_option
@common.quiet_option
def compare(misfits: bool, seeds: int, jobs: int | None, out: Path) -> None:
    """Compare the estimation methods where motor data are wrong.

    \b
    Example: sigmahat compare --seeds 20 --out compare
    """
    (_misfits if misfits else _methods)(seeds, jobs, out)


def _methods(seeds: int, jobs: int | None, out: Path) -> None:
    """Both methods, where motor data are wrong."""
    from sigmahat.compare.conditions import JOINTS, TRUE
    from sigmahat.compare.job import compare
    from sigmahat.compare.performance import CALIBRATED
    from sigmahat.compare.table import as_dicts, table, write
    from sigmahat.files.output_folder import output_folder
    from sigmahat.runs.metrics import MSREP_IN_WORDS

    for joint in JOINTS:
        common.need_fmus(joint.scenario)

    with common.errors_in_one_line(out), output_folder(out) as folder:
        with common.progress("Running", len(JOINTS) * seeds) as bar:
            rows = compare(JOINTS, range(1, seeds + 1), jobs, progress=bar.update)
        from sigmahat.compare.figure import draw
        from sigmahat.plotting.save import save

        save(draw, rows, folder / "compare")
        write(rows, seeds, folder / "compare.csv")

    common.answer(
        f"MSREP [%] of both methods, and of FilteredRegression: sigma_std relative to the true "
        f"stiffness and share of instants\nwithin 1.96 sigma_std, from {CALIBRATED:g} s on; motor "
        f"data found at the end, true {TRUE['D_theta']:g} N.m.s/rad, {TRUE['B']:g} kg.m2.\n"
        f"Mean over {_counted(seeds)}. {MSREP_IN_WORDS}.\n\n"
        f"{table(rows)}\n\n"
        f"Figure (PNG, SVG) and CSV file are in {out.resolve()}",
        as_dicts(rows),
    )


def _misfits(seeds: int, jobs: int | None, out: Path) -> None:
    """FilteredRegression on the catalogue of misfits."""
    from sigmahat.compare.misfits.conditions import CONDITIONS
    from sigmahat.compare.misfits.job import ESTIMATOR, compare, pairs
    from sigmahat.compare.misfits.joints import JOINTS
    from sigmahat.compare.misfits.motion import PLANT
    from sigmahat.compare.misfits.score import SETTLED
    from sigmahat.compare.misfits.table import as_dicts, table, write
    from sigmahat.files.output_folder import output_folder

    for fmu in (PLANT, ESTIMATOR):
        common.need_fmu(fmu)

    with common.errors_in_one_line(out), output_folder(out) as folder:
        with common.progress("Running", len(pairs(CONDITIONS, JOINTS)) * seeds) as bar:
            rows = compare(CONDITIONS, JOINTS, range(1, seeds + 1), jobs, bar.update)
        from sigmahat.compare.misfits.figure import draw
        from sigmahat.plotting.save import save

        save(draw, rows, folder / "misfits")
        write(rows, seeds, folder / "misfits.csv")

    common.answer(
        f"FilteredRegression on a catalogue of joints and misfits. Error, claim (sigma_std): RMS, "
        f"relative to the true\nstiffness. Coverage: share of instants with the truth within "
        f"1.96 sigma_std. Dangerous: over 10 % off while\nclaiming under 2 %. Wrong: "
        f"confident and over 20 % off. Instants after {SETTLED:g} s, outside of a dead zone, of\n"
        f"{_counted(seeds)}.\n\n"
        f"{table(rows)}\n\n"
        f"Figure (PNG, SVG) and CSV file are in {out.resolve()}",
        as_dicts(rows),
    )


def _counted(seeds: int) -> str:
    return f"{seeds} seed{'s' if seeds > 1 else ''}"
