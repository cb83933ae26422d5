"""From the samples of a log to the ticks of the estimator, and what had to be done on the way.

Tick k is at t_0 + k T. A sample at a tick (within a thousandth of T) is taken as it is. Where a
column has samples elsewhere, because it is slower, faster or uneven, ticks between two samples are
interpolated linearly, if the samples are not further apart than the longest gap: the configured
one, else three times the usual interval of the column. A tick without a value gets nan, and the
estimator skips it: so a column with a sample for every tick is never interpolated unless a longest
gap is configured.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sigmahat.logs.configuration import PORTS, Configuration, Port
from sigmahat.logs.errors import LogError
from sigmahat.logs.log import Array, Log
from sigmahat.logs.units import convert, seconds, unwrap

_AT_TICK = 1e-3
"""How far from a tick a sample may be, in T."""
_USUAL_INTERVALS = 3.0
_MOST_TICKS = 200_000_000


@dataclass(frozen=True)
class Samples:
    """A log at the ticks of the estimator."""

    start: float
    """Time of the first tick [s], in the time of the log."""
    T: float
    names: Sequence[str]
    """Ports."""
    values: Array
    """[size: ticks x ports], nan where there is no value."""
    tick_of_row: NDArray[np.int64]
    """Last tick at or before each row of the log."""
    notes: Sequence[str]
    """What the log needed, in sentences."""

    @property
    def t(self) -> Array:
        """Times of the ticks since the first one [s]."""
        return self.T * np.arange(len(self.values), dtype=np.float64)


def sample(log: Log, configuration: Configuration, T: float) -> Samples:
    """Values of all configured ports at the ticks, T apart [s].

    Raises LogError for a T that is not positive, a missing column, times that do not increase, and
    a column without any value.
    """
    if not (np.isfinite(T) and T > 0.0):
        raise LogError(f"{configuration.path}: samplePeriod: expected more than 0 s, got {T:g}")
    notes: list[str] = []
    rows = _times(log, configuration, configuration.time.column, T, notes)
    start, end = float(np.nanmin(rows)), float(np.nanmax(rows))
    ticks = int(np.floor((end - start) / T + _AT_TICK)) + 1
    if ticks > _MOST_TICKS:
        raise LogError(
            f"{log.path}: {end - start:g} s in steps of {T:g} s are {ticks} ticks; "
            "check time.unit and samplePeriod"
        )
    notes.insert(0, f"{len(rows)} rows over {end - start:.6g} s; {ticks} ticks of {T:g} s")
    rows -= start
    values = np.empty((ticks, len(configuration.ports)))
    for i, (name, port) in enumerate(configuration.ports.items()):
        t = rows
        if port.time is not None:
            t = _times(log, configuration, port.time, T, notes)
            t -= start
        values[:, i] = _at_ticks(
            name,
            t,
            _column(log, name, port, len(t), notes),
            T,
            ticks,
            configuration.time.longest_gap,
            notes,
        )
    _note_skipped(values, T, notes)
    return Samples(start, T, tuple(configuration.ports), values, _tick_of(rows, T, ticks), notes)


def _tick_of(rows: Array, T: float, ticks: int) -> NDArray[np.int64]:
    """Last tick at or before each row, whose times since the first tick are given [s]."""
    tick = rows / T
    tick += _AT_TICK
    np.floor(tick, out=tick)
    tick[np.isnan(tick)] = -1
    np.maximum.accumulate(tick, out=tick)
    return np.clip(tick, 0, ticks - 1, out=tick).astype(np.int64)


def _times(
    log: Log, configuration: Configuration, name: str | None, T: float, notes: list[str]
) -> Array:
    """Times of rows [s]; nan where they are not known."""
    if name is None:
        notes.append(f"no time column: rows taken as {T:g} s apart")
        first = next(iter(configuration.ports.values())).column
        return T * np.arange(log.columns[first], dtype=np.float64)
    times = log.read(name) * seconds(configuration.time.unit)
    finite = np.isfinite(times)
    known = times if finite.all() else times[finite]
    if len(known) < 2:
        raise LogError(f"{log.path}: time column {name!r} holds fewer than two numbers")
    steps = np.diff(known)
    if not np.all(steps > 0):
        i = int(np.argmax(steps <= 0))
        row = np.flatnonzero(finite)[i + 1] + 1
        raise LogError(
            f"{log.path}: time column {name!r} does not increase: {known[i + 1]:.9g} s in "
            f"row {row} after {known[i]:.9g} s; sort or split the log"
        )
    if len(known) < len(times):
        times[~finite] = np.nan
        notes.append(f"{name}: {len(times) - len(known)} rows without a time left out")
    return times


def _column(log: Log, name: str, port: Port, rows: int, notes: list[str]) -> Array:
    """A column in the unit of its port."""
    values = log.read(port.column)
    if len(values) != rows:
        raise LogError(
            f"{log.path}: column {port.column!r} has {len(values)} samples, its time {rows}; "
            f"name its own times in ports.{name}.time"
        )
    if port.wrap is not None:
        values, jumps = unwrap(values, port.wrap)
        notes.append(f"{name}: unwrapped {jumps} times at {port.wrap:g} {port.unit or ''}".rstrip())
    values = convert(name, port, values)
    if port.wrap is None and PORTS[name] == "rad":
        steps = np.diff(values)
        jump = float(np.nanmax(np.abs(steps, out=steps), initial=0.0))
        if jump > np.pi and port.unit is not None and name != "theta_c":
            notes.append(f"{name}: jumps by {jump:.3g} rad; if the encoder wraps, set wrap")
    return values


def _at_ticks(
    name: str,
    t: Array,
    values: Array,
    T: float,
    ticks: int,
    longest_gap: float | None,
    notes: list[str],
) -> Array:
    """Values of a column, sampled at times t [s], at the ticks."""
    finite = np.isfinite(t) & np.isfinite(values)
    if not finite.any():
        raise LogError(f"port {name}: its column holds no number; take it out or name another")
    if not finite.all():
        t, values = t[finite], values[finite]
    if longest_gap is None and len(t) == ticks and not _off_ticks(t, T).any():
        return values  # the common case, without the memory that the others take
    missing = len(finite) - len(t)
    position = t / T
    nearest = np.round(position)
    at = (np.abs(position - nearest) <= _AT_TICK) & (nearest >= 0) & (nearest < ticks)
    found = np.full(ticks, np.nan)
    found[nearest[at].astype(np.int64)] = values[at]
    usual = float(np.median(np.diff(t))) if len(t) > 1 else T
    even = bool(abs(usual / T - 1) < _AT_TICK and np.count_nonzero(at) > 0.99 * len(t))
    gap = longest_gap if longest_gap is not None else 0.0 if even else _USUAL_INTERVALS * usual
    empty = np.flatnonzero(np.isnan(found))
    after = np.searchsorted(position, empty)
    inside = (after > 0) & (after < len(t))
    empty, after = empty[inside], after[inside]
    near = t[after] - t[after - 1] <= gap * (1 + _AT_TICK)
    empty = empty[near]
    found[empty] = np.interp(empty.astype(np.float64), position, values)
    _note(name, t, usual, T, at, len(empty), missing, even, notes)
    return found


def _off_ticks(t: Array, T: float) -> NDArray[np.bool_]:
    off = t / T
    off -= np.arange(len(t))
    return np.abs(off, out=off) > _AT_TICK


def _note(
    name: str,
    t: Array,
    usual: float,
    T: float,
    at: NDArray[np.bool_],
    interpolated: int,
    missing: int,
    even: bool,
    notes: list[str],
) -> None:
    if interpolated:
        why = "" if even else f", its samples are {usual:.3g} s apart"
        notes.append(f"{name}: {interpolated} ticks interpolated{why}")
    if usual < T * (1 - _AT_TICK):
        notes.append(f"{name}: faster than the ticks, samples between them left out, no filter")
    elif np.count_nonzero(~at) and even:
        notes.append(f"{name}: {np.count_nonzero(~at)} samples between ticks")
    if missing and abs(usual / T - 1) < 0.5:
        notes.append(f"{name}: {missing} samples missing or not finite")


def stretches(mask: ArrayLike) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Where the stretches of true values begin, and where each ends: the index behind its last."""
    edges = np.diff(np.concatenate([[0], np.asarray(mask, dtype=np.int8), [0]]))
    return np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)


def _note_skipped(values: Array, T: float, notes: list[str]) -> None:
    skipped = np.isnan(values).any(axis=1)
    if not skipped.any():
        return
    first, last = stretches(skipped)
    longest = int(np.argmax(last - first))
    notes.append(
        f"{np.count_nonzero(skipped)} ticks skipped in {len(first)} gaps, the longest of "
        f"{(last - first)[longest] * T:.3g} s at {first[longest] * T:.6g} s after the start; "
        "the estimator keeps its estimate over them"
    )
