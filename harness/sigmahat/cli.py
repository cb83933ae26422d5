"""Command line: the group of all commands, and how an error ends them."""

import sys
import warnings
from collections.abc import Sequence

import click

from sigmahat.commands.common import printable
from sigmahat.commands.configure import check, identify, init, open_page
from sigmahat.commands.health import health
from sigmahat.commands.live import live
from sigmahat.commands.motion import motion
from sigmahat.commands.results import estimate, export, report, validate
from sigmahat.commands.simulations import compare, reproduce, scenarios, sweep

_ERROR, _INTERRUPTED = 2, 130
_LONGEST = 5000  # characters of an error: more than the names of all parameters


@click.group(
    context_settings={"help_option_names": ["-h", "--help"]}, epilog="Example: sigmahat reproduce"
)
@click.version_option(package_name="sigmahat", message="%(prog)s %(version)s")
def cli() -> None:
    """Stiffness of robot joints, estimated by FMUs.

    Exit status: 0 done; 1 validate: the logs do not agree,
    check: something is wrong, health: something changed; 2 error, one line on stderr says
    which; 130 interrupted.
    """


for command in (
    *(reproduce, compare, scenarios, init, open_page, check, motion),
    *(identify, estimate, live, validate, health, export, sweep, report),
):
    cli.add_command(command)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line and returns the exit status; an error is one line on stderr."""
    try:
        with warnings.catch_warnings():
            # numpy warns of values that are not finite; the commands report them themselves.
            warnings.simplefilter("ignore", RuntimeWarning)
            status = int(cli.main(arguments, prog_name="sigmahat", standalone_mode=False) or 0)
        sys.stdout.flush()
        return status
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message(), err=True)
        return _ERROR
    except click.ClickException as error:
        said = printable(" ".join(error.format_message().split()))
        if len(said) > _LONGEST:
            said = f"{said[:_LONGEST]} ..."
        click.echo(f"sigmahat: error: {said}", err=True)
        return _ERROR
    except ModuleNotFoundError as error:
        from sigmahat.fmi.installed import how_to_install

        text = how_to_install(error.name)
        if text is None:
            raise
        click.echo(f"sigmahat: error: {text}", err=True)
        return _ERROR
    except OSError as error:  # from stdout: a command reports errors of its files itself
        sys.stdout = None  # or Python would try to write the remaining output at exit
        click.echo(f"sigmahat: error: cannot write the output: {error.strerror}", err=True)
        return _ERROR
    except (click.Abort, KeyboardInterrupt):
        click.echo("sigmahat: interrupted", err=True)
        return _INTERRUPTED
