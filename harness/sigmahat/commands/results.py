"""Commands that make results from a log: estimate, validate, export, report."""

from __future__ import annotations

from contextlib import suppress
from importlib import import_module
from pathlib import Path
from threading import Thread

import click

from sigmahat.commands import common


@click.command()
@common.log_argument
@common.config_option("File from `sigmahat init`.")
@click.option(
    "--out",
    callback=common.folder,
    help="Folder for table and figure.  [default: sigmahat-results/LOG]",
)
@click.option(
    "--start-from",
    type=click.Path(path_type=Path),
    help="Go on from what was learned before: the folder of another log, or its state.json.",
)
@common.json_option
@common.quiet_option
def estimate(log: Path, config: Path | None, out: Path | None, start_from: Path | None) -> None:
    """Replay LOG through the estimator, and add the stiffness to its table.

    LOG is CSV, Parquet, MAT, HDF5, MCAP or a ROS 2 bag; `sigmahat init LOG` writes the
    configuration. Writes a table (CSV for CSV, else Parquet), the stiffness over the deformation
    (estimate.curve.csv), a figure, a data sheet of the joint
    (joint.json) for `sigmahat export`, and what was learned (state.json) for --start-from.

    \b
    Example: sigmahat estimate knee.parquet --config knee.toml --out knee
    """
    from sigmahat.checks.check import check
    from sigmahat.checks.findings import as_dict
    from sigmahat.checks.text import IN_LOG, sentence
    from sigmahat.checks.text import summary as of_checks
    from sigmahat.files.output import output_folder
    from sigmahat.logs.configuration import read_configuration
    from sigmahat.logs.estimate import estimate as run
    from sigmahat.logs.estimate import summary
    from sigmahat.logs.readers.formats import open_log
    from sigmahat.report.from_log import ShownFinding, write_findings

    common.need_fmu("StiffnessEstimator")
    out = out or Path("sigmahat-results", log.stem)
    with common.errors_in_one_line(out):
        opened = open_log(log)
        configuration = read_configuration(config or common.configuration_of(log))
        # Check and figure need them; reading and replaying the log need little of Python.
        Thread(target=_import, args=["scipy.signal", "matplotlib.figure"]).start()
        checked = check(opened, configuration)
        with output_folder(out) as folder, common.progress("Replaying", 1000) as bar:
            result = run(opened, configuration, folder, bar.update, start_from)
            shown = [ShownFinding(f.severity.value, sentence(f)) for f in checked.findings]
            write_findings(shown, folder)
    where = f"Table, curve, figure (PNG, SVG), joint.json and state.json are in {out.resolve()}"
    text = f"{summary(result)}\n\n{of_checks(checked, IN_LOG)}\n\n{where}"
    common.answer(text, {**result.as_dict(), "checks": as_dict(checked)})


def _import(*modules: str) -> None:
    """Imports modules before they are needed; a failure shows then."""
    with suppress(ImportError):
        for module in modules:
            import_module(module)


@click.command()
@common.log_argument
@click.option(
    "--with",
    "config",
    required=True,
    type=click.Path(path_type=Path, dir_okay=False),
    help="Configuration with which `sigmahat estimate` learned from the first log.",
)
@click.option(
    "--start-from",
    type=click.Path(path_type=Path),
    help="What was learned: its folder, or state.json.  [default: sigmahat-results/CONFIG]",
)
@common.json_option
@common.quiet_option
def validate(log: Path, config: Path, start_from: Path | None) -> int:
    """Check with LOG what was learned from another log of the same joint.

    LOG is replayed with the stiffness that was learned, and alone. Exit status: 0 if the logs
    agree, 1 if they do not or cannot tell.

    \b
    Example: sigmahat validate second.csv --with knee.toml
    """
    from sigmahat.logs.configuration import read_configuration
    from sigmahat.logs.readers.formats import open_log
    from sigmahat.validation.validate import summary
    from sigmahat.validation.validate import validate as run

    common.need_fmu("StiffnessEstimator")
    start_from = start_from or Path("sigmahat-results", config.stem)
    with common.errors_in_one_line(start_from, "--start-from"):
        opened = open_log(log)
        result = run(opened, read_configuration(config), start_from)
    common.answer(summary(result), result.as_dict())
    return 0 if result.agree else 1


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
    from sigmahat.files.output import write_whole
    from sigmahat.report.page import report as make

    out = out or folder / "report.html"
    with common.errors_in_one_line(out, "--out FILE"):
        text = make(folder)
        write_whole(text, out)
    common.answer(f"{out.resolve()} ({len(text.encode()) / 1e6:.1f} MB)")
