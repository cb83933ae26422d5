"""sigmahat scenarios"""

from __future__ import annotations

import click

from sigmahat.commands import common


@click.command()
@common.json_option
def scenarios() -> None:
    """List the scenarios.

    \b
    Example: sigmahat scenarios --json
    """
    from sigmahat.paper.scenarios import SCENARIOS

    width = max(map(len, SCENARIOS)) + 2
    every = SCENARIOS.values()
    common.answer(
        "\n".join(f"{each.name:{width}}{each.description}" for each in every),
        [{"name": each.name, "description": each.description} for each in every],
    )
