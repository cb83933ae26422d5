"""sigmahat compare"""

from __future__ import annotations

from pathlib import Path

import click

from sigmahat.commands import common


@click.command()
@click.option(
    "--seeds",
    default=5,
    show_default=True,
    type=click.IntRange(min=1),
    help="Number of runs of each joint, each with other noise.",
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
def compare(seeds: int, out: Path) -> None:
    """Compare the estimation methods where motor data are wrong.

    \b
    Example: sigmahat compare --seeds 20 --out compare
    """
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
            rows = compare(JOINTS, range(1, seeds + 1), progress=bar.update)
        from sigmahat.compare.figure import draw
        from sigmahat.plotting.save import save

        save(draw, rows, folder / "compare")
        write(rows, seeds, folder / "compare.csv")

    common.answer(
        f"MSREP [%] of both methods, and of MatchedFilter: sigma_std relative to the true "
        f"stiffness and share of instants\nwithin 1.96 sigma_std, from {CALIBRATED:g} s on; motor "
        f"data found at the end, true {TRUE['D_theta']:g} N.m.s/rad, {TRUE['B']:g} kg.m2.\n"
        f"Mean over {seeds} seed{'s' if seeds > 1 else ''}. {MSREP_IN_WORDS}.\n\n"
        f"{table(rows)}\n\n"
        f"Figure (PNG, SVG) and CSV file are in {out.resolve()}",
        as_dicts(rows),
    )
