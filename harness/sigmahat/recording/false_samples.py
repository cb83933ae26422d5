"""Finds samples of a column that are none: placeholders, held values, and a counter that returns.

A placeholder is one value, such as 0, -1 or 9999, in rows without a sample: a second publisher of
the topic sends it, or a driver writes it when the sensor does not answer. A value is held if a
sensor is slower than the log, or if it did not answer. A counter that returns begins again at any
value, not at the end of its range.

`init` and the resampling ask the same functions, and `check` reads the notes of the resampling.
These functions are certain or say nothing: a joint at rest, slow motion in steps of an encoder, a
torque at its limit and an impact remain as they are. A drive may hold a torque and may change it at
any rate, so that only placeholders of up to three rows are found in a torque.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sigmahat.recording.column import usual_period
from sigmahat.recording.gaps import stretches
from sigmahat.recording.log import Array

_PART = 1 << 16  # samples that are compared at a time, to limit the memory
_LOOKED_AT = 20_000  # approximate number of values whose range and steps are computed
_FEW = 50  # with fewer distinct values, a signal is a series of steps
_MANY_TIMES = 10.0  # least ratio of a suspicious step to the median step
_FAR = 0.05  # least distance of a placeholder from its neighbours, relative to the range
_UNUSUAL_POSITION, _UNUSUAL_TORQUE = 2.0, 5.0  # the same, relative to large usual steps
_SUDDEN = 5.0  # the same, relative to the steps before and after both neighbours
_LARGE_STEP = 0.99  # quantile of the steps that counts as a large usual step
_CANDIDATES = 3  # values that are tried as placeholders
_CLOSE = 0.2  # ratio of the distance of both neighbours to their distance from a placeholder
_SHORT = 3  # most rows of a placeholder in a torque
_LIMIT = 0.3  # distance of a limit from the other torques, relative to their range
_LEAST = 3  # rows that are certainly false, before all rows with the value are
_OPPOSITE = 0.1  # tolerance of a jump over the whole range, relative to the range
_COUNTS = 8.0  # least step before and after a held value, in steps of the encoder
_FINEST = 1e-3  # the same, relative to the range or to large usual steps
_CAUGHT_UP = 0.6  # least ratio of the step after a held value to the motion that it missed
_BESIDE = 2.5  # least ratio of the step after a held value to the steps around
_REGULAR = 0.8  # share of values of a slow sensor that are held over the usual number of rows
_MOVING = 0.3  # share of the values of a slow sensor that change by more than _COUNTS
_HELD = 50  # least number of values of a slow sensor
_JUMP = 0.1  # least jump of a counter that returns, relative to the range
_SAME_JUMP = 0.01  # tolerance of jumps of equal size
_APART = 10  # least number of samples between two jumps
_NEXT = 3.0  # largest time over a jump, in usual times between samples


@dataclass(frozen=True)
class Placeholder:
    """A value in rows without a sample."""

    value: float  # in the unit of the column
    rows: NDArray[np.int64]  # from 0 on
    first: int  # the first of these rows that certainly has no sample


@dataclass(frozen=True)
class FalseSamples:
    """Rows of a column that have no sample although they have a value."""

    placeholders: Sequence[Placeholder] = ()
    held: NDArray[np.int64] | None = None
    """Rows, from 0 on, that repeat an earlier value while the joint moves; None without any."""

    @property
    def rows(self) -> int:
        """Number of all these rows."""
        held = 0 if self.held is None else len(self.held)
        return held + sum(len(each.rows) for each in self.placeholders)

    def left_out(self, values: Array) -> Array:
        """Returns the values with nan in these rows; without a copy if there are none."""
        if not self.rows:
            return values
        values = values.copy()
        for placeholder in self.placeholders:
            values[placeholder.rows] = np.nan
        if self.held is not None:
            values[self.held] = np.nan
        return values


def false_samples(values: Array, is_position: bool, wrap: float | None = None) -> FalseSamples:
    """Finds placeholders and held values in a column.

    values       [size: samples], nan where a sample is missing
    is_position  whether the column is the angle of motor or link, which cannot change suddenly
    wrap         period of a counter that starts again, in the unit of the column
    """
    if not _is_suspect(values, is_position):
        return FalseSamples()
    rows = np.flatnonzero(np.isfinite(values))
    given = values[rows]
    if not _is_varied(given):
        return FalseSamples()
    placeholders = [
        Placeholder(each.value, rows[each.rows], int(rows[each.first]))
        for each in _placeholders(given, is_position, wrap)
    ]
    if not is_position:
        return FalseSamples(placeholders)
    is_true = np.isfinite(FalseSamples(placeholders).left_out(values))
    rows = np.flatnonzero(is_true)
    held = _held(values[rows])
    return FalseSamples(placeholders, rows[held] if len(held) else None)


def _is_varied(values: Array) -> bool:
    return len(np.unique(values[:: max(1, len(values) // _LOOKED_AT)])) >= _FEW


def _is_suspect(values: Array, is_position: bool) -> bool:
    """Whether the column has a large step, or is a position that stops within one row.

    Nearly all columns have neither, and are not looked at any further.
    """
    sample = values[:: max(1, len(values) // _LOOKED_AT)]
    sample = sample[np.isfinite(sample)]
    if len(sample) < _FEW:
        return False
    span = float(np.diff(np.quantile(sample, [0.02, 0.98]))[0])
    for first in range(0, len(values), _PART):
        part = values[max(first - 1, 0) : first + _PART]
        size = np.diff(part)
        size = np.abs(size, out=size)
        if not np.isfinite(size).all():
            part = part[np.isfinite(part)]
            size = np.abs(np.diff(part))
        if len(size) < 2:
            continue
        largest = float(size.max())
        if largest > _FAR * span:
            # Rows of two senders may alternate, so that every second row goes on.
            usual = min(np.median(size), np.median(np.abs(part[2:] - part[:-2])))
            if largest > _MANY_TIMES * usual:
                return True
        least = max(_FINEST * span, 1e-300)
        if is_position and largest > least:
            stops = np.flatnonzero((size[1:] == 0) & (size[:-1] > least))
            if len(stops):
                count = float(size[size > 1e-9 * largest].min())
                if float(size[stops].max()) > _COUNTS * count:
                    return True
    return False


def _placeholders(values: Array, is_position: bool, wrap: float | None) -> Iterator[Placeholder]:
    """Yields values that the column takes suddenly, and leaves suddenly."""

    def away(difference: Array) -> Array:
        if wrap is not None:
            difference = difference - wrap * np.rint(difference / wrap)
        return np.abs(difference)

    candidates = _candidates(values, away(np.diff(values)))
    if not candidates:
        return
    other = np.flatnonzero(~np.isin(values, candidates))
    rest = values[other]
    if len(rest) < _FEW or not _is_varied(rest):
        return
    low, high = float(rest.min()), float(rest.max())
    span = high - low
    steps = away(np.diff(rest))
    unusual = _UNUSUAL_POSITION if is_position else _UNUSUAL_TORQUE
    far = max(_FAR * span, unusual * float(np.quantile(steps, _LARGE_STEP)))
    for value in candidates:
        begins, ends = stretches(values == value)
        length = ends - begins
        after = np.searchsorted(other, begins)  # place of the next value in rest
        inside = (after >= 2) & (after < len(rest) - 1)
        after, lengths = after[inside], length[inside]
        to, fro = away(value - rest[after - 1]), away(value - rest[after])
        least = np.minimum(to, fro)
        certain = (least > far) & (least > _SUDDEN * np.maximum(steps[after - 2], steps[after]))
        if wrap is None and low <= value <= high:
            # A counter that starts again jumps over its whole range, at its end to and fro.
            certain &= np.abs(least / span - 1) > _OPPOSITE
        if not is_position:
            certain &= (lengths <= _SHORT) & (steps[after - 1] < _CLOSE * least)
            near = _LIMIT * span
            is_limit = not low < value < high and low - near <= value <= high + near
            if is_limit and value != 0:
                continue  # of the drive or of the sensor
        if int(np.sum(lengths[certain])) < _LEAST:
            continue
        is_outside = not low - far < value < high + far
        longest = math.inf if is_outside else int(lengths[certain].max())
        false = [np.arange(a, b) for a, b in zip(begins, ends, strict=True) if b - a <= longest]
        yield Placeholder(value, np.concatenate(false), int(begins[inside][certain][0]))


def _candidates(values: Array, steps: Array) -> list[float]:
    """Returns the values that the column takes and leaves most often by large steps.

    steps  between the values, without sign
    """
    looked_at = values[:: max(1, len(values) // _LOOKED_AT)]
    span = float(np.diff(np.quantile(looked_at, [0.02, 0.98]))[0])
    large = np.flatnonzero(steps > _FAR * span)
    if len(large) < 2:
        return []
    first, last = large[:-1] + 1, large[1:]  # rows between two large steps
    is_one = values[first] == values[last]
    distinct, place = np.unique(values[first[is_one]], return_inverse=True)
    rows = np.bincount(place, weights=(last - first + 1)[is_one], minlength=len(distinct))
    most = np.argsort(-rows)[:_CANDIDATES]
    return [float(distinct[i]) for i in most if rows[i] >= _LEAST]


def _held(values: Array) -> NDArray[np.int64]:
    """Returns the rows that repeat a value held over a dropout, or by a sensor slower than the log.

    The first row of such a value is a sample.
    """
    none = np.empty(0, np.int64)
    change = np.flatnonzero(np.diff(values) != 0) + 1  # first row of each value but the first
    if len(change) < 4:
        return none
    steps = values[change] - values[change - 1]
    size = np.abs(steps)
    count = float(size[size > 1e-9 * size.max()].min())
    least = max(_COUNTS * count, _FINEST * float(np.quantile(size, _LARGE_STEP)))
    rows = np.diff(change)  # over which each value lasts
    large = size > least
    goes_on = large[:-1] & large[1:] & (steps[:-1] * steps[1:] > 0)
    usual = _rows_of_slow_sensor(rows[goes_on], len(rows))
    if usual is not None:
        return _repeats(change, len(values), usual)
    # The step after the held value makes up for the motion that was missed.
    beyond = np.append(size[2:], np.inf)
    missed = rows * np.minimum(size[:-1], beyond)
    held = goes_on & np.append(goes_on[1:], False) & (rows >= _LEAST)
    held &= size[1:] > np.maximum(_CAUGHT_UP * missed, _BESIDE * np.maximum(size[:-1], beyond))
    ends = zip(change[:-1][held], rows[held], strict=True)
    return np.concatenate([none, *(np.arange(first + 1, first + n) for first, n in ends)])


def _rows_of_slow_sensor(rows: NDArray[np.int64], values: int) -> int | None:
    """Returns the usual number of rows with one value of a sensor slower than the log, else None.

    rows    over which the values last that differ clearly from those before and after
    values  number of all values
    """
    if len(rows) < max(_HELD, _MOVING * values):
        return None
    usual = int(np.median(rows))
    return usual if usual >= 2 and float(np.mean(np.abs(rows - usual) <= 1)) > _REGULAR else None


def _repeats(change: NDArray[np.int64], length: int, usual: int) -> NDArray[np.int64]:
    """Returns the rows of a column that repeat the value of a slow sensor.

    A sensor at rest has a new sample of the same value after the usual number of rows.

    change  first row of each value but the first
    length  number of rows
    """
    firsts = np.append(0, change)
    rows = np.diff(np.append(firsts, length))
    place = np.arange(length) - np.repeat(firsts, rows)
    is_rest = np.repeat(rows > usual + 1, rows)
    is_sample = (place == 0) | (is_rest & (place % usual == 0))
    return np.flatnonzero(~is_sample)


@dataclass(frozen=True)
class Returns:
    """Jumps of a counter that begins again at any value."""

    rows: NDArray[np.int64]  # first row after each jump, from 0 on
    offsets: Array  # by which values are too large from there on, in the unit of the column

    @property
    def period(self) -> float | None:
        """The size of all jumps, in the unit of the column; None if they differ."""
        return float(abs(self.offsets[0])) if np.ptp(np.abs(self.offsets)) == 0 else None

    def joined(self, values: Array) -> Array:
        """Returns the values of the column without the jumps."""
        offset = np.zeros(len(values))
        offset[self.rows] = self.offsets
        return values - np.cumsum(offset, out=offset)


def returns(values: Array, t: Array | None) -> Returns | None:
    """Finds jumps between two smooth parts of the angle of motor or link; None without a jump.

    values  without placeholders [size: samples], nan where a sample is missing
    t       times [s], nan where unknown; None for even times. A joint moves during a gap, so that
            a step over a gap is no jump.
    """
    if not _is_suspect(values, is_position=True):
        return None
    rows = np.flatnonzero(
        np.isfinite(values) if t is None else np.isfinite(values) & np.isfinite(t)
    )
    given = values[rows]
    if len(given) < 2 * _APART or not _is_varied(given):
        return None
    steps = np.diff(given)
    size, span = np.abs(steps), float(np.ptp(given))
    jumps = np.flatnonzero(size > _JUMP * span)
    if t is not None:
        times = np.diff(t[rows])
        jumps = jumps[times[jumps] < _NEXT * float(np.median(times))]
    jumps = jumps[(jumps >= 3) & (jumps < len(steps) - 3)]
    if not len(jumps) or (len(jumps) > 1 and np.diff(jumps).min() < _APART):
        return None
    around = np.max([size[jumps + k] for k in (-3, -2, -1, 1, 2, 3)], axis=0)
    usual = float(np.quantile(size, _LARGE_STEP))
    if not np.all(size[jumps] > np.maximum(_SUDDEN * around, _UNUSUAL_POSITION * usual)):
        return None
    coming = 0.5 * (steps[jumps - 1] + steps[jumps + 1])
    offsets = steps[jumps] - coming
    period = float(np.median(np.abs(offsets)))
    if np.all(np.abs(np.abs(offsets) / period - 1) < _SAME_JUMP):
        offsets = np.sign(offsets) * (usual_period(period) or period)
    return Returns(rows[jumps + 1], offsets)
