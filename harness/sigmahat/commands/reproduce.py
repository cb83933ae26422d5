"""sigmahat reproduce"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import click

from sigmahat.commands import common


def _names(_: click.Context, __: click.Parameter, begin: str) -> list[str]:
    """Scenarios, for the completion of the shell."""
    from sigmahat.paper.scenarios import SCENARIOS

    return [name for name in SCENARIOS if name.startswith(begin)]


@click.command()
@click.option(
    "--scenario",
    "name",
    default="table1",
    show_default=True,
    shell_complete=_names,
    help="What to run.",
)
@click.option(
    "--seeds",
    default=1,
    show_default=True,
    type=click.IntRange(min=1),
    help="Number of runs, each with other noise.",
)
@click.option(
    "--out",
    callback=common.folder,
    help="Folder for figures and CSV files.  [default: sigmahat-results/SCENARIO]",
)
@common.json_option
@common.quiet_option
def reproduce(name: str, seeds: int, out: Path | None) -> None:
    """Run a scenario; print its table, draw its figures.

    \b
    Example: sigmahat reproduce --scenario as-printed --seeds 20 --out as-printed
    """
    from sigmahat.files.output_folder import output_folder
    from sigmahat.paper.reproduction import progress_length, reproduce
    from sigmahat.paper.result_files import as_dict, write_results
    from sigmahat.paper.table import conditions, table
    from sigmahat.runs.metrics import MSREP_IN_WORDS

    chosen = common.ready_scenario(name)
    if seeds > 1:
        import_module("scipy")  # intervals need it; if it is not there, say so before the runs
    out = out or Path("sigmahat-results", name)
    numbers = range(1, seeds + 1)
    with common.errors_in_one_line(out), output_folder(out) as folder:
        with common.progress("Running", progress_length(chosen, numbers)) as bar:
            result = reproduce(chosen, numbers, progress=bar.update)
        from sigmahat.paper.figures.catalogue import FIGURES
        from sigmahat.plotting.save import save

        with common.progress("Drawing", len(chosen.figures)) as bar:
            for title in chosen.figures:
                save(FIGURES[title], result.recording, folder / title)
                bar.update(1)
        write_results(result, folder)

    common.answer(
        f"{chosen.name}: {chosen.description}\n{conditions(result)}\n{MSREP_IN_WORDS}\n\n"
        f"{table(result)}\n\nFigures (PNG, SVG) and CSV files are in {out.resolve()}",
        as_dict(result),
    )
