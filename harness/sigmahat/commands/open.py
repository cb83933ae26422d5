"""sigmahat open"""

from __future__ import annotations

from pathlib import Path

import click

from sigmahat.commands import common


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
