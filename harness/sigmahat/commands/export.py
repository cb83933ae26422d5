"""sigmahat export"""

from __future__ import annotations

from pathlib import Path

import click

from sigmahat.commands import common

_SUFFIXES = {"ssv": ".ssv", "matlab": ".m", "modelica": ".mo"}


@click.command()
@click.argument("sheet", type=click.Path(path_type=Path))
@click.option(
    "--to",
    required=True,
    type=click.Choice(list(_SUFFIXES)),
    help="ssv: parameter set for SSP; matlab: function; modelica: record.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    help="File to write.  [default: SHEET with the suffix .ssv, .m or .mo]",
)
@click.option("--force", is_flag=True, help="Overwrite the file if it exists.")
@common.quiet_option
def export(sheet: Path, to: str, out: Path | None, force: bool) -> None:
    """Write start values of the FMU from the data sheet of a joint.

    SHEET is the joint.json that `sigmahat estimate` wrote, or its folder. An FMU with these start
    values begins with the stiffness that was learned.

    \b
    Example: sigmahat export sigmahat-results/knee --to ssv
    """
    from sigmahat.fmi.opened import installed
    from sigmahat.joint import parameter_file
    from sigmahat.joint.sheet import FORMAT

    common.need_fmu("StiffnessEstimator")
    path = out or FORMAT.path(sheet).with_suffix(_SUFFIXES[to])
    with common.errors_in_one_line(path, "--out FILE"):
        contents = FORMAT.read(sheet)
        if path.exists() and not force:
            raise click.ClickException(
                f"{path} exists; --force overwrites it, --out names another file"
            )
        fmu = installed("StiffnessEstimator")
        parameter_file.write(contents, fmu, to, path)
    common.answer(f"{len(contents.start_values)} start values are in {path.resolve()}")
