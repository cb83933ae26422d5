"""Converts the columns of a log to inputs of the estimator at the ticks of the estimator.

Tick k is at the time t_0 + k T, where t_0 is the first time in the log. Each port has its own
samples, with times of their own; resampling.py has the rules for the values between them.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.quoted import quoted
from sigmahat.recording.configuration import Configuration, Port, Time
from sigmahat.recording.counters import Unwrapping, WholePeriods
from sigmahat.recording.deformation import with_positions
from sigmahat.recording.false_samples import false_samples, returns
from sigmahat.recording.gaps import refused, stretches
from sigmahat.recording.log import Array, Log, LogError
from sigmahat.recording.notes import (
    BetweenTicks,
    CounterAtStart,
    CounterInGap,
    CounterReturned,
    Delayed,
    FasterThanTicks,
    HeldLeftOut,
    Interpolated,
    MissingSamples,
    NoSignal,
    PlaceholderLeftOut,
    RecordingNote,
    Rows,
    SkippedTicks,
    Unwrapped,
)
from sigmahat.recording.resampling import (
    AT_TICK,
    Resampled,
    resample,
    usual_gap,
    with_tolerance,
)
from sigmahat.recording.times import times_of
from sigmahat.recording.units import Conversion

_MOST_TICKS = 5_000_000
_MOST_TICKS_OF_MANY_ROWS = 20  # ticks per row; limits memory by the size of the log
_SLOW = 1.5  # ratio of the time between samples to T from which values must be interpolated
_MOST_TICKS_PER_ROW = 200  # with more, the unit of the time is wrong


@dataclass(frozen=True)
class Samples:
    """The values of a log at the ticks of the estimator."""

    T: float  # time between ticks [s]
    names: Sequence[str]  # ports
    values: Array  # [size: ticks x ports], nan where there is no value
    tick_of_row: NDArray[np.int32] = field(default_factory=lambda: np.empty(0, np.int32))
    """Last tick at or before each row of the log, if there is a log."""
    notes: Sequence[RecordingNote] = ()  # on reading the log and on its samples


_Asked = tuple[dict[str, Port], Time, float]
_last: WeakKeyDictionary[Log, tuple[_Asked, Samples]] = WeakKeyDictionary()
"""Last result of sample() for each log: the check and the replay of a log use the same samples."""


def sample(log: Log, configuration: Configuration, T: float) -> Samples:
    """Returns the values of all configured ports at the ticks, which are T apart [s].

    Raises LogError for a T that is not positive, a missing column, times that do not increase, and
    a column without any value.
    """
    asked = dict(configuration.ports), configuration.time, T
    last = _last.get(log)
    if last is None or last[0] != asked:
        _last.pop(log, None)  # frees the memory of the old samples before the new are computed
        last = asked, _sample(log, configuration, T)
        last[1].values.flags.writeable = False
        _last[log] = last
    return last[1]


def _sample(log: Log, configuration: Configuration, T: float) -> Samples:
    """Computes the samples for sample(), which stores the last result."""
    if not (np.isfinite(T) and T > 0.0):
        raise LogError(f"{configuration.path}: samplePeriod: expected more than 0 s, got {T:g}")
    notes = [*log.notes]
    rows = times_of(log, configuration, configuration.time.column, T, notes)
    start, end = float(np.nanmin(rows)), float(np.nanmax(rows))
    ticks = _ticks(log, rows, end - start, T)
    duration = Rows(rows=len(rows), duration=end - start, ticks=ticks, sample_period=T)
    notes.insert(0, duration)
    rows -= start
    # Columns are contiguous in memory and filled one by one, which limits the memory.
    values = np.empty((ticks, len(configuration.ports)), order="F")
    for i, (name, port) in enumerate(configuration.ports.items()):
        if port.value is not None:
            values[:, i] = port.value
            continue
        t = rows
        if port.time is not None:
            t = times_of(log, configuration, port.time, T, notes)
            t -= start
        values[:, i] = _port_at_ticks(log, name, port, t, T, ticks, configuration.time, notes)
        if not np.isfinite(values[:, i]).any():
            raise LogError(
                f"port {name}: its column has no sample in the {end - start:g} s of the log; "
                "check its delay, and time.longest_gap"
            )
    notes += _put_right(values, configuration, T)
    names = _with_positions(configuration.ports, values)
    notes += _skipped(values, T)
    return Samples(T, names, values, _tick_of(rows, T, ticks), notes)


def _with_positions(ports: Iterable[str], values: Array) -> tuple[str, ...]:
    """Replaces a measured deformation by the position that follows, and returns the names.

    values  of the ports at the ticks [size: ticks x ports]; changed in place
    """
    found = with_positions(dict(zip(ports, values.T, strict=True)))
    for i, column in enumerate(found.values()):
        values[:, i] = column
    return tuple(found)


def _ticks(log: Log, rows: Array, duration: float, T: float) -> int:
    """Returns the number of ticks in a log with rows at these times [s].

    Raises LogError if rows are very far apart, or if there are too many ticks for the memory.
    """
    step = float(np.nanmedian(np.diff(rows))) if len(rows) > 1 else T
    if step > _MOST_TICKS_PER_ROW * T:
        raise LogError(
            f"{log.path}: samplePeriod is {T:g} s, but most rows are {step:g} s apart; "
            "check time.unit and samplePeriod"
        )
    ticks = int(np.floor(duration / T + AT_TICK)) + 1
    most = max(_MOST_TICKS, _MOST_TICKS_OF_MANY_ROWS * len(rows))
    if ticks > most:
        gap = float(np.max(np.diff(rows[np.isfinite(rows)])))
        raise LogError(
            f"{log.path}: {ticks} steps of {T:g} s in {duration:g} s, expected at most {most}; "
            f"the longest gap is {gap:g} s: split the log there, or increase samplePeriod"
        )
    return ticks


def _tick_of(rows: Array, T: float, ticks: int) -> NDArray[np.int32]:
    """Returns the last tick at or before each row of the log.

    rows  times since the first tick [s], nan where unknown; overwritten to save memory
    """
    rows /= T
    rows += AT_TICK
    np.floor(rows, out=rows)
    rows[np.isnan(rows)] = -1
    np.maximum.accumulate(rows, out=rows)
    return np.clip(rows, 0, ticks - 1, out=rows).astype(np.int32)


def _port_at_ticks(
    log: Log,
    name: str,
    port: Port,
    t: Array,
    T: float,
    ticks: int,
    time: Time,
    notes: list[RecordingNote],
) -> Array:
    """Reads the column of a port, and returns its values at the ticks [size: ticks].

    t  times of the column since the first tick [s]
    """
    column, missing = _column(log, name, port, t, notes)
    if port.delay:
        t = t - port.delay
        notes.append(Delayed(port=name, delay=port.delay))
    if not np.any(np.isfinite(t) & np.isfinite(column)):
        raise LogError(
            f"port {name}: its column has no numbers; name another column, or remove the port"
        )
    resampled = resample(t, column, T, ticks, time.longest_gap)
    longest, interval = time.longest_gap, resampled.interval
    if longest is not None and interval > max(with_tolerance(longest), _SLOW * T):
        raise LogError(
            f"port {name}: time.longest_gap is {longest:g} s, but its samples are {interval:.3g} s "
            f"apart; remove longest_gap, or set it to {usual_gap(interval):.3g}"
        )
    notes += _notes_on(name, resampled, missing, T)
    return resampled.values


def _column(
    log: Log, name: str, port: Port, t: Array, notes: list[RecordingNote]
) -> tuple[Array, int]:
    """Reads a column in the unit of its port, and checks the number of samples.

    Returns its values, nan where a sample is missing or false, and the number of samples that are
    missing in the log.

    t  times of the column since the first tick [s]
    """
    values = log.read(port.column)
    if len(values) != len(t):
        raise LogError(
            f"{log.path}: column {quoted(port.column)} has {len(values)} samples, its time column "
            f"{len(t)}; name the right time column in ports.{name}.time"
        )
    missing = len(values) - int(np.count_nonzero(np.isfinite(t) & np.isfinite(values)))
    values = _without_false(values, name, port, t, notes)
    if port.wrap is not None:
        unwrapping = Unwrapping(port.wrap)
        values = unwrapping.unwrap(values)
        unit = port.unit or ""
        notes.append(Unwrapped(port=name, jumps=unwrapping.jumps, period=port.wrap, unit=unit))
    return Conversion.of(name, port).apply(values), missing


def _without_false(
    values: Array, name: str, port: Port, t: Array, notes: list[RecordingNote]
) -> Array:
    """Returns the values of a column without false samples and jumps, with notes on both.

    t  times of the column since the first tick [s]
    """
    is_position = name in ("theta", "q")
    if name in ("tau", "tau_e_sensor"):
        low, high = np.fmin.reduce(values), np.fmax.reduce(values)  # which ignore nan
        if low == high:
            notes.append(NoSignal(port=name, column=port.column, value=float(low)))
            return values
    false = false_samples(values, is_position, port.wrap)
    for placeholder in false.placeholders:
        number, first = len(placeholder.rows), placeholder.first + 1
        share = number / len(values)
        value = placeholder.value
        notes.append(
            PlaceholderLeftOut(
                port=name, column=port.column, value=value, samples=number, share=share, row=first
            )
        )
    if false.held is not None:
        number, first = len(false.held), int(false.held[0]) + 1
        share = number / len(values)
        notes.append(
            HeldLeftOut(port=name, column=port.column, samples=number, share=share, row=first)
        )
    values = false.left_out(values)
    jumps = returns(values, t) if is_position and port.wrap is None else None
    if jumps is None:
        return values
    notes.append(
        CounterReturned(
            port=name,
            column=port.column,
            jumps=len(jumps.rows),
            largest=float(np.abs(jumps.offsets).max()),
            unit=port.unit or "",
            period=jumps.period,
            row=int(jumps.rows[0]) + 1,
        )
    )
    return jumps.joined(values)


def _notes_on(name: str, resampled: Resampled, missing: int, T: float) -> Iterator[RecordingNote]:
    """Yields notes on the values of a port at the ticks, with this number of missing samples."""
    interval = resampled.interval
    if resampled.interpolated:
        apart = None if resampled.is_even else interval
        yield Interpolated(port=name, ticks=resampled.interpolated, sample_interval=apart)
    if interval < T * (1 - AT_TICK):
        yield FasterThanTicks(port=name, sample_interval=interval)
    elif resampled.is_even and resampled.between:
        yield BetweenTicks(port=name, samples=resampled.between)
    if missing and abs(interval / T - 1) < 0.5:
        # Rows of other signals have no sample of this port either, but none is missing.
        lost = len(resampled.values) * T / interval - resampled.samples
        if lost > 0.5 * missing:
            yield MissingSamples(port=name, samples=missing)


def _put_right(values: Array, configuration: Configuration, T: float) -> Iterator[RecordingNote]:
    """Corrects theta or q by whole periods of its counter, and yields notes on the corrections.

    values  of the ports at the ticks [size: ticks x ports], nan if missing; changed in place
    """
    whole_periods = WholePeriods.of(configuration)
    if whole_periods is None:
        return
    port = whole_periods.counter.port
    missed = whole_periods.put_right(values)
    if missed:
        first = missed[0]
        yield CounterInGap(port=port, periods=first.periods, t=first.tick * T, gaps=len(missed))
    if whole_periods.at_start:
        yield CounterAtStart(port=port, periods=whole_periods.at_start)


def _skipped(values: Array, T: float) -> Iterator[RecordingNote]:
    """Yields a note if the estimator skips ticks: an input value is missing or is refused."""
    skipped = refused(values)
    if not skipped.any():
        return
    first, last = stretches(skipped)
    longest = int(np.argmax(last - first))
    yield SkippedTicks(
        ticks=int(np.count_nonzero(skipped)),
        gaps=len(first),
        longest=float((last - first)[longest] * T),
        t=float(first[longest] * T),
    )
