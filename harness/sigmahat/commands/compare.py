"""sigmahat compare"""

from __future__ import annotations

from dataclasses import asdict
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
    from sigmahat.paper import results
    from sigmahat.paper.comparisons import CALIBRATED, JOINTS, compare

    estimators = (e.fmu for j in JOINTS for case in j.cases for e in case.estimators.values())
    for fmu in {*(joint.plant.fmu for joint in JOINTS), *estimators}:
        common.need_fmu(fmu)

    with common.work(out), results.folder(out) as folder:
        with common.progress("Running", len(JOINTS) * seeds) as bar:
            lines = compare(JOINTS, range(1, seeds + 1), progress=bar.update)
        from sigmahat.paper.figures import comparison, save

        save(comparison, lines, folder / "compare")
        results.write_comparison(lines, seeds, folder / "compare.csv")

    common.answer(
        f"MSREP [%] of both methods, and of MatchedFilter: sigma_std relative to the true "
        f"stiffness and share of instants\nwithin 1.96 sigma_std, from {CALIBRATED:g} s on; motor "
        f"data found at the end, true 0.001 N.m.s/rad, 2.3e-05 kg.m2.\n"
        f"Mean over {seeds} seed{'s' if seeds > 1 else ''}.\n\n"
        f"{results.comparison_table(lines)}\n\n"
        f"Figure (PNG, SVG) and CSV file are in {out.resolve()}",
        [asdict(line) for line in lines],
    )
