"""The times of the rows of a log, which must increase.

A clock that starts again after its period is continued, and a clock that was set back goes on
after a gap: nobody knows how long it took. Rows in a wrong order are refused.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.quoted import quoted
from sigmahat.recording.configuration import Configuration, Time
from sigmahat.recording.log import Array, Log, LogError
from sigmahat.recording.notes import (
    ClockSetBack,
    ClockStartedAgain,
    MissingTimes,
    NoTimeColumn,
    RecordingNote,
    RepeatedTimes,
)
from sigmahat.recording.resampling import usual_gap
from sigmahat.recording.units import seconds

_PERIODS = (2.0**16, 2.0**24, 2.0**31, 2.0**32, 1e6, 60.0, 3600.0, 86400.0, 86400e3, 86400e6)
"""Usual periods of a clock: counters, microseconds of a second, seconds of a minute, an hour, a
day, and parts of seconds of a day."""
_SOON = 10.0  # largest time over a step back, in usual times between rows
_RUN = 10  # least number of rows before and after a clock that was set back
_MADE_UP = 0.5  # ratio of a step forward to a step back for which the rows are in a wrong order
_GAP = 1.0  # [s] least gap that replaces a step back
_LONG_AGO = 1e6  # [s] A larger time counts from 1970, or from the start of a machine.


def times_of(
    log: Log, configuration: Configuration, column: str | None, T: float, notes: list[RecordingNote]
) -> Array:
    """Returns the times of the rows of a log [s]; nan for a row without a time.

    column  with the times; None for rows that are T apart [s]
    notes   gets a note on rows that are left out, and on missing times

    Raises LogError for a missing column, fewer than two times, or times that decrease.
    """
    if column is None:
        notes.append(NoTimeColumn(sample_period=T))
        first = next(port.column for port in configuration.ports.values() if port.column)
        return T * np.arange(log.samples(first), dtype=np.float64)
    times = log.read(column) * seconds(configuration.time.unit)
    finite = np.isfinite(times)
    given = times if finite.all() else times[finite]
    if len(given) < 2:
        raise LogError(f"{log.path}: time column {quoted(column)} holds fewer than two numbers")
    steps = np.diff(given)
    if steps.min() < 0:
        given = _continued(given, column, np.flatnonzero(finite), configuration.time, notes)
        times = times.copy()
        times[finite] = given
        steps = np.diff(given)
    if np.all(steps >= 0) and not np.all(steps > 0) and steps.any():
        again = np.flatnonzero(finite)[1:][steps == 0]
        times[again] = np.nan
        notes.append(RepeatedTimes(column=column, rows=len(again)))
        return times
    if not np.all(steps > 0):
        i = int(np.argmax(steps <= 0))
        row = np.flatnonzero(finite)[i + 1] + 1
        raise LogError(
            f"{log.path}: time column {quoted(column)} does not increase: "
            f"{_shown(given, i + 1)} in row {row} after {_shown(given, i)}; sort or split the log"
        )
    if len(given) < len(times):
        times[~finite] = np.nan
        notes.append(MissingTimes(column=column, rows=len(times) - len(given)))
    return times


def _continued(
    given: Array, column: str, rows: NDArray[np.int64], time: Time, notes: list[RecordingNote]
) -> Array:
    """Returns times that go on where the clock started again or was set back, with a note.

    given  times [s], finite
    rows   of these times in the log, from 0 on
    """
    back = set_back(given, seconds(time.unit))
    if back is None:
        return given
    if back.period is not None:
        times, period = len(back.at), back.period
        notes.append(ClockStartedAgain(column=column, times=times, period=period, unit=time.unit))
    else:
        row = int(rows[back.at[0] + 1]) + 1
        notes.append(ClockSetBack(column=column, row=row, step=float(back.steps[0])))
    return back.continued(given, time.longest_gap)


@dataclass(frozen=True)
class SetBack:
    """Where times decrease, although rows are in the right order."""

    at: NDArray[np.int64]  # last times before each step, from 0 on
    period: float | None
    """Period of the clock, in the unit of the column; None for a clock that was set back once."""
    steps: Array
    """By which the times decrease, or the period of the clock, at each of these [s]."""

    def continued(self, times: Array, longest_gap: float | None = None) -> Array:
        """Returns times [s] that go on at each step, with a gap where the clock was set back.

        longest_gap  over which values are interpolated [s]; the gap is longer
        """
        steps = self.steps
        if self.period is None:
            gap = (
                usual_gap(float(np.median(np.diff(times)))) if longest_gap is None else longest_gap
            )
            steps = steps + _GAP + 2 * gap
        later = np.zeros(len(times))
        later[self.at + 1] = steps
        return times + np.cumsum(later, out=later)


def set_back(times: Array, unit: float) -> SetBack | None:
    """Finds where a clock starts again, or is set back once; None if rows are in a wrong order.

    times  finite [s]
    unit   of the column [s]
    """
    steps = np.diff(times)
    at = np.flatnonzero(steps < 0)
    usual = float(np.median(steps))
    if not len(at) or usual <= 0:
        return None
    for period in _PERIODS:
        over = steps[at] + period * unit
        if np.all((over > 0) & (over < _SOON * usual)):
            return SetBack(at, period, np.full(len(at), period * unit))
    # Rows in a wrong order have a step forward that makes up for the step back.
    is_once = len(at) == 1 and _RUN <= at[0] < len(steps) - _RUN
    if is_once and float(steps.max()) < _MADE_UP * -float(steps[at[0]]):
        return SetBack(at, None, -steps[at])
    return None


def _shown(times: Array, i: int) -> str:
    """Formats a time as text; times that count from 1970 are shown relative to the first row."""
    if abs(times[0]) < _LONG_AGO:
        return f"{times[i]:.9g} s"
    return f"{times[i] - times[0]:.9g} s from the first row"
