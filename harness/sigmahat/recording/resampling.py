"""Converts the columns of a log to inputs of the estimator at the ticks of the estimator.

Tick k is at the time t_0 + k T, where t_0 is the first time in the log. Notes for the user describe
the processing of the samples.

A sample within a thousandth of the period from a tick is used unchanged. A slower, faster or uneven
column has samples between the ticks. A tick between two samples is interpolated linearly, if the
samples are not further apart than the longest gap. By default, the longest gap is three times
the median interval of the column. The values at all other ticks are nan, and the estimator skips
these ticks. A column with a sample for nearly every tick is interpolated only if the longest gap is
configured.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sigmahat.recording.configuration import Configuration, Port, Time
from sigmahat.recording.log import Array, Log, LogError
from sigmahat.recording.units import convert, factor, seconds, unwrap

AT_TICK = 1e-3  # largest distance of a sample from its tick, in periods
_USUAL_INTERVALS = 3.0
_MOST_TICKS = 5_000_000
_MOST_TICKS_OF_MANY_ROWS = 20  # ticks per row; limits memory by the size of the log
_MOST_TICKS_PER_ROW = 200  # with more, the unit of the time is wrong
_PART = 1 << 16  # samples that are compared at a time, to limit the memory
_LONG_AGO = 1e6  # [s] A larger time counts from 1970, or from the start of a machine.


@dataclass(frozen=True)
class Samples:
    """The values of a log at the ticks of the estimator."""

    T: float  # time between ticks [s]
    names: Sequence[str]  # ports
    values: Array  # [size: ticks x ports], nan where there is no value
    tick_of_row: NDArray[np.int32] = field(default_factory=lambda: np.empty(0, np.int32))
    """Last tick at or before each row of the log, if there is a log."""
    notes: Sequence[str] = ()  # sentences about the processing of the samples


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
    notes: list[str] = list(log.notes)
    rows = _times(log, configuration, configuration.time.column, T, notes)
    start, end = float(np.nanmin(rows)), float(np.nanmax(rows))
    step = float(np.nanmedian(np.diff(rows))) if len(rows) > 1 else T
    if step > _MOST_TICKS_PER_ROW * T:
        raise LogError(
            f"{log.path}: samplePeriod is {T:g} s, but most rows are {step:g} s apart; "
            "check time.unit and samplePeriod"
        )
    ticks = int(np.floor((end - start) / T + AT_TICK)) + 1
    most = max(_MOST_TICKS, _MOST_TICKS_OF_MANY_ROWS * len(rows))
    if ticks > most:
        gap = float(np.max(np.diff(rows[np.isfinite(rows)])))
        raise LogError(
            f"{log.path}: {ticks} steps of {T:g} s in {end - start:g} s, expected at most {most}; "
            f"the longest gap is {gap:g} s: split the log there, or increase samplePeriod"
        )
    notes.insert(0, f"{len(rows)} rows over {end - start:.6g} s; {ticks} ticks of {T:g} s")
    rows -= start
    # Columns are contiguous in memory and filled one by one, which limits the memory.
    values = np.empty((ticks, len(configuration.ports)), order="F")
    for i, (name, port) in enumerate(configuration.ports.items()):
        if port.value is not None:
            values[:, i] = port.value
            continue
        t = rows
        if port.time is not None:
            t = _times(log, configuration, port.time, T, notes)
            t -= start
        column = _column(log, name, port, len(t), notes)
        if port.delay:
            t = t - port.delay
            notes.append(f"{name}: moved back by {port.delay:g} s")
        values[:, i] = _at_ticks(name, t, column, T, ticks, configuration.time.longest_gap, notes)
        if not np.isfinite(values[:, i]).any():
            raise LogError(
                f"port {name}: its column has no sample in the {end - start:g} s of the log; "
                "check its delay, and time.longest_gap"
            )
    notes += _put_right(values, configuration.ports, T)
    notes += _whole_turns(values, configuration)
    notes += _skipped(values, T)
    return Samples(T, tuple(configuration.ports), values, _tick_of(rows, T, ticks), notes)


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


def _times(
    log: Log, configuration: Configuration, name: str | None, T: float, notes: list[str]
) -> Array:
    """Returns the times of the rows of a log [s]; nan for a row without a time."""
    if name is None:
        notes.append(f"no time column: rows taken as {T:g} s apart")
        first = next(each.column for each in configuration.ports.values() if each.column)
        return T * np.arange(log.samples(first), dtype=np.float64)
    times = log.read(name) * seconds(configuration.time.unit)
    finite = np.isfinite(times)
    given = times if finite.all() else times[finite]
    if len(given) < 2:
        raise LogError(f"{log.path}: time column {name!r} holds fewer than two numbers")
    steps = np.diff(given)
    if np.all(steps >= 0) and not np.all(steps > 0) and steps.any():
        again = np.flatnonzero(finite)[1:][steps == 0]
        times[again] = np.nan
        notes.append(f"{name}: {len(again)} rows with the time of the row before left out")
        return times
    if not np.all(steps > 0):
        i = int(np.argmax(steps <= 0))
        row = np.flatnonzero(finite)[i + 1] + 1
        raise LogError(
            f"{log.path}: time column {name!r} does not increase: {_shown(given, i + 1)} in "
            f"row {row} after {_shown(given, i)}; sort or split the log"
        )
    if len(given) < len(times):
        times[~finite] = np.nan
        notes.append(f"{name}: {len(times) - len(given)} rows without a time left out")
    return times


def _shown(times: Array, i: int) -> str:
    """Formats a time as text; times that count from 1970 are shown relative to the first row."""
    if abs(times[0]) < _LONG_AGO:
        return f"{times[i]:.9g} s"
    return f"{times[i] - times[0]:.9g} s from the first row"


def _column(log: Log, name: str, port: Port, times: int, notes: list[str]) -> Array:
    """Reads a column in the unit of its port, and checks the number of samples."""
    values = log.read(port.column)
    if len(values) != times:
        raise LogError(
            f"{log.path}: column {port.column!r} has {len(values)} samples, its time column "
            f"{times}; name the right time column in ports.{name}.time"
        )
    if port.wrap is not None:
        values, jumps = unwrap(values, port.wrap)
        notes.append(f"{name}: unwrapped {jumps} times at {port.wrap:g} {port.unit or ''}".rstrip())
    return convert(name, port, values)


def _at_ticks(
    name: str,
    t: Array,
    values: Array,
    T: float,
    ticks: int,
    longest_gap: float | None,
    notes: list[str],
) -> Array:
    """Returns a column of a port at the ticks, nan at ticks without a value [size: ticks].

    t            times since the first tick [s], increasing; nan where unknown; [size: samples]
    values       [size: samples], nan where a sample is missing
    longest_gap  longest time between two interpolated samples [s]; None: from the intervals
    """
    finite = np.isfinite(t) & np.isfinite(values)
    if not finite.any():
        raise LogError(
            f"port {name}: its column has no numbers; name another column, or remove the port"
        )
    if not finite.all():
        t, values = t[finite], values[finite]
    if longest_gap is None and len(t) == ticks and _one_for_each_tick(t, T):
        return values  # the usual case, with the least memory
    position = t / T
    nearest = np.round(position)
    at = (np.abs(position - nearest) <= AT_TICK) & (nearest >= 0) & (nearest < ticks)
    resampled = np.full(ticks, np.nan)
    resampled[nearest[at][::-1].astype(np.int64)] = values[at][::-1]  # of two samples, the first
    interval = float(np.median(np.diff(t))) if len(t) > 1 else T
    even = bool(abs(interval / T - 1) < AT_TICK and np.count_nonzero(at) > 0.99 * len(t))
    if longest_gap is None:
        longest_gap = 0.0 if even else _USUAL_INTERVALS * interval
    empty = np.flatnonzero(np.isnan(resampled))
    after = np.searchsorted(position, empty)
    inside = (after > 0) & (after < len(t))
    empty, after = empty[inside], after[inside]
    empty = empty[t[after] - t[after - 1] <= longest_gap * (1 + AT_TICK)]
    resampled[empty] = np.interp(empty.astype(np.float64), position, values)
    if len(empty):
        why = "" if even else f", its samples are {interval:.3g} s apart"
        notes.append(f"{name}: {len(empty)} ticks interpolated{why}")
    if interval < T * (1 - AT_TICK):
        notes.append(f"{name}: faster than the ticks, samples between them left out, no filter")
    elif even and not at.all():
        notes.append(f"{name}: {np.count_nonzero(~at)} samples between ticks")
    if len(t) < len(finite) and abs(interval / T - 1) < 0.5:
        notes.append(f"{name}: {len(finite) - len(t)} samples missing or not finite")
    return resampled


def _one_for_each_tick(t: Array, T: float) -> bool:
    for first in range(0, len(t), _PART):
        part = t[first : first + _PART]
        if not np.all(np.abs(part / T - np.arange(first, first + len(part))) <= AT_TICK):
            return False
    return True


def stretches(mask: ArrayLike) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Returns the first index of each run of true values, and the index after each run."""
    padded = np.zeros(np.size(mask) + 2, dtype=np.bool_)
    padded[1:-1] = mask
    edges = np.flatnonzero(padded[1:] != padded[:-1])
    return edges[::2], edges[1::2]


_LARGEST = 1e12  # SH_LARGEST_MEASUREMENT of sigmahat.h


def refused(values: Array) -> NDArray[np.bool_]:
    """Marks ticks that the estimator skips because of the input values [size: ticks x ports]."""
    skipped = np.zeros(len(values), dtype=np.bool_)
    for column in values.T:  # one column at a time, to limit the memory
        skipped |= ~((column >= -_LARGEST) & (column <= _LARGEST))
    return skipped


def _skipped(values: Array, T: float) -> Iterator[str]:
    """Describes the ticks that the estimator skips: an input value is missing or is refused."""
    skipped = refused(values)
    if not skipped.any():
        return
    first, last = stretches(skipped)
    longest = int(np.argmax(last - first))
    yield (
        f"{np.count_nonzero(skipped)} ticks skipped in {len(first)} gaps, the longest of "
        f"{(last - first)[longest] * T:.3g} s at {first[longest] * T:.6g} s after the start; "
        "the estimator keeps its estimate over them"
    )


def _put_right(values: Array, ports: Mapping[str, Port], T: float) -> Iterator[str]:
    """Corrects theta or q after gaps by whole counter periods, so that both move equally far.
    Motor and link move alike, apart from the deformation.

    values  of the ports at the ticks [size: ticks x ports], nan if missing; changed in place
    T       time between ticks [s]

    Yields sentences about the corrections.
    """
    both, period = counter(ports)
    if not np.isfinite(period):
        return
    column, other = (list(ports).index(name) for name in both)
    begins, ends = stretches(np.isfinite(values[:, column]) & np.isfinite(values[:, other]))
    steps = values[begins[1:]] - values[ends[:-1] - 1]
    turns = np.round((steps[:, other] - steps[:, column]) / period).astype(np.int64)
    for begin, end, total in zip(begins[1:], [*begins[2:], None], np.cumsum(turns), strict=False):
        values[begin:end, column] += total * period
    moved = np.flatnonzero(turns)
    if len(moved):
        t = (ends[moved[0]] - 1) * T
        also = f" and during {len(moved) - 1} more" if len(moved) > 1 else ""
        yield (
            f"{both[0]}: {turns[moved[0]]:+d} periods of its counter during the gap after "
            f"{t:.6g} s{also}, by the motion of the other encoder"
        )


def _whole_turns(values: Array, configuration: Configuration) -> Iterator[str]:
    """Corrects theta or q by whole counter periods, so that the deformation is in range.phi.

    The position from a counter that was switched on in another turn is wrong by whole periods. The
    positions are unchanged without range.phi, or if no correction brings the deformation in range.

    values  of the ports at the ticks, after _put_right() [size: ticks x ports]; changed in place
    """
    phi_most = configuration.parameters.get("range.phi")
    if phi_most is None:
        return
    name, turns = turns_from(0.0, float(phi_most), values, configuration.ports)
    if turns:
        _, period = counter(configuration.ports)
        values[:, list(configuration.ports).index(name)] += turns * period
        yield f"{name}: {turns:+d} periods of its counter, so that the deformation is in range.phi"


def turns_from(
    center: float, most: float, values: Array, ports: Mapping[str, Port]
) -> tuple[str, int]:
    """Returns the port that wraps, theta or q, and the correction in periods; 0 for none.

    A correction must bring the median deformation from outside to inside of center +- most.

    center, most  [rad]
    values        of the ports at the ticks [size: ticks x ports], nan for a missing value
    """
    both, period = counter(ports)
    if not np.isfinite(period):
        return "", 0
    theta, q = (list(ports).index(name) for name in ("theta", "q"))
    phi = values[:, q] - values[:, theta]
    phi = phi[np.isfinite(phi)]
    if not len(phi):
        return "", 0
    away = float(np.median(phi)) - center
    turns = round(away / period)
    if abs(away - turns * period) <= most < abs(away):
        return both[0], turns if both[0] == "theta" else -turns
    return both[0], 0


def counter(ports: Mapping[str, Port]) -> tuple[Sequence[str], float]:
    """Sorts theta and q by the angle after which the counter starts again, the smaller first.

    Returns the smaller angle as well [rad]; inf if no counter starts again, or a port is missing.
    """
    angles = {name: np.inf for name in ("theta", "q") if name in ports}
    for name in angles:
        port = ports[name]
        if port.wrap is not None:
            angles[name] = abs(factor(name, port) * port.wrap / port.gear_ratio)
    both = sorted(angles, key=angles.__getitem__)
    return both, angles[both[0]] if len(both) == 2 else np.inf
