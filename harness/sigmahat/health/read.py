"""Reads results of many logs: data sheets of `estimate`, or a table with a line for each result.

The table is JSON Lines. Reading it takes a tenth of the time of reading the data sheets.
"""

import gc
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, AwareDatetime, Field, TypeAdapter, ValidationError
from pydantic_core import to_json

from sigmahat.files.output import write_whole
from sigmahat.files.whole_file import read_whole
from sigmahat.fmi.quoted import cause, quoted
from sigmahat.health.logs import LogResult
from sigmahat.recording.recorded import possible_time
from sigmahat.recording.several_joints import NAMES, is_name
from sigmahat.result.excitation import Excitation
from sigmahat.result.sheet import FORMAT, Sheet, Together, consistent
from sigmahat.result.stored import NO_OTHER_KEYS, Digest, Text, Word, wrong_values

TABLE = "results.jsonl"  # name of a table of results in a folder
_LONGEST = 1_000_000_000  # bytes of a table
_LONGEST_NAME = 60  # characters of a name that is made from that of a folder
_OTHER_GEAR = 1e-6  # relative difference of gear ratios that are not of one joint


@dataclass(frozen=True)
class Results:
    """What was found in the folders."""

    results: Sequence[LogResult]
    without_time: Sequence[str]  # files of results whose time of recording is unknown
    without_interval: Sequence[str]  # files of results of a method without intervals
    unreadable: Sequence[str]  # for each damaged data sheet, or of another version: what to do


def _is_name(name: str) -> str:
    """Raises ValueError for a text that is no name of a joint."""
    if not is_name(name):
        raise ValueError(f"expected the name of a joint: {NAMES}")
    return name


@dataclass(frozen=True)
class _Line:
    """A line of the table."""

    __pydantic_config__ = NO_OTHER_KEYS

    joint: Annotated[Text, AfterValidator(_is_name)]
    time: Annotated[AwareDatetime, AfterValidator(possible_time)]
    place: Text
    digests: list[Digest]
    together: Annotated[Together, AfterValidator(consistent)]
    excitation: Excitation
    torque_gain: Annotated[float, Field(ge=0)]
    doubt: Word
    temperature: float | None = None


_LINE = TypeAdapter(_Line)


def read_results(
    places: Sequence[Path], progress: Callable[[int], object] = lambda done: None
) -> Results:
    """Reads all data sheets in folders, at any depth, and tables of results.

    places    folders, data sheets or tables of results
    progress  is given the number of files that were read since the last call

    A data sheet in a folder that is damaged or of another version is named in the results. Raises
    ValueError, which says what to do, for a place without results, for a table or a file named by
    itself that is damaged, if no data sheet can be read, and for different joints of one name.
    """
    found: list[LogResult] = []
    without_time, without_interval, unreadable = list[str](), list[str](), list[str]()
    gears: dict[str, tuple[float, str]] = {}
    for place in places:
        files = list(_files(place))
        if not files:
            raise ValueError(
                f"{place}: expected results of `sigmahat estimate` ({FORMAT.file}) or a table "
                f"{TABLE}, got none; estimate the logs first, or name --config"
            )
        for file in files:
            if file.suffix == ".jsonl":
                with _without_garbage_collection():
                    found += read_table(file)
            elif (sheet := _sheet(file, place, unreadable)) is not None:
                name = _name(sheet, place)
                _same_gear(gears, name, float(sheet.start_values["motor.gamma"]), file)
                if sheet.together is None:
                    without_interval.append(str(file))
                elif sheet.recorded.time is None:
                    without_time.append(str(file))
                else:
                    found.append(_of_sheet(sheet, name, file, sheet.together))
            progress(1)
    if unreadable and not (found or without_time or without_interval):
        more = len(unreadable) - 1
        raise ValueError(unreadable[0] + (f" (and {more} more files)" if more else ""))
    return Results(found, without_time, without_interval, unreadable)


@contextmanager
def _without_garbage_collection() -> Iterator[None]:
    """Results have so many parts that looking for cycles, which they do not have, takes longest."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


def _sheet(file: Path, place: Path, unreadable: list[str]) -> Sheet | None:
    """Reads a data sheet; adds what is wrong with one that was found in a folder."""
    try:
        sheet = FORMAT.read(file)
        if sheet.recorded.time is not None:
            _possible(sheet.recorded.time, file)
        return sheet
    except ValueError as error:
        if file == place:
            raise
        unreadable.append(str(error))
        return None


def _possible(time: str, file: Path) -> None:
    """Raises ValueError for a time at which no log can have been recorded."""
    try:
        possible_time(datetime.fromisoformat(time))
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from error


@dataclass(frozen=True)
class Estimated:
    """What a data sheet is the result of."""

    joint: str
    log: str  # SHA-256
    configuration: str | None  # SHA-256


def estimated(folder: Path) -> set[Estimated]:
    """Returns what the data sheets of a folder, which need not exist, are the results of. One that
    cannot be read is none: its log is estimated again."""
    sheets = (_sheet(file, folder, []) for file in folder.rglob(FORMAT.file))
    return {
        Estimated(each.joint, each.logs[-1].sha256, each.configuration.sha256)
        for each in sheets
        if each is not None
    }


def _files(place: Path) -> Iterator[Path]:
    """Data sheets at any depth of a folder, and its table of results; or the file itself."""
    if not place.is_dir():
        yield place
        return
    yield from sorted(place.rglob(FORMAT.file))
    if (place / TABLE).is_file():
        yield place / TABLE


def _name(sheet: Sheet, place: Path) -> str:
    """The name of a joint: that in its configuration, else the name of a configuration for many
    logs, else of the folder that the user named."""
    config, log = Path(sheet.configuration.file).stem, Path(sheet.logs[-1].file).stem
    folder = place if place.is_dir() else place.parent
    name = sheet.joint or (config if config != log else folder.resolve().name)
    return name if is_name(name) else "_" + re.sub(r"[^\w.-]", "_", name)[:_LONGEST_NAME]


def _same_gear(gears: dict[str, tuple[float, str]], name: str, gamma: float, file: Path) -> None:
    known, other = gears.setdefault(name, (gamma, str(file)))
    if abs(gamma - known) > _OTHER_GEAR * abs(known):
        raise ValueError(
            f"{file}: joint {quoted(name)} has motor.gamma = {gamma:g}, but {known:g} in {other}: "
            "expected results of one joint; give the joints names in [joints], or name one folder "
            "for each"
        )


def _of_sheet(sheet: Sheet, name: str, file: Path, together: Together) -> LogResult:
    assert sheet.recorded.time is not None
    return LogResult(
        joint=name,
        time=datetime.fromisoformat(sheet.recorded.time),
        place=str(file.parent),
        digests=[each.sha256 for each in sheet.logs],
        together=together,
        excitation=sheet.excitation,
        torque_gain=sheet.rests_on.torque_gain,
        doubt=sheet.doubt,
        temperature=sheet.recorded.temperature,
    )


def read_table(path: Path) -> Iterator[LogResult]:
    """Yields the results of a table. Raises ValueError for a line that is no result."""
    try:
        lines = read_whole(path, _LONGEST).splitlines()
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror}; name a folder with results") from error
    except ValueError as error:
        raise ValueError(f"{path}: no text ({cause(error)}); expected JSON Lines") from error
    for number, line in enumerate(lines, 1):
        place = f"line {number}"
        try:
            found = _LINE.validate_json(line)
        except ValidationError as error:
            if error.errors()[0]["type"] == "json_invalid":
                got = quoted(line[:40])
                raise ValueError(f"{path}: {place}: expected JSON, got {got}") from error
            raise wrong_values(path, error, (place,)) from error
        yield LogResult(**vars(found))


def write_table(results: Sequence[LogResult], path: Path) -> None:
    """Writes results as a table, which read_table() reads."""
    write_whole("".join(f"{to_json(each).decode()}\n" for each in results), path)
