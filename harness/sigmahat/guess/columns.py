"""Analyses the columns of a log for the guess: names, values, steps, counters, and times."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from sigmahat.guess.words import Meaning, meaning
from sigmahat.recording.column import period_of_counter, step_of_encoder
from sigmahat.recording.counters import Unwrapping
from sigmahat.recording.false_samples import false_samples, returns
from sigmahat.recording.limits import check_together
from sigmahat.recording.log import Array, Log, LogError
from sigmahat.recording.resampling import usual_gap
from sigmahat.recording.times import set_back
from sigmahat.recording.units import seconds

_MOSTLY = 0.99  # least fraction of increasing steps in a column of times
_NAMED = 0.8  # least fraction of increasing steps in a column that is named as times
_REPEATED = 0.3  # least fraction of steps that change in such a column
_SAME_TIMES = 0.01  # tolerance of the time between samples, relative to that between rows
_EVEN = 0.05  # largest relative difference of a step from the usual step
_MISSING = 1.8  # ratio of a time step to the usual step beyond which rows are lost
_GAP = 3.0  # ratio of a time step to the usual step beyond which the step is a gap
_EPOCH = {"ns": 1e17, "us": 1e14, "ms": 1e11, "s": 1e8}  # from about 1973 on
_FASTEST, _SLOWEST = 2e-5, 0.2  # usual time between rows of a log [s]
_SLOW = 0.05  # largest time between rows with which a stiffness can be estimated well [s]
_DISTINCT = 20000  # number of values that are searched for a signal with a few states
_STATES = 8  # least number of distinct values of a signal that is no state or flag
_STEPS = 5  # least number of steps between distinct values of an encoder


@dataclass(frozen=True)
class Facts:
    low: float = np.nan  # smallest value; nan if there is no number
    high: float = np.nan  # largest value; nan if there is no number
    integer: bool = False
    """Whether all values are whole numbers, with more than a few distinct values."""
    varies: bool = False  # whether the column has more than a few distinct values
    increasing: float = 0.0  # fraction of the steps that increase [1]
    step: float = np.inf
    """Distance between neighbouring values of a quantised column; inf if it is not quantised."""
    wrap: float | None = None
    """Period after which a counter starts again; None if the column is no such counter."""
    text: str = ""  # error message for a column that does not contain numbers


def look_at(log: Log, name: str, quantity: str | None) -> tuple[Facts, Array]:
    """Reads facts and unwrapped values of a column; no values if the column contains text.

    quantity  by the name of the column
    """
    try:
        values = log.read(name)
    except LogError as error:
        return Facts(text=str(error)), np.empty(0)
    if quantity != "time":
        values = false_samples(values, quantity == "position").left_out(values)
    finite = values[np.isfinite(values)]
    if not len(finite):
        return Facts(), values
    steps = np.diff(finite)
    few = len(np.unique(finite[:_DISTINCT])) < min(_STATES, len(finite))
    integer = not few and bool(np.all(finite == np.round(finite)))
    wrap = None if few or quantity == "time" else period_of_counter(steps, float(np.ptp(finite)))
    increasing = float(np.mean(steps > 0)) if len(steps) else 0.0
    ends = float(finite.min()), float(finite.max())
    step = 1.0 if integer else step_of_encoder(finite, _STEPS)
    facts = Facts(*ends, integer, not few, increasing, step, wrap)
    return facts, values if wrap is None else Unwrapping(wrap).unwrap(values)


def is_clock(meaning: Meaning, facts: Facts, values: Array) -> bool:
    """Returns whether a column contains times, by its name or by evenly increasing values."""
    if facts.text or not facts.varies or facts.wrap is not None:
        return False
    if meaning.quantity == "time" and _is_repeated(values):
        return True
    least = _NAMED if meaning.quantity == "time" else _MOSTLY
    if facts.increasing < least:
        return False
    if meaning.quantity is not None:
        return meaning.quantity == "time"
    steps = np.diff(values[np.isfinite(values)])
    return bool(np.mean(np.abs(steps / np.median(steps) - 1) < _EVEN) > 0.9)


def _is_repeated(times: Array) -> bool:
    """Returns whether times increase, but stand in several rows, as with two subscriptions."""
    steps = np.diff(times[np.isfinite(times)])
    changes = steps[steps != 0]
    return len(changes) > _REPEATED * len(steps) and float(np.mean(changes > 0)) >= _NAMED


def unit_of(meaning: Meaning, facts: Facts, values: Array) -> str:
    """Finds the unit of a column of times from its name, else from its values and their steps."""
    if meaning.unit in _EPOCH:
        return str(meaning.unit)
    for unit, least in _EPOCH.items():
        if facts.low > least:
            return unit
    steps = np.diff(values[np.isfinite(values)])
    step = float(np.median(steps)) if len(steps) else 1e-3
    if facts.integer and step >= 1:  # a computer counts in units that are finer than its steps
        return "ms" if step < 100 else "us" if step < 50_000 else "ns"
    return _plausible(step, _SLOWEST) or "s"


def likely_unit(unit: str, T: float) -> str | None:
    """Proposes another unit of the times, if the time between rows is implausible; else None.

    unit  assumed unit of the times
    T     usual time between rows with that unit [s]
    """
    if _FASTEST <= T <= _SLOW:
        return None
    return _plausible(T / seconds(unit), _SLOW)


def _plausible(step: float, most: float) -> str | None:
    """Finds the unit in which a time step is plausible, at most `most` [s]; None without one.

    Spreadsheets and MATLAB count times in days.
    """
    units = ("s", "ms", "us", "ns", "day")
    return next((each for each in units if _FASTEST <= step * seconds(each) <= most), None)


def interval(times: Array) -> float:
    """Computes the usual time between rows [s], from times [s] without gaps, rounding and jitter;
    1e-3 without two different times."""
    steps = np.diff(times[np.isfinite(times)])
    steps = steps[steps > 0]
    if not len(steps):
        return 1e-3
    usual = float(np.median(steps))
    near = steps[np.abs(steps / usual - 1) < _EVEN]
    if len(near) > 0.9 * len(steps):
        return _rounded(near)
    if _is_coarse(steps, usual):
        return float(f"{steps[steps < _GAP * usual].mean():.4g}")
    steps = steps[steps < _GAP * usual]
    rows = np.where(steps > _MISSING * usual, np.round(steps / usual), 1)
    return _round(float(steps.sum() / rows.sum()))


def _is_coarse(steps: Array, usual: float) -> bool:
    """Returns whether times are rounded times of an even clock: 1, 2, 1, 2 ms for 1.5 ms.

    With rounding, the error of each time is below the resolution. Errors by lost rows accumulate.
    """
    gaps = np.flatnonzero(steps >= _GAP * usual)
    edges = np.r_[-1, gaps, len(steps)]
    longest = int(np.argmax(np.diff(edges)))
    whole = steps[edges[longest] + 1 : edges[longest + 1]]
    if len(whole) < 8 or len(np.unique(np.round(whole / usual, 3))) > 3:
        return False
    times = np.cumsum(whole)
    off = times - np.polyval(np.polyfit(np.arange(len(times)), times, 1), np.arange(len(times)))
    return bool(np.abs(off).max() < whole.min())


def _rounded(steps: Array) -> float:
    """Computes the mean of steps with at most six digits, and no more than their jitter allows."""
    mean = float(steps.mean())
    tolerance = 2.0 * float(steps.std()) / math.sqrt(len(steps))
    for digits in range(1, 6):
        short = float(f"{mean:.{digits}g}")
        if abs(short - mean) <= tolerance:
            return short
    return float(f"{mean:.6g}")


def _round(T: float) -> float:
    """Rounds the period of a clock with jitter, if a round number is within 1 % of T."""
    short = float(f"{T:.2g}")
    rate = 1 / float(f"{1 / T:.2g}")
    best = min((short, rate), key=lambda each: abs(each / T - 1))
    return float(f"{best if abs(best / T - 1) < 0.01 else T:.6g}")


_LOST = 1e-3  # least number of gaps that are interpolated, relative to the number of rows
_LONGEST_GAP = 10  # longest gap in rows in which the motion of a joint can be interpolated


def lost_rows(times: Array, T: float) -> float | None:
    """Returns the longest short gap between rows with a usual period T [s], if single rows are lost
    throughout the log; else None."""
    steps = np.diff(times[np.isfinite(times)])
    short = steps[(steps > _MISSING * T) & (steps < (_LONGEST_GAP + 0.5) * T)]
    if not len(short) > _LOST * len(steps):
        return None
    return float(f"{round(float(short.max()) / T) * T:.6g}")


@dataclass(frozen=True)
class TimeColumn:
    unit: str = "s"
    interval: float = 1e-3  # usual time between rows [s]
    longest_gap: float | None = None  # as `lost_rows`


def usual_times(columns: Iterable[TimeColumn]) -> TimeColumn:
    """Returns the times of the columns of one joint, with a unit in common: those of the fastest,
    and a longest gap that suits all."""
    columns = list(columns)
    fastest = min(columns, key=lambda column: column.interval)
    gaps = [column.longest_gap for column in columns if column.longest_gap is not None]
    slowest = max(column.interval for column in columns)
    if gaps and slowest > _MISSING * fastest.interval:
        gaps.append(float(f"{usual_gap(slowest):.6g}"))
    return replace(fastest, longest_gap=max(gaps, default=None))


def _times(values: Array, unit: float) -> Array:
    """Returns the times of a column [s], also of a clock that started again; unit: in seconds."""
    times = values * unit
    finite = np.isfinite(times)
    if np.count_nonzero(finite) > 1:
        back = set_back(times[finite], unit)
        if back is not None:
            times[finite] = back.continued(times[finite])
    return times


def _samples_of(values: Array, t: Array | None, clock: TimeColumn) -> TimeColumn:
    """Returns the times of the samples of one column, which may be fewer than the rows.

    t      times of the rows [s]; None without times
    clock  the times of the rows
    """
    finite = np.isfinite(values)
    if t is None or finite.all() or np.count_nonzero(finite) < 2:
        return clock
    given = t[finite]
    T = interval(given)
    if abs(T / clock.interval - 1) < _SAME_TIMES:
        return clock
    return TimeColumn(clock.unit, T, lost_rows(given, T))


def _joined(facts: Facts, values: Array, t: Array | None) -> tuple[Facts, Array]:
    """Removes the jumps of a counter that starts again at any value; t: times of the rows [s]."""
    jumps = returns(values, t)
    if jumps is None:
        return facts, values
    return replace(facts, wrap=jumps.period), jumps.joined(values)


_WINDOW = 20_000  # samples in which columns are compared


@dataclass(frozen=True)
class Column:
    name: str
    meaning: Meaning
    facts: Facts
    clock: str | None  # the column with the times of this column; None without times
    samples: TimeColumn  # the times of its samples, in rows with a value
    window: Array
    """Unwrapped values in the part with most motion, at the same times for all columns [size: n];
    empty if the column has no numbers."""


@dataclass(frozen=True)
class Columns:
    signals: Sequence[Column]
    clocks: Mapping[
        str | None, TimeColumn
    ]  # clocks by column of times; the last, None, for no times
    facts: Mapping[str, Facts]  # facts of all columns, by name
    window_T: float  # time between the samples of the windows [s]

    @property
    def unreadable(self) -> list[str]:
        """Error messages on columns with names of signals but without numbers."""
        texts = [each for each in self.signals if each.facts.text]
        return [each.facts.text for each in texts if each.meaning.quantity is not None]


def read_columns(log: Log) -> Columns:
    """Reads and analyses every column of a log once."""
    check_together(log.path, sum(log.columns.values()))
    facts: dict[str, Facts] = {}
    values: dict[str, Array] = {}
    with_units = {name: f"{name} [{unit}]" for name, unit in log.units.items()}
    meanings = {name: meaning(with_units.get(name, name)) for name in log.columns}
    for name in log.dates:  # read in s, whatever their name says
        meanings[name] = replace(meanings[name], quantity="time", unit="s")
    for name in log.columns:
        facts[name], values[name] = look_at(log, name, meanings[name].quantity)
        if meanings[name].side == "setting":  # two settings make a set-point
            facts[name] = replace(facts[name], varies=facts[name].low < facts[name].high)
    units = {
        name: unit_of(meanings[name], facts[name], values[name])
        for name in log.columns
        if is_clock(meanings[name], facts[name], values[name])
    }
    named = {name: unit for name, unit in units.items() if meanings[name].quantity == "time"}
    units = named or units
    times = {name: _times(values[name], seconds(unit)) for name, unit in units.items()}
    clocks: dict[str | None, TimeColumn] = {}
    for name, t in times.items():
        T = interval(t)
        clocks[name] = TimeColumn(units[name], T, lost_rows(t, T))
    clocks[None] = TimeColumn()
    clock_of = {}  # from the same group or topic, else any clock of equal length
    for name, samples in log.columns.items():
        same = [each for each in units if log.columns[each] == samples]
        clock_of[name] = max(same, key=partial(_common, name), default=None)
    signals = [name for name in log.columns if name not in units]
    moving = [name for name in signals if facts[name].varies]
    samples_of = {}
    for name in signals:
        clock, of_rows = clocks[clock_of[name]], times.get(clock_of[name] or "")
        samples_of[name] = _samples_of(values[name], of_rows, clock)
        may_be_position = meanings[name].quantity in ("position", None)
        if may_be_position and facts[name].wrap is None and facts[name].varies:
            facts[name], values[name] = _joined(facts[name], values[name], of_rows)
    T = min((samples_of[name].interval for name in moving), default=clocks[None].interval)
    windows = dict.fromkeys(signals, np.empty(0)) | _windows(moving, values, clock_of, times, T)
    found = [
        Column(n, meanings[n], facts[n], clock_of[n], samples_of[n], windows[n]) for n in signals
    ]
    return Columns(found, clocks, facts, T)


def _common(one: str, other: str) -> int:
    """Returns the number of leading letters that two names share, up to the last separator."""
    same = [a == b for a, b in zip(one, other, strict=False)]
    shared = one[: [*same, False].index(False)]
    return 1 + max(shared.rfind("/"), shared.rfind("."))


def _windows(
    names: Sequence[str],
    values: Mapping[str, Array],
    clocks: Mapping[str, str | None],
    times: Mapping[str, Array],
    T: float,
) -> dict[str, Array]:
    """Interpolates columns at common times, T apart, in the part of the log with most motion."""

    def samples(name: str) -> tuple[Array, Array]:
        """Computes the samples at each call, because all columns together need much memory."""
        column = clocks[name]
        t = times[column] if column else np.arange(len(values[name]), dtype=np.float64) * T
        x = values[name]
        good = np.isfinite(t) & np.isfinite(x)
        if not good.all():
            t, x = t[good], x[good]
        if len(t) and not np.all(np.diff(t) > 0):
            order = np.argsort(t, kind="stable")
            t, x = t[order], x[order]
        return t, x

    if not names:
        return {}
    ends = [(float(t[0]), float(t[-1])) for t, _ in map(samples, names)]
    start, end = max(a for a, _ in ends), min(b for _, b in ends)
    if end <= start:  # signals that were never recorded together
        return {}
    first = _liveliest(lambda: map(samples, names), start, end, _WINDOW * T)
    last = min(end, first + _WINDOW * T)
    grid = np.arange(first, last, T)
    return {name: np.interp(grid, *samples(name)) for name in names}


def _liveliest(
    samples: Callable[[], Iterable[tuple[Array, Array]]], start: float, end: float, length: float
) -> float:
    """Finds the start of the part with the given length in which the columns vary most."""
    if end - start < 2 * length:
        return start
    # Parts without samples are skipped, because a clock set during the log may jump by years.
    occupied = [
        np.unique((t[(t >= start) & (t < end)] - start) // length).astype(np.int64)
        for t, _ in samples()
    ]
    begins = start + length * np.unique(np.concatenate(occupied))
    motion = np.zeros(len(begins))
    for t, x in samples():
        ends = zip(np.searchsorted(t, begins), np.searchsorted(t, begins + length), strict=True)
        spread = [float(np.std(x[a:b])) if b > a else 0.0 for a, b in ends]
        motion += np.array(spread) / (max(spread) or 1.0)
    return float(begins[int(np.argmax(motion))])
