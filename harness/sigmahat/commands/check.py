"""sigmahat check"""

from __future__ import annotations

from pathlib import Path

import click

from sigmahat.commands import common


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
