"""Defines common parts of the commands: options, output folder, progress, and one-line errors.

A command with `@answer_options` ends with `answer(text, values)`, which handles these options.
"""

from __future__ import annotations

import json
import logging
import re
import shutil
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from sigmahat.recording.configuration import Configuration
    from sigmahat.recording.log import Log

FILE, PATH = click.Path(path_type=Path, dir_okay=False), click.Path(path_type=Path)
COUNT = click.IntRange(min=1)
option = partial(click.option, show_default=True)
_Command = TypeVar("_Command", bound=Callable[..., object])
_Result = TypeVar("_Result")
_CALL = re.compile(r"^\w+: (?:fmi\w+: )?[Pp]arameter")
"""Instance and function in an FMU's message about a parameter: users do not know either."""
_JSON, _QUIET = "sigmahat.json", "sigmahat.quiet"


def _for_scripts(context: click.Context, parameter: click.Parameter, given: bool) -> None:
    """Callback of --json and --quiet: keeps them for `answer`, and switches warnings off."""
    context.meta[f"sigmahat.{parameter.name}"] = given
    if given:
        logger = logging.getLogger("sigmahat")
        context.call_on_close(lambda level=logger.level: logger.setLevel(level))
        logger.setLevel(logging.ERROR)


def command(example: str, **more: Any) -> Callable[[Callable[..., object]], click.Command]:
    """Creates a command like click.command, with an example at the end of the help."""
    return click.command(epilog=f"\b\nExample: sigmahat {example}", **more)


log_argument = click.argument("log", type=PATH)
joint_option = click.option(
    "--joint",
    metavar="NAME",
    default="",
    help="Only this joint of the configuration.  [default: every joint]",
)
force_option = click.option("--force", is_flag=True, help="Overwrite the file if it exists.")


def config_option(what: str) -> Callable[[_Command], _Command]:
    def path(context: click.Context, _: click.Parameter, given: Path | None) -> Path:
        return given or configuration_of(context.params["log"])

    text = f"{what}  [default: LOG with the suffix .toml, beside it]"
    return click.option("--config", type=FILE, callback=path, help=text)


def out_option(what: str, default: str) -> Callable[[_Command], _Command]:
    """Gives a command the option --out, a folder; {log} in `default` is the stem of LOG.

    An empty name is refused: a shell passes an empty name if a variable is not set.
    """

    def folder(context: click.Context, _: click.Parameter, name: str | None) -> Path:
        if name is None:
            stems = {key: Path(str(value)).stem for key, value in context.params.items()}
            return Path("sigmahat-results", default.format(**stems))
        if name == "":
            raise click.BadParameter("expected a folder, got an empty name.")
        if Path(name).is_file():
            raise click.BadParameter(f"expected a folder, got the file {name}.")
        return Path(name)

    shown = re.sub("{(.*?)}", lambda parameter: parameter[1].upper(), default)
    text = f"{what}  [default: sigmahat-results/{shown}]"
    return click.option("--out", callback=folder, help=text)


class ChangeLimit(click.ParamType[tuple[str, float]]):
    """A limit such as stiffness=-10% or backlash=+0.5mrad: a quantity, and a relative change of it;
    of the backlash a change [rad]."""

    name = "QUANTITY=CHANGE"

    def __init__(self, *quantities: str) -> None:
        self._quantities = quantities

    def convert(
        self, value: Any, param: click.Parameter | None, context: click.Context | None
    ) -> tuple[str, float]:
        name, _, change = str(value).partition("=")
        unit = "mrad" if name == "backlash" else "%"
        try:
            number = float(change.removesuffix(unit))
        except ValueError:
            number = 0.0
        if name not in self._quantities or not change.endswith(unit) or not 0 < abs(number) < 1e6:
            examples = {"stiffness": "stiffness=-10%", "backlash": "backlash=+0.5mrad"}
            others = [examples.get(each, f"{each}=+20%") for each in self._quantities]
            is_bare = name in self._quantities and number != 0 and not change.endswith(unit)
            hint = f", without {unit}: did you mean {name}={change}{unit}?" if is_bare else "."
            self.fail(f"expected {', '.join(others)}; got {str(value)!r}{hint}", param, context)
        if unit == "%" and number <= -100:
            expected = f"expected a change above -100 %, such as {name}=-10%"
            self.fail(f"{expected}; got {str(value)!r}.", param, context)
        return name, number * (1e-3 if unit == "mrad" else 1e-2)


def refuse_to_overwrite(path: Path, force: bool, option: str) -> None:
    """Raises ClickException if a file exists, and the user does not force the command."""
    if path.exists() and not force:
        text = f"{path} exists; --force overwrites it, {option} names another file"
        raise click.ClickException(text)


def for_each_joint(
    log: Path, config: Path, joint: str, job: Callable[[Log, Configuration], _Result]
) -> dict[str, _Result]:
    """Results of a job by joint: of the requested joint, else of each joint of the configuration.

    The job of several joints runs in other processes. If the file names no joint, its name is "".
    Raises LogError if the log or the configuration cannot be read, ClickException if the FMU of the
    estimator is not built, and errors of the job.
    """
    from sigmahat.recording.configuration import joints_of, read_document
    from sigmahat.recording.readers.formats import need_log

    need_fmus("StiffnessEstimator")
    need_log(log)  # a missing log is reported before a missing configuration
    joints = [joint] if joint else joints_of(read_document(config), config)
    if len(joints) == 1:
        return {joints[0]: _of_joint(log, config, joints[0], job, "")}
    from sigmahat.experiments.pool import run_all

    jobs = [partial(_of_joint, log, config, joint, job, f"joint {joint}: ") for joint in joints]
    with progress("Joints", len(joints)) as bar:
        return dict(zip(joints, run_all(jobs, progress=bar.update), strict=True))


def _of_joint(
    log: Path, config: Path, joint: str, job: Callable[[Log, Configuration], _Result], place: str
) -> _Result:
    """The result of a job; place begins its errors."""
    from sigmahat.recording.configuration import read_configuration
    from sigmahat.recording.log import LogError
    from sigmahat.recording.readers.formats import open_log

    try:
        configuration = read_configuration(config, joint)
        return job(open_log(log, configuration.columns), configuration)
    except LogError as error:
        raise LogError(f"{place}{error}") from error


def answer_of_joints(texts: Mapping[str, str], values: Mapping[str, object]) -> None:
    """Prints the result of each joint; the result of a single joint without a name has no title."""
    if list(texts) == [""]:
        answer(texts[""], values[""])
    else:
        titled = (f"joint {name}\n{text}" for name, text in texts.items())
        answer("\n\n".join(titled), {"joints": values})


def _flag(name: str, text: str) -> Callable[[_Command], _Command]:
    return click.option(name, is_flag=True, expose_value=False, callback=_for_scripts, help=text)


json_option = _flag("--json", "Print the result as JSON, and no warnings.")
quiet_option = _flag("--quiet", "Print nothing but errors.")


def answer_options(command: _Command) -> _Command:
    return json_option(quiet_option(command))


def answer(text: str, values: object = None, head: str = "") -> None:
    """Prints the result: with --json the values, nan as null; with --quiet nothing; else the text.

    head  is printed before, in bold
    """
    options = click.get_current_context().meta
    if options.get(_JSON):
        from sigmahat.files.output import finite

        click.echo(json.dumps(finite(values), indent=2))
    elif not options.get(_QUIET):
        if head:
            click.secho(printable(head), bold=True)
        click.echo(printable(text))


def is_quiet() -> bool:
    """Whether only the result is to be printed: with --quiet or --json."""
    options = click.get_current_context().meta
    return bool(options.get(_QUIET) or options.get(_JSON))


def printable(text: str) -> str:
    """A text without characters that a terminal would execute, such as in the name of a column."""
    kept = "\n\t"
    return "".join(c if c.isprintable() or c in kept else repr(c)[1:-1] for c in text)


def progress(label: str, length: int) -> Any:
    """A progress bar on stderr, hidden after --quiet or if stderr is no terminal."""
    context = click.get_current_context(silent=True)  # None in the processes of joints
    hidden = context is None or context.meta.get(_QUIET) or not sys.stderr.isatty()
    return click.progressbar(length=length, label=label, file=sys.stderr, hidden=hidden)


def need_fmus(*names: str) -> None:
    """Raises ClickException, which says what to do, if one of these FMUs is not built."""
    from sigmahat.fmi.installed import fmu

    for name in names:
        try:
            fmu(name)
        except FileNotFoundError as error:
            build = "run `cmake --workflow --preset build`"
            if not any(map(shutil.which, ("cc", "gcc", "clang"))):
                build = f"install a C compiler (gcc or clang), then {build}"
            raise click.ClickException(f"{name}.fmu is not built: {build}") from error


@contextmanager
def errors_in_one_line(out: Path, option: str = "--out") -> Iterator[None]:
    """Context of a command that writes to `out`, given by `option`: errors become one line.

    Raises ClickException if an FMU refuses a value, a value does not fit, workers are lost, or a
    file or folder cannot be written.
    """
    from sigmahat.experiments.pool import WorkerError
    from sigmahat.fmi.model import FmuError

    try:
        yield
    except (FmuError, ValueError, WorkerError) as error:
        raise click.ClickException(_CALL.sub("parameter", str(error))) from error
    except OSError as error:
        kind = "folder" if option == "--out" else "file"
        where = f"cannot write {error.filename or out}: {error.strerror or error}"
        raise click.ClickException(f"{where}; choose another {kind} with {option}") from error


def configuration_of(log: Path) -> Path:
    """Default path of the configuration of a log: beside it, with the suffix .toml."""
    return log.parent / f"{log.stem}.toml"
