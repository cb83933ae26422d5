"""When a log was recorded, and how warm the motor was: what a comparison of logs needs."""

import re
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone
from enum import Enum

import numpy as np

from sigmahat.recording.configuration import Configuration
from sigmahat.recording.log import Log
from sigmahat.recording.units import seconds

_EARLIEST = datetime(1990, 1, 1, tzinfo=timezone.utc)
_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)
_DATES = (1e9, 4e9)  # [s] since 1970 between which a clock counts from 1970: years 2001 to 2096
_IN_NAME = re.compile(
    r"(?<!\d)(20\d\d)([-_.]?)([01]\d)\2([0-3]\d)"
    r"(?:[T_ -]{0,2}(?!20\d\d[-_.]?[01]\d[-_.]?[0-3]\d)"  # no other date
    r"([0-2]\d)[-:_h.]?([0-5]\d)(?:[-:_m.]?([0-5]\d))?)?(?!\d)"
)
"""A date in the name of a file, with or without a time: 2026-03-02, 20260302T081500."""


class TimeSource(Enum):
    """Where the time of a recording comes from."""

    GIVEN = "given"  # by the user
    LOG = "log"  # by the clock of the log
    NAME = "name"  # a date in the name of the file
    UNKNOWN = "unknown"  # the clock starts at 0, and nobody said when


@dataclass(frozen=True)
class Recorded:
    """The time of the first sample of a log."""

    time: datetime | None  # with a time zone; None if it is unknown
    source: TimeSource


def possible_time(time: datetime) -> datetime:
    """Returns a time at which a log can have been recorded.

    Raises ValueError for a time before 1990, or more than a day after now: a clock was not set, or
    a date is mistyped.
    """
    since = _with_zone(time)
    if not _EARLIEST <= since <= datetime.now(timezone.utc) + timedelta(days=1):
        raise ValueError(
            f"expected a time of the recording from 1990 until now, got {since:%Y-%m-%dT%H:%M} "
            "(UTC); give the right one to `sigmahat estimate --recorded`"
        )
    return since


def recorded(log: Log, configuration: Configuration, given: datetime | None = None) -> Recorded:
    """Finds when a log was recorded. A time without a zone counts as UTC.

    given  by the user, before all else
    """
    if given is not None:
        return Recorded(_with_zone(given), TimeSource.GIVEN)
    time = _of_clock(log, configuration)
    if time is not None:
        return Recorded(time, TimeSource.LOG)
    time = in_name(log.path.stem)
    return Recorded(time, TimeSource.NAME if time else TimeSource.UNKNOWN)


def _with_zone(time: datetime) -> datetime:
    return time if time.tzinfo else time.replace(tzinfo=timezone.utc)


def _of_clock(log: Log, configuration: Configuration) -> datetime | None:
    """The first time of the log, if its clock counts from 1970 or has dates."""
    ports = configuration.ports.values()
    names = [configuration.time.column, *(port.time for port in ports)]
    column = next((name for name in names if name), None)
    if column is None or column not in log.columns:
        return None
    for batch in log.batches([column], 1):
        first = batch.column(0)[0].as_py()
        if first is not None:
            break
    else:
        return None
    if isinstance(first, datetime):
        return _with_zone(first)
    if isinstance(first, bool) or not isinstance(first, (int, float)):
        return None
    since = float(first) * seconds(configuration.time.unit)
    if not _DATES[0] < since < _DATES[1]:
        return None
    return _EPOCH + timedelta(seconds=since)


def in_name(name: str) -> datetime | None:
    """Returns the date, and the time if there is one, in the name of a file; None without them, and
    for several days, one of which may be that of a firmware or of a delivery."""
    times = list[datetime]()
    for found in _IN_NAME.finditer(name):
        year, _, month, day, hour, minute, second = found.groups()
        numbers = (int(each or 0) for each in (year, month, day, hour, minute, second))
        with suppress(ValueError):  # such as the 31st of June
            times.append(datetime(*numbers, tzinfo=timezone.utc))  # type: ignore[arg-type, misc]
    return times[0] if len({each.date() for each in times}) == 1 else None


def temperature(log: Log, configuration: Configuration) -> float | None:
    """Returns the mean of the column [temperature] [degC]; None without one, or without numbers.

    Raises LogError if the log does not have the column.
    """
    if configuration.temperature is None:
        return None
    values = log.read(configuration.temperature)
    finite = values[np.isfinite(values)]
    return float(np.mean(finite)) if len(finite) else None
