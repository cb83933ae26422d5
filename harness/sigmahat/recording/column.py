"""Finds what a column of samples looks like: steps of an encoder, a counter that starts again,
single samples that were lost, and values that stay at an end of their range.

The guess of a configuration (`init`) and its check ask the same functions.
"""

import math
from dataclasses import dataclass

import numpy as np

from sigmahat.recording.log import Array
from sigmahat.recording.units import TURN

_LOOKED_AT = 20_000  # approximate number of values that are searched for the step of an encoder
_FEWEST_COUNTS = 100  # least number of encoder counts per turn
_EXACTLY = 1e-5  # largest relative difference of a step from a usual one
_NEARLY = 0.1  # largest difference of counts per turn from a multiple of 100
_PERIODS = (360.0, 2 * np.pi, *(2.0**k for k in range(8, 33)), 1.0)
"""Usual periods of a counter, in degrees, in radians, in counts, and in turns."""
_SAME_PERIOD = 0.02  # largest relative difference between a jump and a usual period
_JUMP = 0.5  # least step at which a counter starts again, relative to the range of the values
_WHOLE_RANGE = 0.9  # least step of a counter that certainly starts again, as _JUMP
_SMALL = 0.2  # largest ratio of the usual steps to the jumps of a counter
_LEAST = 20  # samples that are needed to find a lost one
_SPIKE, _UNUSUAL, _ALONE = 0.1, 20.0, 5.0
"""Least distance of a spike from both neighbours, relative to the range, to the usual distance and
the encoder step, and to the distance between the neighbours."""
_SMOOTH = 0.01  # least distance of a spike relative to the range, without an encoder step
RARE = 0.01  # fraction of all samples; more spikes than this are the motion itself
_FROZEN = 0.03  # least fraction of the rows in which a dead encoder keeps its value
_MOVES_ON = 0.25  # least range of the other position there, relative to its whole range
_FLAT = 3  # consecutive samples at an end of the range
_FEW = 50  # with fewer distinct values, a signal is a series of steps


def step_of_encoder(finite: Array, fewest: int) -> float:
    """Finds the step of which almost all differences of the values are multiples; inf without such
    a step, or with fewer steps between distinct values than `fewest`.

    finite  values of a column, in its unit, without nan; about 20000 of them are searched
    """
    distinct = np.unique(finite[:: max(1, len(finite) // _LOOKED_AT)])
    steps = np.diff(distinct)
    steps = steps[steps > 1e-9 * max(np.ptp(distinct), 1e-300)] if len(steps) else steps
    if not len(steps):
        return np.inf
    step = float(np.median(steps[steps < 1.5 * steps.min()]))
    ratio = steps / step
    even = np.abs(ratio - np.round(ratio)) < 0.05
    near = ratio < 10  # rounding of text hides the remainder of a larger ratio
    if np.count_nonzero(near) < fewest or np.mean(even[near]) <= 0.95:
        return np.inf
    # The mean of many steps is more exact than the last digits of the values, and the more exact
    # the step is, the larger are the distances of which it tells the multiple.
    for most in (10.0, 100.0, 1000.0, np.inf):
        ratio = steps / step
        even = (np.abs(ratio - np.round(ratio)) < 0.05) & (ratio < most)
        step = float(np.sum(steps[even]) / np.sum(np.round(ratio[even])))
    return step


def counts_of_steps(step: float, unit: str) -> int:
    """Computes counts per turn of an encoder with the given step; 0 without an encoder.

    step  as step_of_encoder(), in `unit`; any unit other than those in TURN has no counts
    """
    counts = TURN[unit] / step if unit in TURN else 0.0
    return round(counts) if counts >= _FEWEST_COUNTS else 0


def is_decimal(step: float) -> bool:
    """Returns whether a step is that of a decimal place, 1, 2 or 5 times a power of ten: a text is
    rounded so, whatever its unit is."""
    if not 0 < step < math.inf:
        return False
    digit = step / 10.0 ** math.floor(math.log10(step) + _EXACTLY)
    return any(abs(digit / place - 1) < _EXACTLY for place in (1, 2, 5))


def unit_of_steps(step: float) -> str | None:
    """Finds the unit in which the steps of an angle are a usual part of a turn, such as 1/4096;
    None for the steps of a decimal place, which occur in any unit."""
    if is_decimal(step):
        return None
    for unit in ("deg", "rad", "turn"):
        counts = TURN[unit] / step
        n = round(counts)
        if n < _FEWEST_COUNTS or abs(counts / n - 1) > _EXACTLY:
            continue
        # Among large numbers many are nearly a multiple of 100.
        if n & (n - 1) == 0 or (n % 100 == 0 and abs(counts - n) < _NEARLY):
            return unit
    return None


def usual_period(size: float) -> float | None:
    """Returns the usual period of a counter that jumps by this size; None without such a period."""
    best = min(_PERIODS, key=lambda period: abs(period / size - 1))
    return best if abs(best / size - 1) < _SAME_PERIOD else None


def period_of_counter(steps: Array, span: float) -> float | None:
    """Finds the period after which a counter starts again; None if the column is no such counter.

    steps  differences of successive values
    span   range of the values
    """
    size = np.abs(steps)
    jumps = np.flatnonzero(size > _JUMP * span)
    if span == 0 or not len(jumps):
        return None
    usual_step = float(np.quantile(size, 0.99 if len(jumps) < 0.01 * len(size) else 0.5))
    if usual_step > _SMALL * size[jumps].min():
        return None
    inner = jumps[(jumps > 0) & (jumps < len(size) - 1)]
    if not len(inner):
        return None
    # The motion continues during a jump: the jump and the expected step add up to a period.
    coming = 0.5 * (steps[inner - 1] + steps[inner + 1])
    coming[np.abs(coming) > _SMALL * span] = 0.0
    period = float(np.median(np.abs(steps[inner] - coming)))
    usual = usual_period(period)
    if usual is not None:
        return usual
    # Another period is accepted only if the motion continues during each jump.
    noise = float(np.median(np.abs(np.diff(steps))))
    on = -np.sign(steps[inner]) * coming > 3 * noise
    return float(f"{period:.3g}") if len(inner) > 1 and on.all() else None


@dataclass(frozen=True)
class Restart:
    """A counter that jumps back by its whole range."""

    jump: float  # largest step, in the unit of the column
    period: float | None  # the usual period of a counter with this range; None without one


def restart(values: Array) -> Restart | None:
    """Finds a jump over the whole range of a column, among steps that are much smaller."""
    if len(values) < 2:
        return None
    steps, span = np.diff(values), float(np.ptp(values))
    jump = float(np.abs(steps, out=steps).max())
    if span == 0 or jump < _WHOLE_RANGE * span or float(np.quantile(steps, 0.9)) > _SMALL * jump:
        return None
    return Restart(jump, usual_period(span))


@dataclass(frozen=True)
class Spikes:
    """Single samples far from both neighbours, as if a bus or an encoder lost a value."""

    number: int
    largest: float  # largest distance of a sample from the mean of its neighbours


def spikes(values: Array, step: float) -> Spikes | None:
    """Finds single samples far from both neighbours; step: of the encoder, inf without one."""
    if len(values) < _LEAST:
        return None
    span = float(np.diff(np.quantile(values, [0.01, 0.99]))[0])
    away = np.abs(values[1:-1] - (values[2:] + values[:-2]) / 2)
    least = _SMOOTH * span if math.isinf(step) else _UNUSUAL * step
    unusual = max(least, _UNUSUAL * float(np.quantile(away, 1 - 5 * RARE)))
    lost = away > min(_SPIKE * span, unusual)
    lost &= away > _ALONE * np.abs(values[2:] - values[:-2])
    number = int(np.count_nonzero(lost))
    return Spikes(number, float(away.max())) if 0 < number < RARE * len(values) else None


def share_at_ends(values: Array) -> float:
    """Computes the fraction of samples in rows of at least three at an end of the range [1]; 0 for
    a signal with few distinct values."""
    if len(np.unique(values[:_LOOKED_AT])) < _FEW:
        return 0.0
    tolerance = 1e-6 * float(np.ptp(values))
    at_end = (values >= values.max() - tolerance) | (values <= values.min() + tolerance)
    return float(np.mean(np.convolve(at_end, np.ones(_FLAT), "same") >= _FLAT))


def frozen_from(values: Array, other: Array) -> int | None:
    """Finds the row, from 0 on, from which a position has one value to the end of the log although
    the other position moves on; None if there is none, or if the position never changes.

    other  position of the motor or of the link, at the same times
    """
    if len(other) != len(values):
        return None
    changes = np.flatnonzero(np.diff(values) != 0)
    if not len(changes):
        return None
    row = int(changes[-1]) + 1
    rest = other[row:]
    if len(rest) < _FROZEN * len(other):
        return None
    moves = np.nanmax(rest) - np.nanmin(rest) > _MOVES_ON * (np.nanmax(other) - np.nanmin(other))
    return row if moves else None
