"""Commands that make results from a log: estimate, validate, export, report."""

from __future__ import annotations

from contextlib import suppress
from datetime import datetime
from functools import partial
from importlib import import_module
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING

import click

from sigmahat.commands import common

if TYPE_CHECKING:
    from sigmahat.checks.findings import Checked
    from sigmahat.recording.configuration import Configuration
    from sigmahat.recording.log import Log
    from sigmahat.result.estimate import Estimate
    from sigmahat.result.validate import Validation


@common.command("estimate knee.parquet --config knee.toml --out knee")
@common.log_argument
@common.config_option("File from `sigmahat init`.")
@common.out_option("Folder for table and figure.", "{log}")
@click.option(
    "--start-from",
    type=common.PATH,
    help="Continue the estimation of another log: its folder of results, of several joints the one "
    "with a folder for each; or state.json.",
)
@click.option(
    "--to",
    type=click.Choice(["mcap"]),
    help="Write the estimates as messages, too: estimate.mcap, for Foxglove and PlotJuggler.",
)
@click.option(
    "--recorded",
    type=click.DateTime(["%Y-%m-%d", "%Y-%m-%dT%H:%M", "%Y-%m-%dT%H:%M:%S"]),
    help="When LOG was recorded (UTC), if neither its clock nor its name says this; for `sigmahat "
    "health`.",
)
@common.joint_option
@common.answer_options
def estimate(
    log: Path,
    config: Path,
    out: Path,
    start_from: Path | None,
    to: str | None,
    recorded: datetime | None,
    joint: str,
) -> None:
    """Replay LOG through the estimator, and add the stiffness to its table.

    LOG is CSV, Parquet, MAT, HDF5, MCAP or a ROS 2 bag; `sigmahat init LOG` writes the
    configuration. Writes a table (CSV for CSV, else Parquet), the stiffness against deformation
    (estimate.curve.csv) and a figure. Also writes a data sheet of the joint (joint.json) for
    `sigmahat export`, and the state of the estimator (state.json) for --start-from.
    With several joints, each joint has its own folder, and a row in joints.csv.
    """
    from sigmahat.checks.findings import as_dict
    from sigmahat.checks.text import summary as of_checks
    from sigmahat.files.tables import aligned
    from sigmahat.recording.recorded import possible_time
    from sigmahat.result.estimate import summary, write_joints

    if to is not None:
        import_module("mcap")  # report a missing package before the work
    with common.errors_in_one_line(out):
        if recorded is not None:
            possible_time(recorded)
        job = partial(_estimated, out, start_from, to, recorded)
        found = common.for_each_joint(log, config, joint, job)
        if len(found) > 1:
            write_joints({name: each for name, (each, _) in found.items()}, out)
    values = {name: {**each.as_dict(), "checks": as_dict(c)} for name, (each, c) in found.items()}
    where = f"Table, curve, figure (PNG, SVG), joint.json and state.json are in {out.resolve()}"
    if len(found) == 1:
        ((name, (result, checked)),) = found.items()
        text = f"{summary(result)}\n\n{of_checks(checked)}\n\n{where}"
        common.answer(text, values[name], result.headline)
    else:
        rows = [(name, result.headline) for name, (result, _) in found.items()]
        lines = ["\n".join(map(str.rstrip, aligned(rows, left=(0, 1))))]
        wrong = [name for name, (_, checked) in found.items() if checked.is_wrong]
        lines += [f"Something is likely wrong: sigmahat check {log} --joint {n}" for n in wrong]
        text = f"{where}, in a folder for each joint; joints.csv there has the table above"
        common.answer("\n\n".join([*lines, text]), {"joints": values})


def _estimated(
    out: Path,
    start_from: Path | None,
    to: str | None,
    recorded: datetime | None,
    log: Log,
    configuration: Configuration,
) -> tuple[Estimate, Checked]:
    """Writes the files of a joint. Returns its estimate and the result of the checks."""
    from sigmahat.checks.check import check
    from sigmahat.files.output import output_folder
    from sigmahat.result import estimate as job
    from sigmahat.result.learned import state_of

    # The figure needs this import, which can run meanwhile: the replay is mostly C code.
    Thread(target=_import, args=["matplotlib.figure"]).start()
    checked, own = check(log, configuration), out / configuration.joint
    if start_from is not None:
        start_from = state_of(start_from, configuration.joint)
    with common.progress("Replaying", 1000) as bar, output_folder(own) as folder:
        findings = [each.as_dict() for each in checked.findings]
        result = job.estimate(
            log, configuration, folder, bar.update, start_from, to == "mcap", findings, recorded
        )
    return result, checked


def estimated_into(out: Path, log: Log, configuration: Configuration) -> None:
    """Writes the files of a joint, without checks and messages."""
    from sigmahat.files.output import output_folder
    from sigmahat.result.estimate import estimate

    with output_folder(out / configuration.joint) as folder:
        estimate(log, configuration, folder)


def _import(module: str) -> None:
    """Imports a module in advance; a failure is raised again when the module is needed."""
    with suppress(ImportError):
        import_module(module)


@common.command("validate second.csv --with knee.toml")
@common.log_argument
@click.option(
    "--with",
    "config",
    required=True,
    type=common.FILE,
    help="Configuration with which `sigmahat estimate` read the first log.",
)
@click.option(
    "--start-from",
    type=common.PATH,
    help="Estimate to test: its folder, or state.json.  [default: sigmahat-results/CONFIG]",
)
@common.joint_option
@common.answer_options
def validate(log: Path, config: Path, start_from: Path | None, joint: str) -> int:
    """Check an estimate with LOG, another log of the same joint.

    LOG is replayed with the earlier stiffness, and without it. Exit status: 0 if the logs agree, 1
    if the logs disagree or decide nothing.
    """
    from sigmahat.result.validate import summary

    start_from = start_from or Path("sigmahat-results", config.stem)
    with common.errors_in_one_line(start_from, "--start-from"):
        job = partial(_validated, start_from)
        found = common.for_each_joint(log, config, joint, job)
    texts = {name: summary(each) for name, each in found.items()}
    common.answer_of_joints(texts, {name: each.as_dict() for name, each in found.items()})
    return 0 if all(each.agree for each in found.values()) else 1


def _validated(start_from: Path, log: Log, configuration: Configuration) -> Validation:
    from sigmahat.result.validate import validate

    learned = start_from / configuration.joint if start_from.is_dir() else start_from
    return validate(log, configuration, learned)


_START_VALUES = {"ssv": ".ssv", "matlab": ".m", "modelica": ".mo"}
_MODELS = {"mjcf": ".xml", "sdf": ".sdf", "urdf": ".urdf", "drake": ".drake.sdf"}
_SUFFIXES = {**_START_VALUES, **_MODELS}


@common.command("export sigmahat-results/knee --to mjcf")
@click.argument("sheet", type=common.PATH)
@click.option(
    "--to",
    required=True,
    type=click.Choice(list(_SUFFIXES)),
    help="Format. Start values of the FMU: ssv (for SSP), matlab or modelica. "
    "Model of the joint: mjcf (MuJoCo), sdf (Gazebo), urdf, drake (SDF for Drake).",
)
@click.option(
    "--out",
    type=common.FILE,
    help=f"File to write.  [default: SHEET with the suffix {', '.join(_SUFFIXES.values())}]",
)
@common.force_option
@common.quiet_option
def export(sheet: Path, to: str, out: Path | None, force: bool) -> None:
    """Write the data sheet of a joint as start values of the FMU, or as a joint for a simulator.

    SHEET is the joint.json that `sigmahat estimate` wrote, or its folder. An FMU with these start
    values begins with the estimated stiffness. The joint has two hinges, motor and
    flexibility, with the intervals of all parameters. A folder of several joints gives a file in
    the folder of each joint.
    """
    from sigmahat.result.estimate import JOINTS, read_joints
    from sigmahat.result.sheet import FORMAT

    common.need_fmus("StiffnessEstimator")
    sheets = [sheet]
    if (sheet / JOINTS).is_file():
        with common.errors_in_one_line(sheet, "SHEET"):
            names, _ = read_joints(sheet)
        if out is not None:
            raise click.UsageError(
                f"--out FILE is for one joint, and {sheet} has {', '.join(names)}: omit --out, or "
                f"name one of them, such as {sheet / names[0]}"
            )
        sheets = [sheet / name for name in names]
    paths = [out or FORMAT.path(each).with_suffix(_SUFFIXES[to]) for each in sheets]
    for path in paths:
        common.refuse_to_overwrite(path, force, "--out")
    for each, path in zip(sheets, paths, strict=True):
        _exported(each, to, path)


def _exported(sheet: Path, to: str, path: Path) -> None:
    """Writes the file of one joint, and says so."""
    from sigmahat.fmi.model import installed_model
    from sigmahat.result import parameter_file
    from sigmahat.result.robot_model import write_model
    from sigmahat.result.sheet import FORMAT

    with common.errors_in_one_line(path, "--out FILE"):
        contents = FORMAT.read(sheet)
        if to in _MODELS:
            write_model(contents, to, path)
            text = f"{path.resolve()} has the joint, as two hinges; its link is a placeholder"
        else:
            parameter_file.write(contents, installed_model("StiffnessEstimator"), to, path)
            text = f"{len(contents.start_values)} start values are in {path.resolve()}"
    common.answer(text)


@common.command("report sigmahat-results/table1")
@click.argument("folder", type=common.PATH)
@click.option("--out", type=common.FILE, help="File to write.  [default: report.html in FOLDER]")
@common.quiet_option
def report(folder: Path, out: Path | None) -> None:
    """Make one HTML file of the results in FOLDER, with plots to zoom.

    FOLDER is what `sigmahat reproduce`, `estimate` or `sweep` wrote. The file opens offline. For
    several joints, each joint gets a report in its own folder, too.
    """
    from sigmahat.files.output import write_whole
    from sigmahat.report.contents import REPORT
    from sigmahat.report.page import joints_of
    from sigmahat.report.page import report as make

    import_module("bokeh")  # report a missing package before the work
    out = out or folder / REPORT
    with common.errors_in_one_line(out, "--out FILE"):
        for joint in joints_of(folder):
            write_whole(make(joint, joint / REPORT), joint / REPORT)
        text = make(folder, out)
        write_whole(text, out)
    common.answer(f"{out.resolve()} ({len(text.encode()) / 1e6:.1f} MB)")
