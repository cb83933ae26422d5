"""Facts from the values of one column: range, counts, steps, and the period of a counter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sigmahat.logs.log import Array, Log, LogError
from sigmahat.logs.units import unwrap

TURN = {"rad": 2 * np.pi, "mrad": 2000 * np.pi, "deg": 360.0, "turn": 1.0}
"""A turn in units of angle."""
_DISTINCT = 20000  # number of values that are searched for the step of an encoder
_STATES = 8  # a column with fewer whole numbers is a state or a flag
_FEWEST_COUNTS = 100  # of an encoder in a turn
_JUMP = 0.5  # of the range: a larger step may be a counter that starts again
_SEEN = 0.02  # largest relative difference between a jump and a known period


@dataclass(frozen=True)
class Facts:
    """Facts of a column, from its values."""

    samples: int
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
    text: bool = False  # whether the column contains something other than numbers


def look_at(log: Log, name: str) -> tuple[Facts, Array]:
    """Facts of a column and its values, unwrapped; no values if the column contains text."""
    try:
        values = log.read(name)
    except LogError:
        return Facts(log.samples(name), text=True), np.empty(0)
    finite = values[np.isfinite(values)]
    if not len(finite):
        return Facts(len(values)), values
    steps = np.diff(finite)
    few = len(np.unique(finite[:_DISTINCT])) < min(_STATES, len(finite))
    integer = not few and bool(np.all(finite == np.round(finite)))
    wrap = None if few else _wrap(steps, float(np.ptp(finite)))
    facts = Facts(
        samples=len(values),
        low=float(finite.min()),
        high=float(finite.max()),
        integer=integer,
        varies=not few,
        increasing=float(np.mean(steps > 0)) if len(steps) else 0.0,
        step=1.0 if integer else _step(finite),
        wrap=wrap,
    )
    return facts, values if wrap is None else unwrap(values, wrap)[0]


def counts_per_turn(facts: Facts, unit: str) -> int:
    """Counts per turn of the encoder, from the steps of a column; 0 if too few for an encoder."""
    counts = TURN[unit] / facts.step if unit in TURN else 0.0
    return round(counts) if counts >= _FEWEST_COUNTS else 0


def unit_of_steps(facts: Facts) -> str | None:
    """Unit of an angle in which its steps are a usual part of a turn: 1/4096, 1/2000."""
    for unit in ("deg", "rad", "turn"):
        counts = TURN[unit] / facts.step
        n = round(counts)
        usual = n and (n & (n - 1) == 0 or n % 100 == 0)
        if usual and n >= _FEWEST_COUNTS and abs(counts / n - 1) < 1e-5:
            return unit
    return None


def _step(finite: Array) -> float:
    """Step of a quantised column; inf if the column is not quantised."""
    distinct = np.unique(finite[:_DISTINCT])
    steps = np.diff(distinct)
    steps = steps[steps > 1e-9 * max(np.ptp(distinct), 1e-300)] if len(steps) else steps
    if len(steps) < 5:
        return np.inf
    step = float(np.median(steps[steps < 1.5 * steps.min()]))
    ratio = steps / step
    even = np.abs(ratio - np.round(ratio)) < 0.05
    if np.mean(even) <= 0.95:
        return np.inf
    # Over many steps the last digits of the values matter less.
    return float(np.sum(steps[even]) / np.sum(np.round(ratio[even])))


def _wrap(steps: Array, span: float) -> float | None:
    """Period of a counter that starts again: a power of two, a full turn, or a round number."""
    size = np.abs(steps)
    jumps = np.flatnonzero(size > _JUMP * span)
    if span == 0 or not len(jumps):
        return None
    usual = (
        float(np.quantile(size, 0.99)) if len(jumps) < 0.01 * len(size) else float(np.median(size))
    )
    if usual > 0.2 * size[jumps].min():
        return None
    inner = jumps[(jumps > 0) & (jumps < len(size) - 1)]
    if not len(inner):
        return None
    # The motion continues during a jump: the jump and the expected step add up to a period.
    coming = 0.5 * (steps[inner - 1] + steps[inner + 1])
    coming[np.abs(coming) > 0.2 * span] = 0.0
    period = float(np.median(np.abs(steps[inner] - coming)))
    exact = [360.0, 2 * np.pi, 1.0, *(2.0**k for k in range(8, 33))]
    best = min(exact, key=lambda each: abs(each / period - 1))
    if abs(best / period - 1) < _SEEN:
        return best
    # Another period is accepted only if the motion continues during each jump.
    noise = float(np.median(np.abs(np.diff(steps))))
    on = -np.sign(steps[inner]) * coming > 3 * noise
    return float(f"{period:.3g}") if len(inner) > 1 and on.all() else None
