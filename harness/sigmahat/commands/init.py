"""sigmahat init"""

from __future__ import annotations

from pathlib import Path

import click

from sigmahat.commands import common


@click.command()
@click.argument("log", type=click.Path(path_type=Path))
@click.option(
    "--config",
    type=click.Path(path_type=Path, dir_okay=False),
    help="File to write.  [default: LOG with the suffix .toml, in this folder]",
)
@click.option("--force", is_flag=True, help="Overwrite the file if it exists.")
@common.quiet_option
def init(log: Path, config: Path | None, force: bool) -> None:
    """Write a configuration for LOG, to be checked and completed.

    LOG is CSV, Parquet, MAT, HDF5, MCAP or a ROS 2 bag. The port of a column is guessed by name.

    \b
    Example: sigmahat init knee.csv
    """
    from sigmahat.files.whole_file import write_whole
    from sigmahat.fmi.installed import fmu as installed_fmu
    from sigmahat.fmi.instance import Fmu
    from sigmahat.logs import template
    from sigmahat.logs.guess import guess
    from sigmahat.logs.readers.formats import open_log

    common.need_fmu("StiffnessEstimator")
    config = config or common.configuration_of(log)
    if config.exists() and not force:
        raise click.ClickException(
            f"{config} exists; --force overwrites it, --config names another file"
        )
    with common.errors_in_one_line(config, "--config"):
        with Fmu(installed_fmu("StiffnessEstimator")) as fmu:
            names = ("motor.B", "motor.D_theta", "motor.gamma")
            motor = {name: float(fmu.variable(name).start) for name in names}
        opened = open_log(log)
        guessed = guess(opened)
        write_whole(template.write(opened, guessed, motor), config)
    ports = (f"{port:13} {each.column} [{each.unit}]" for port, each in guessed.ports.items())
    then = f"Check {config}, fill in what it asks for, then: sigmahat estimate {log}"
    common.answer("\n".join([*ports, "", then]))
