"""Commands that make a configuration and look at it: init, open, check, identify."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sigmahat.commands import common

if TYPE_CHECKING:
    from sigmahat.guessing.guess import JointGuess


@click.command()
@common.log_argument
@common.config_option("File to write.")
@click.option(
    "--joint",
    metavar="NAME",
    help="Only this one of the joints of LOG, as its columns name it.  [default: each of them]",
)
@click.option("--force", is_flag=True, help="Overwrite the file if it exists.")
@common.quiet_option
def init(log: Path, config: Path | None, joint: str | None, force: bool) -> None:
    """Write a configuration for LOG, to be checked and completed.

    LOG is CSV, Parquet, MAT, HDF5, MCAP or a ROS 2 bag. Ports, units, signs and gear are guessed
    from names and values of the columns. What cannot be guessed is marked with FILL IN.

    For a log of several joints, one file for each of them is written, LOG-JOINT.toml.

    \b
    Example: sigmahat init knee.csv
    """
    from sigmahat.files.output import write_whole
    from sigmahat.fmi.opened import installed
    from sigmahat.guessing import template
    from sigmahat.guessing.guess import guess, one_joint
    from sigmahat.logs.readers.formats import open_log

    common.need_fmu("StiffnessEstimator")
    one = config or common.configuration_of(log)
    with common.errors_in_one_line(one, "--config"):
        opened = open_log(log)
        guessed = guess(opened)
        if joint is not None:
            guessed = {"": one_joint(opened, guessed, joint)}
        files = _files(one, guessed, named=config is not None)
        for path in files.values():
            if path.exists() and not force:
                raise click.ClickException(
                    f"{path} exists; --force overwrites it, --config names another file"
                )
        fmu = installed("StiffnessEstimator")
        motor = {n: float(fmu.variable(n).start) for n in ("motor.B", "motor.D_theta")}
        for name, path in files.items():
            write_whole(template.write(opened, guessed[name], motor), path)
    common.answer("\n\n".join(_text(log, guessed[name], path) for name, path in files.items()))


def _files(one: Path, joints: Mapping[str, JointGuess], named: bool) -> dict[str, Path]:
    """The file of each joint."""
    if len(joints) == 1:
        return dict.fromkeys(joints, one)
    if named:
        names = ", ".join(joints)
        raise click.ClickException(
            f"--config names one file, but the log has several joints ({names}); "
            "choose one with --joint"
        )
    return {name: one.with_name(f"{one.stem}-{name}{one.suffix}") for name in joints}


def _text(log: Path, joint: JointGuess, path: Path) -> str:
    """What was guessed, and what is next."""
    from sigmahat.guessing.template import period_of

    lines = [f"joint {joint.name}"] if joint.name else []
    lines += [
        f"{port:13} {each.column} [{each.unit or 'unit not known'}]"
        for port, each in joint.ports.items()
    ]
    text = path.read_text(encoding="utf-8")
    asked = sum("FILL IN" in line for line in text.splitlines() if not line.startswith("#"))
    option = "" if path == common.configuration_of(log) else f" --config {path}"
    values = "value" if asked == 1 else "values"
    fill_in = f"fill in {asked} {values} (FILL IN)" if asked else "nothing to fill in"
    period = period_of(joint)
    if "CHECK" in period:
        lines.append(period.removeprefix("[s] "))
    then = "estimate" if "tau" not in joint.ports and "tau_e_sensor" in joint.ports else "identify"
    lines += ["", f"Check {path}, {fill_in}, then: sigmahat {then} {log}{option}"]
    return "\n".join(lines)


@click.command("open")
@common.log_argument
@common.config_option("File to start from and to write.")
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=0,
    help="Port of this computer to serve the page at.  [default: any that is free]",
)
def open_page(log: Path, config: Path | None, port: int) -> None:
    """Set up LOG in the browser: columns, units and signs, with checks and the curve below.

    The page is served on this computer alone, at an address with a token, until Ctrl-C. It writes
    the same file as `sigmahat init` and an editor do.

    \b
    Example: sigmahat open knee.csv
    """
    from sigmahat.logs.configuration import read_document
    from sigmahat.logs.readers.formats import open_log
    from sigmahat.page.server import serve

    common.need_fmu("StiffnessEstimator")
    path = config or common.configuration_of(log)
    with common.errors_in_one_line(path, "--config"):
        opened = open_log(log)
        document = read_document(path) if path.exists() else None
        drafts = serve(opened, path, document, port, click.echo)
    for draft in drafts:
        click.echo(f"Edits that were not written are in {draft}; to go on from them:")
        click.echo(f"  sigmahat open {log} --config {draft}")


@click.command()
@common.log_argument
@common.config_option("File from `sigmahat init`.")
@common.json_option
@common.quiet_option
def check(log: Path, config: Path | None) -> int:
    """Say what in the configuration of LOG is likely wrong, and which key to look at.

    Signs, units, gear ratios, zeros and delays show in the log; what no log can show is listed.
    Exit status: 0 if nothing contradicts the log, 1 if something does.

    \b
    Example: sigmahat check knee.csv --config knee.toml
    """
    from sigmahat.checks.check import check as run
    from sigmahat.checks.findings import as_dict
    from sigmahat.checks.text import summary
    from sigmahat.logs.configuration import read_configuration
    from sigmahat.logs.readers.formats import open_log

    common.need_fmu("StiffnessEstimator")
    config = config or common.configuration_of(log)
    with common.errors_in_one_line(config, "--config"):
        checked = run(open_log(log), read_configuration(config))
    common.answer(f"{log} with {config}\n{summary(checked)}", as_dict(checked))
    return 1 if checked.is_wrong else 0


@click.command()
@common.log_argument
@common.config_option("It is read, then updated.")
@click.option(
    "--torque-constant",
    is_flag=True,
    help="Also identify K_t; needs tau in A, and a torque sensor, which is taken as exact.",
)
@click.option("--dry-run", is_flag=True, help="Do not change the configuration.")
@common.json_option
@common.quiet_option
def identify(log: Path, config: Path | None, torque_constant: bool, dry_run: bool) -> None:
    """Identify B, D_theta and Coulomb friction from LOG; write them into the configuration.

    A value that the motion does not determine is not written: "cannot tell". Comments are kept.

    \b
    Example: sigmahat identify knee.csv --config knee.toml
    """
    from sigmahat.checks.check import check_identified
    from sigmahat.checks.findings import as_dict as checks_as_dict
    from sigmahat.checks.text import IN_LOG
    from sigmahat.checks.text import summary as of_checks
    from sigmahat.identification.identify import identify as run
    from sigmahat.identification.quantities import as_dict, summary
    from sigmahat.identification.write import write
    from sigmahat.logs.configuration import read_configuration
    from sigmahat.logs.readers.formats import open_log

    common.need_fmu("StiffnessEstimator")
    config = config or common.configuration_of(log)
    with common.errors_in_one_line(config, "--config"):
        opened = open_log(log)
        before = read_configuration(config)
        found = run(opened, before, torque_constant)
        written: list[str] = []
        if not dry_run:
            written = write(found, config)
        checked = check_identified(opened, before, read_configuration(config))
    text = f"{log}\n{summary(found)}"
    if written:
        text += f"\n\nWritten into {config}: {', '.join(written)}"
    text += f"\n\n{of_checks(checked, IN_LOG)}"
    values = {**as_dict(found), "written": written, "checks": checks_as_dict(checked)}
    common.answer(text, values)
