"""sigmahat identify"""

from __future__ import annotations

from pathlib import Path

import click

from sigmahat.commands import common


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
    from sigmahat.identification.summary import as_dict, summary
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
