"""Commands that make a configuration and look at it: init, open, check, identify."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sigmahat.commands import common

if TYPE_CHECKING:
    from sigmahat.checks.findings import Checked
    from sigmahat.guess.guess import JointGuess
    from sigmahat.motor.quantities import Identified
    from sigmahat.recording.configuration import Configuration
    from sigmahat.recording.log import Log


@common.command("init knee.csv")
@common.log_argument
@common.config_option("File to write.")
@click.option(
    "--joint",
    metavar="NAME",
    help="Only this joint of LOG, with its name in the columns.  [default: every joint]",
)
@common.force_option
@common.quiet_option
def init(log: Path, config: Path, joint: str | None, force: bool) -> None:
    """Write a configuration for LOG, to be checked and completed.

    LOG is CSV, Parquet, MAT, HDF5, MCAP or a ROS 2 bag. Ports, units, signs and gear are guessed
    from names and values of the columns. FILL IN marks values that cannot be guessed.

    For a log of several joints, the file has a section for each joint, and common values once.
    """
    from sigmahat.files.output import write_whole
    from sigmahat.guess import template
    from sigmahat.guess.columns import read_columns
    from sigmahat.guess.guess import guess, one_joint
    from sigmahat.recording.readers.formats import open_log

    common.need_fmus("StiffnessEstimator")
    with common.errors_in_one_line(config, "--config"):
        opened = open_log(log)
        columns = read_columns(opened)
        guessed = guess(columns)
        if joint is not None:
            guessed = {"": one_joint(opened, guessed, joint)}
        common.refuse_to_overwrite(config, force, "--config")
        write_whole(template.write(opened, columns, guessed), config)
    notes = [*(note.in_words for note in opened.notes), *columns.unreadable]
    for each in guessed.values():
        silent = template.silent_torque(columns, each)
        if silent is not None:
            notes.append(f"column {silent!r} is the same throughout: the log has no torque")
    common.answer("\n".join([*notes, _text(log, guessed, config)]))


def _text(log: Path, joints: Mapping[str, JointGuess], path: Path) -> str:
    lines = [line for joint in joints.values() for line in _guessed(joint)]
    text = path.read_text(encoding="utf-8")
    asked = sum("FILL IN" in line for line in text.splitlines() if not line.startswith("#"))
    option = "" if path == common.configuration_of(log) else f" --config {path}"
    values = "value" if asked == 1 else "values"
    fill_in = f"fill in {asked} {values} (FILL IN)" if asked else "nothing to fill in"
    lines += [f"Check {path}, {fill_in}, then: sigmahat identify {log}{option}"]
    return "\n".join(lines)


def _guessed(joint: JointGuess) -> Iterator[str]:
    from sigmahat.guess.template import period_of

    if joint.name:
        yield f"joint {joint.name}"
    for port, each in joint.ports.items():
        unit = "unit not known" if each.unit is None or each.is_asked else each.unit
        yield f"{port:13} {each.column} [{unit}]"
    if not {"theta", "q"} & joint.ports.keys():
        yield "no position moves: the joint is at rest, or the log has no column of a position"
    elif {"theta", "tau"} <= joint.ports.keys() and not {"q", "phi"} & joint.ports.keys():
        yield "no position of a link moves: it is locked, its encoder is dead, or not recorded"
    period = period_of(joint)
    if "CHECK" in period:
        yield period.removeprefix("[s] ")
    yield ""


@common.command("open knee.csv", name="open")
@common.log_argument
@common.config_option("File to start from and to write.")
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=0,
    help="Port of this computer to serve the page at.  [default: any that is free]",
)
def open_page(log: Path, config: Path, port: int) -> None:
    """Set up LOG in the browser: columns, units and signs, with checks and the curve below.

    The page is served on this computer alone, at an address with a token, until Ctrl-C. The page
    writes the same file as `sigmahat init`.
    """
    from sigmahat.recording.configuration import read_document
    from sigmahat.recording.readers.formats import open_log
    from sigmahat.setup_page.server import serve

    common.need_fmus("StiffnessEstimator")
    with common.errors_in_one_line(config, "--config"):
        opened = open_log(log)
        document = read_document(config) if config.exists() else None
        draft = serve(opened, config, document, port, click.echo)
    if draft is not None:
        click.echo(f"Edits that were not written are in {draft}; to go on from them:")
        click.echo(f"  sigmahat open {log} --config {draft}")


@common.command("check knee.csv --config knee.toml")
@common.log_argument
@common.config_option("File from `sigmahat init`.")
@common.joint_option
@common.answer_options
def check(log: Path, config: Path, joint: str) -> int:
    """Find likely errors in the configuration of LOG, and name the keys to look at.

    Errors of signs, units, gear ratios, zeros and delays are found. The command also lists what no
    log can show. Exit status: 0 if nothing contradicts the log, 1 if something does.
    """
    from sigmahat.checks.check import check
    from sigmahat.checks.findings import as_dict
    from sigmahat.checks.text import summary

    with common.errors_in_one_line(config, "--config"):
        checked = common.for_each_joint(log, config, joint, check)
    texts = {name: f"{log} with {config}\n{summary(each)}" for name, each in checked.items()}
    common.answer_of_joints(texts, {name: as_dict(each) for name, each in checked.items()})
    return 1 if any(each.is_wrong for each in checked.values()) else 0


@common.command("identify knee.csv --config knee.toml")
@common.log_argument
@common.config_option("File to read and to update.")
@common.joint_option
@click.option(
    "--torque-constant",
    is_flag=True,
    help="Also identify K_t; needs tau in A, and a torque sensor, which is taken as exact.",
)
@click.option("--dry-run", is_flag=True, help="Do not change the configuration.")
@common.answer_options
def identify(log: Path, config: Path, joint: str, torque_constant: bool, dry_run: bool) -> None:
    """Identify B, D_theta and Coulomb friction from LOG; write them into the configuration.

    A value that the motion does not determine is not written, but reported. Comments are kept.
    """
    import tomlkit

    from sigmahat.checks.findings import as_dict as checks_as_dict
    from sigmahat.checks.text import summary as of_checks
    from sigmahat.files.output import write_whole
    from sigmahat.motor.quantities import as_dict, summary
    from sigmahat.motor.write import update
    from sigmahat.recording.configuration import read_document

    texts, values = {}, {}
    with common.errors_in_one_line(config, "--config"):
        job = partial(_identified, torque_constant, dry_run)
        every = common.for_each_joint(log, config, joint, job)
        document = read_document(config)
        for name, (found, checked) in every.items():
            written = [] if dry_run else update(document, found, name)
            texts[name] = f"{log}\n{summary(found)}"
            if written:
                texts[name] += f"\n\nWritten into {config}: {', '.join(written)}"
            texts[name] += f"\n\n{of_checks(checked)}"
            values[name] = {**as_dict(found), "written": written, "checks": checks_as_dict(checked)}
        if not dry_run:
            write_whole(tomlkit.dumps(document), config)
    common.answer_of_joints(texts, values)


def _identified(
    torque_constant: bool, dry_run: bool, log: Log, before: Configuration
) -> tuple[Identified, Checked]:
    """The identified values of a joint, and the checks with these values; no file is written."""
    from sigmahat.checks.check import check_identified
    from sigmahat.motor.identify import identify
    from sigmahat.motor.write import update
    from sigmahat.recording.configuration import checked_configuration, read_document

    document = read_document(before.path)
    found = identify(log, before, torque_constant)
    if not dry_run:
        update(document, found, before.joint)
    after = checked_configuration(document, before.path, before.joint)
    return found, check_identified(log, before, after)
