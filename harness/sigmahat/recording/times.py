"""The times of the rows of a log, which must increase."""

import numpy as np

from sigmahat.recording.configuration import Configuration
from sigmahat.recording.log import Array, Log, LogError
from sigmahat.recording.notes import MissingTimes, NoTimeColumn, RecordingNote, RepeatedTimes
from sigmahat.recording.units import seconds

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
        raise LogError(f"{log.path}: time column {column!r} holds fewer than two numbers")
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
            f"{log.path}: time column {column!r} does not increase: {_shown(given, i + 1)} in "
            f"row {row} after {_shown(given, i)}; sort or split the log"
        )
    if len(given) < len(times):
        times[~finite] = np.nan
        notes.append(MissingTimes(column=column, rows=len(times) - len(given)))
    return times


def _shown(times: Array, i: int) -> str:
    """Formats a time as text; times that count from 1970 are shown relative to the first row."""
    if abs(times[0]) < _LONG_AGO:
        return f"{times[i]:.9g} s"
    return f"{times[i] - times[0]:.9g} s from the first row"
