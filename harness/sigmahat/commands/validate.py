"""sigmahat validate"""

from __future__ import annotations

from pathlib import Path

import click

from sigmahat.commands import common


@click.command()
@click.argument("log", type=click.Path(path_type=Path))
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
    from sigmahat.validation.summary import summary
    from sigmahat.validation.validate import validate as run

    common.need_fmu("StiffnessEstimator")
    start_from = start_from or Path("sigmahat-results", config.stem)
    with common.errors_in_one_line(start_from, "--start-from"):
        opened = open_log(log)
        result = run(opened, read_configuration(config), start_from)
    common.answer(summary(result), result.as_dict())
    return 0 if result.agree else 1
