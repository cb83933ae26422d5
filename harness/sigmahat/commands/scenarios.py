"""sigmahat scenarios"""

from __future__ import annotations

import click


@click.command()
def scenarios() -> None:
    """List the scenarios."""
    from sigmahat.scenarios import SCENARIOS

    width = max(map(len, SCENARIOS)) + 2
    for scenario in SCENARIOS.values():
        click.echo(f"{scenario.name:{width}}{scenario.description}")
