"""sigmahat init"""

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
    from sigmahat.files.whole_file import write_whole
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
    lines = [f"joint {joint.name}"] if joint.name else []
    lines += [
        f"{port:13} {each.column} [{each.unit or 'unit not known'}]"
        for port, each in joint.ports.items()
    ]
    text = path.read_text(encoding="utf-8")
    asked = sum("FILL IN" in line for line in text.splitlines() if not line.startswith("#"))
    option = "" if path == common.configuration_of(log) else f" --config {path}"
    fill_in = f"fill in {asked} values (FILL IN)" if asked else "nothing to fill in"
    then = "estimate" if "tau" not in joint.ports and "tau_e_sensor" in joint.ports else "identify"
    lines += ["", f"Check {path}, {fill_in}, then: sigmahat {then} {log}{option}"]
    return "\n".join(lines)
