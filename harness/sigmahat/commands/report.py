"""sigmahat report"""

from __future__ import annotations

from pathlib import Path

import click

from sigmahat.commands import common


@click.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.option(
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    help="File to write.  [default: report.html in FOLDER]",
)
@common.quiet_option
def report(folder: Path, out: Path | None) -> None:
    """Make one HTML file of the results in FOLDER, with plots to zoom.

    FOLDER is what `sigmahat reproduce`, `estimate`, `sweep` or `compare` wrote. The file opens
    offline.

    \b
    Example: sigmahat report sigmahat-results/table1
    """
    from sigmahat.files.whole_file import write_whole
    from sigmahat.report.page import report as make

    out = out or folder / "report.html"
    with common.errors_in_one_line(out, "--out FILE"):
        text = make(folder)
        write_whole(text, out)
    common.answer(f"{out.resolve()} ({len(text.encode()) / 1e6:.1f} MB)")
