"""Judges the logs of a joint: what has changed, when, by how much, and which limits are passed."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from enum import Enum

import numpy as np
from scipy.special import stdtr

from sigmahat.health.change import (
    Change,
    Kind,
    Series,
    contrast,
    half_width,
    largest_change,
    segments,
)
from sigmahat.health.logs import JointLogs, Reason
from sigmahat.health.quantities import Agreed, Name, NoStiffness, Quantities, Quantity, quantities
from sigmahat.health.threshold import START, limit
from sigmahat.result.curve import NORMAL_95

FEWEST = 6  # logs below which nothing is judged
_POSSIBLE = 3.5
"""Limit of |z| from which a change is possible. It is the largest of many days and quantities: of
joints without a change, about 5 % show as much (38 of 800 with 30 or 60 logs of normal errors)."""
_COUNTING = 0.5  # least share of the logs that has to count for the stiffness
_KNOWN = 0.1
"""Largest half of the 95 % interval of the change of a stiffness that is called unchanged [1]: a
change of as much would matter to most users."""
SILENT = 3  # last logs in a row that do not count for the stiffness, from which this is told
_ENDS = 3  # without a change, the first and the last of so many parts of the logs are compared


class State(Enum):
    """What has become of a joint."""

    UNCHANGED = "unchanged"
    CHANGED = "changed"
    POSSIBLE = "perhaps changed"
    """It may have changed, but chance shows as much more often than the rate of false alarms."""
    RESTORED = "as before"  # it had changed, and no longer differs from the first logs
    UNCLEAR = "cannot be judged"
    """No change was found, but the logs would not show one: too few of them count, or the change
    from the first to the last logs is not known well enough."""
    UNKNOWN = "unknown"  # too few logs


@dataclass(frozen=True)
class Dated:
    """A change with the time between the log before and the one after."""

    change: Change
    before: datetime
    after: datetime


@dataclass(frozen=True)
class Difference:
    """The value of the last logs less that of the first, in the unit of the series."""

    first: float  # value of the first logs
    size: float
    std: float
    freedom: float

    def half_width(self) -> float:
        """Returns half of the 95 % interval."""
        return half_width(self.std, self.freedom)

    def probability_below(self, value: float) -> float:
        """Returns the probability that the difference is below a value."""
        return float(stdtr(self.freedom, (value - self.size) / max(self.std, 1e-300)))


@dataclass(frozen=True)
class Passed:
    """A limit of the user for the change of a quantity."""

    limit: float  # as given to judge()
    probability: float  # that it is passed

    @property
    def is_likely(self) -> bool:
        return self.probability > 0.5


@dataclass(frozen=True)
class Judged:
    """One quantity of a joint."""

    quantity: Quantity
    state: State
    changes: Sequence[Dated]
    """Those that were found; of State.POSSIBLE, the most likely one, or none if only the first and
    the last logs differ."""
    now: tuple[float, float]
    """Value after the last of the changes, and half of its 95 % interval, in its unit."""
    difference: Difference | None  # None with too few logs
    passed: Passed | None = None


class Unjudged(Enum):
    """Why a limit of the user cannot be judged."""

    NOT_SHOWN = "no log shows the quantity"
    FEW = "too few logs show the quantity"


@dataclass(frozen=True)
class UnjudgedLimit:
    """A limit of the user that says nothing about this joint."""

    name: Name
    limit: float  # as given to judge()
    reason: Unjudged
    logs: int  # that show the quantity


@dataclass(frozen=True)
class Verdict:
    """One joint."""

    logs: JointLogs
    gain_cancels: bool
    agreed: Agreed | None
    limit: float  # of |z|, for the rate of false alarms
    every: Sequence[Judged]
    without_stiffness: Mapping[int, NoStiffness]
    """Indices of the logs that do not count for the stiffness, nor for what is compared with it."""
    unjudged: Sequence[UnjudgedLimit]

    silent: int
    """How many of the last logs, in a row, do not count for the stiffness."""

    @property
    def state(self) -> State:
        """The state of the quantity that says most. Without a stiffness, that others are unchanged
        does not make the joint so."""
        states = [each.state for each in self.every]
        if not self.is_new and self.stiffness is None:
            states.append(State.UNCLEAR)
        for state in _BY_WEIGHT:
            if state in states:
                return state
        return State.UNKNOWN

    @property
    def stiffness(self) -> Judged | None:
        """The stiffness; None if no log shows it."""
        return next((each for each in self.every if each.quantity.name is Name.STIFFNESS), None)

    @property
    def is_new(self) -> bool:
        """Whether the joint has too few logs to expect an answer."""
        return len(self.logs.used) < FEWEST

    @property
    def is_unclear(self) -> bool:
        """Whether the stiffness cannot be judged."""
        return self.stiffness is None or self.stiffness.state is State.UNCLEAR

    @property
    def is_watched(self) -> bool:
        """Whether a change of the stiffness would be seen: of a joint that is new, later."""
        return self.silent < SILENT and (self.is_new or not self.is_unclear)

    @property
    def is_alarm(self) -> bool:
        """Whether someone should look at the joint: a change, or a limit that is likely passed."""
        passed = [each.passed for each in self.every if each.passed is not None]
        return self.state is State.CHANGED or any(each.is_likely for each in passed)


_BY_WEIGHT = (
    State.CHANGED,
    State.POSSIBLE,
    State.RESTORED,
    State.UNCLEAR,
    State.UNCHANGED,
)


def judge(
    logs: JointLogs, rate: float = START, limits: Mapping[Name, float] | None = None
) -> Verdict:
    """Judges the logs of one joint.

    rate    false alarms in a year of daily logs of a joint
    limits  of quantities, for the change since the first logs: relative, or in the unit of a
            quantity that is not relative; below 0 for a decrease
    """
    found: Quantities = quantities(logs)
    z = limit(rate, len(found.every))
    limits = limits or {}
    every = [_judged(each, logs, z, limits) for each in found.every]
    unjudged = list(_unjudged(every, limits))
    without = found.without_stiffness
    silent = _silent(logs, without)
    return Verdict(logs, found.gain_cancels, found.agreed, z, every, without, unjudged, silent)


def _silent(logs: JointLogs, without_stiffness: Mapping[int, NoStiffness]) -> int:
    """Returns how many of the last logs, in a row, do not count for the stiffness."""
    dated = [(each.time, i not in without_stiffness) for i, each in enumerate(logs.used)]
    dated += [(each.result.time, False) for each in logs.left_out if each.reason is Reason.DOUBT]
    dated += [(each, False) for each in logs.failed]
    dated.sort(key=lambda each: each[0], reverse=True)
    return next((i for i, (_, counts) in enumerate(dated) if counts), len(dated))


def _unjudged(every: Sequence[Judged], limits: Mapping[Name, float]) -> Iterator[UnjudgedLimit]:
    shown = {each.quantity.name: each for each in every}
    for name, given in limits.items():
        if name not in shown:
            yield UnjudgedLimit(name, given, Unjudged.NOT_SHOWN, 0)
        elif shown[name].passed is None:
            yield UnjudgedLimit(name, given, Unjudged.FEW, len(shown[name].quantity.logs))


def _judged(quantity: Quantity, logs: JointLogs, z: float, limits: Mapping[Name, float]) -> Judged:
    series = quantity.series
    if len(series.values) < FEWEST:
        is_unclear = quantity.name is Name.STIFFNESS and len(logs.used) >= FEWEST
        state = State.UNCLEAR if is_unclear else State.UNKNOWN
        return Judged(quantity, state, (), _level(quantity, 0), None)
    changes = segments(series, z)
    is_found = bool(changes)
    if not is_found:
        changes = _possible(largest_change(series))
    times = [logs.used[i].time for i in quantity.logs]
    dated = [Dated(each, times[each.at - 1], times[each.at]) for each in changes]
    difference = _difference(series, changes)
    state = State.POSSIBLE if changes else State.UNCHANGED
    if is_found:
        is_over = abs(difference.size) <= z * difference.std
        state = State.RESTORED if is_over and len(changes) > 1 else State.CHANGED
    passed = None
    if quantity.name in limits:
        given = limits[quantity.name]
        passed = Passed(given, probability_of(quantity, difference, given))
        if state is State.UNCHANGED and passed.is_likely:
            state = State.POSSIBLE
    if state is State.UNCHANGED and quantity.name is Name.STIFFNESS:
        is_few = len(quantity.logs) < _COUNTING * len(logs.used)
        if is_few or change_of_value(quantity, difference)[1] > _KNOWN:
            state = State.UNCLEAR
    return Judged(quantity, state, dated, _now(quantity, state, changes), difference, passed)


def _possible(largest: Change | None) -> Sequence[Change]:
    """Returns the most likely change, if an ordinary test of this one would find it."""
    if largest is None or abs(largest.z) <= _POSSIBLE or abs(largest.size) <= largest.half_width():
        return []
    return [largest]


def _difference(series: Series, changes: Sequence[Change]) -> Difference:
    """Compares the last logs with the first: a single change, else parts without a change."""
    count = len(series.values)
    first = changes[0].at if changes else count - _last_part(count)
    before, _ = weighted_mean(series.part(0, first))
    if len(changes) == 1:
        only = changes[0]
        return Difference(before, only.size, only.std, only.freedom)
    last = changes[-1].at if changes else _last_part(count)
    size, std = contrast(series, first, last)
    std = float(np.hypot(std, series.common))
    return Difference(before, size, std, max(first + count - last - 2, 1))


def _last_part(count: int) -> int:
    """Returns the index of the first of the last logs, for a comparison without a change."""
    return count - max(count // _ENDS, 1)


def weighted_mean(series: Series) -> tuple[float, float]:
    """Returns the weighted mean and its standard deviation."""
    weights = 1 / series.stds**2
    whole = float(np.sum(weights))
    return float(weights @ series.values) / whole, float(1 / np.sqrt(whole))


def _now(quantity: Quantity, state: State, changes: Sequence[Change]) -> tuple[float, float]:
    """Returns the value after the changes, at the end of a trend, and half of its interval."""
    count = len(quantity.logs)
    if not changes:
        return _level(quantity, _last_part(count) if state is State.POSSIBLE else 0)
    last = changes[-1]
    if last.kind is Kind.STEP:
        return _level(quantity, last.at)
    begin = changes[-2].at if len(changes) > 1 else 0
    before, std = weighted_mean(quantity.series.part(begin, last.at))
    return _in_unit(quantity, before + last.size, float(np.hypot(std, last.std)))


def _level(quantity: Quantity, first: int) -> tuple[float, float]:
    """Returns the mean of the logs from one on, and half of its 95 % interval, in the unit."""
    return _in_unit(quantity, *weighted_mean(quantity.series.part(first, len(quantity.logs))))


def _in_unit(quantity: Quantity, mean: float, std: float) -> tuple[float, float]:
    std = float(np.hypot(std, quantity.gain))
    if quantity.is_logarithm:
        value = quantity.level * float(np.exp(mean))
        return value, NORMAL_95 * std * value
    return quantity.level * mean, NORMAL_95 * std * quantity.level


def probability_of(quantity: Quantity, difference: Difference, given: float) -> float:
    """Returns the probability that a limit, as for judge(), is passed."""
    of_series = given
    if quantity.is_logarithm:
        of_series = float(np.log1p(max(given, -0.999999)))
    elif quantity.is_relative:
        of_series = given * abs(difference.first)
    below = difference.probability_below(of_series)
    return below if given < 0 else 1 - below


def change_of_value(quantity: Quantity, difference: Difference) -> tuple[float, float]:
    """Returns the change of a quantity, relative to the first logs, and half of its 95 % interval;
    of a quantity that is not relative, in its unit."""
    size, half = difference.size, difference.half_width()
    if quantity.is_logarithm:
        return float(np.expm1(size)), half * float(np.exp(size))
    scale = max(abs(difference.first), 1e-300) if quantity.is_relative else 1.0
    return size / scale, half / scale
