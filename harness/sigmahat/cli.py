"""Command line. Imports what a command needs when it runs, so that --help is quick."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

_ERROR, _INTERRUPTED = 2, 130


def _folder(_: click.Context, __: click.Parameter, name: str | None) -> Path | None:
    """A folder to write into. An empty name is what a shell makes of a variable not set."""
    if name == "":
        raise click.BadParameter("expected a folder, got an empty name.")
    if name is not None and Path(name).is_file():
        raise click.BadParameter(f"{name} is a file; name a folder.")
    return None if name is None else Path(name)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="sigmahat", message="%(prog)s %(version)s")
def cli() -> None:
    """Stiffness of robot joints, estimated by FMUs."""


@cli.command()
def scenarios() -> None:
    """List the scenarios."""
    from sigmahat.scenarios import SCENARIOS

    width = max(map(len, SCENARIOS)) + 2
    for scenario in SCENARIOS.values():
        click.echo(f"{scenario.name:{width}}{scenario.description}")


@cli.command()
@click.option("--scenario", "name", default="table1", show_default=True, help="What to run.")
@click.option(
    "--seeds",
    default=1,
    show_default=True,
    type=click.IntRange(min=1),
    help="Number of runs, each with other noise.",
)
@click.option(
    "--out",
    callback=_folder,
    help="Folder for figures and CSV files.  [default: sigmahat-results/SCENARIO]",
)
def reproduce(name: str, seeds: int, out: Path | None) -> None:
    """Run a scenario; print its table, draw its figures.

    Example: sigmahat reproduce --scenario as-printed --seeds 20 --out as-printed
    """
    import sigmahat
    from sigmahat import results
    from sigmahat.reproduce import reproduce, work
    from sigmahat.scenarios import scenario
    from sigmahat.slave import FmuError

    try:
        chosen = scenario(name)
    except ValueError as error:
        raise click.UsageError(str(error)) from error
    for fmu in {chosen.plant.fmu, *(e.fmu for e in chosen.estimators.values())}:
        try:
            sigmahat.fmu(fmu)
        except FileNotFoundError as error:
            raise click.ClickException(_not_built(fmu)) from error

    out = out or Path("sigmahat-results", name)
    numbers = range(1, seeds + 1)
    try:
        with results.folder(out) as folder:
            with _progress("Running", work(chosen, numbers)) as bar:
                result = reproduce(chosen, numbers, progress=bar.update)
            from sigmahat.figures import FIGURES, save

            with _progress("Drawing", len(chosen.figures)) as bar:
                for title in chosen.figures:
                    save(FIGURES[title], result.recording, folder / title)
                    bar.update(1)
            results.write_table(result, folder / "table.csv")
            for modality in chosen.estimators:
                results.write_series(result.recording, modality, folder / f"{modality}.csv")
    except (FmuError, ValueError) as error:
        raise click.ClickException(str(error)) from error
    except OSError as error:
        where = f"cannot write {error.filename or out}: {error.strerror or error}"
        raise click.ClickException(f"{where}; choose another folder with --out") from error

    click.echo(f"{chosen.name}: {chosen.description}")
    click.echo(f"{results.conditions(result)}\n")
    click.echo(results.table(result))
    click.echo(f"\nFigures (PNG, SVG) and CSV files are in {out.resolve()}")


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line and returns the exit status; an error is one line on stderr."""
    try:
        status = int(cli.main(arguments, prog_name="sigmahat", standalone_mode=False) or 0)
        sys.stdout.flush()
        return status
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message(), err=True)
        return _ERROR
    except click.ClickException as error:
        click.echo(f"sigmahat: error: {' '.join(error.format_message().split())}", err=True)
        return _ERROR
    except OSError as error:  # what a command writes to files it answers for itself
        sys.stdout = None  # or Python would try to write the rest at its end
        click.echo(f"sigmahat: error: cannot write the output: {error.strerror}", err=True)
        return _ERROR
    except click.Abort:
        click.echo("sigmahat: interrupted", err=True)
        return _INTERRUPTED


def _progress(label: str, length: int) -> Any:
    """A progress bar on stderr, hidden where nobody sees it."""
    return click.progressbar(
        length=length, label=label, file=sys.stderr, hidden=not sys.stderr.isatty()
    )


def _not_built(fmu: str) -> str:
    build = "run `cmake --workflow --preset build`"
    if not any(map(shutil.which, ("cc", "gcc", "clang"))):
        build = f"install a C compiler (gcc or clang), then {build}"
    return f"{fmu}.fmu is not built: {build}"
