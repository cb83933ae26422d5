"""Finds the most likely change in a series of results: a step, or a trend that begins at a time.

Every change point is tried, as in a generalised likelihood ratio. A change is compared with the
scatter around the model that contains the change, with the quantiles of Student's t: so its weight
does not depend on what the logs claim about themselves (Knapp and Hartung, Statistics in Medicine
22, 2003, p. 2693).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri, stdtr, stdtrit

Array = NDArray[np.float64]

FEWEST_AFTER = 2
"""Least number of logs on either side of a change: one log alone may be a bad one."""
SHORTEST_TREND = 10  # least number of logs in a trend: fewer are a step
_LIMIT = 3.5  # std deviations from the middle at which a value counts no more [1]
NEIGHBOURS = 9  # least number of logs next to each other with which a log has to agree
_SHARE = 2
"""One in so many logs of a series are these neighbours: in a long series, bad logs come together
somewhere by chance. With nine of 365 logs, 3 of 480 simulated joint-years had a false alarm; with
half of them, 2 of 2000."""
_LEAST_FREEDOM = 3  # degrees of freedom from which a change can be judged
_ENDS = 64  # largest number of logs at which an episode may begin or end
_RARER = 10.0
"""Episodes get a tenth of the false alarms of other changes. There are up to _ENDS times as many as
steps, so one with z counts as a step with z^2 - 2 ln(_RARER _ENDS) squared, which is as rare."""
_TOLD_APART = 1e-9  # least share of a change that effects do not explain
_REFITS = 5
_RAREST = 1e-300  # probability below which there is no normal quantile


def half_width(std: float, freedom: float) -> float:
    """Returns half of the 95 % interval of a value with this standard deviation."""
    return float(stdtrit(freedom, 0.975)) * std


class Kind(Enum):
    STEP = "step"
    TREND = "trend"


_LEAST_AFTER = {Kind.STEP: FEWEST_AFTER, Kind.TREND: SHORTEST_TREND}


@dataclass(frozen=True)
class Change:
    """A possible change in a series."""

    kind: Kind
    at: int  # index of the first log after the change
    z: float
    """Quantile of a standard normal distribution that is as rare as the change by chance [1]."""
    size: float  # change of the value until the last log
    std: float  # of the size, from the scatter around the model with the change, and `common`
    freedom: float  # degrees of freedom of this standard deviation

    def half_width(self) -> float:
        """Returns half of the 95 % interval of the size."""
        return half_width(self.std, self.freedom)


@dataclass(frozen=True)
class Episode:
    """Logs with another value, between logs that agree with each other."""

    first: int  # index of its first log
    end: int  # index of the first log after it
    z: float  # as of a Change, for a step that is as rare [1]


@dataclass(frozen=True)
class Series:
    """Results of the logs of a joint for one quantity, in the order of time."""

    times: Array  # [d] [size: logs]
    values: Array  # in the unit of the quantity [size: logs]
    stds: Array  # standard deviations with the scatter between logs, > 0 [size: logs]
    effects: Array
    """What else may move the values, such as another motion: by one standard deviation of what can
    be expected of it, in the unit of the quantity [size: logs x effects]."""
    common: float = 0.0
    """Standard deviation of a change that nobody can tell from one of the quantity: another gain of
    the torque."""
    least: float = 0.0
    """Least scatter of the values: results that agree better do so by chance, or by rounding."""

    @cached_property
    def regression(self) -> "_Regression":
        """The regression in which changes are looked for."""
        return _Regression(self)

    def part(self, first: int, last: int) -> "Series":
        """Returns the logs from index `first` up to, but without, `last`."""
        return self.taken(slice(first, last))

    def taken(self, chosen: "slice | NDArray[np.intp]") -> "Series":
        """Returns chosen logs, in the order of time."""
        return replace(
            self,
            times=self.times[chosen],
            values=self.values[chosen],
            stds=self.stds[chosen],
            effects=self.effects[chosen],
        )


def as_normal(value: Array, freedom: float) -> Array:
    """Returns the quantile of a normal distribution that is as rare as one of Student's t, up to
    about 37."""
    rare = np.maximum(stdtr(freedom, -np.abs(value)), _RAREST)
    found: Array = -np.sign(value) * ndtri(rare)
    return found


def running_median(values: Array, count: int) -> Array:
    """Returns the median of each value and its neighbours [size: logs].

    count  of neighbours, >= 1, with the value, which is the middle one; at both ends, the first or
           the last of them. All values are neighbours if there are no more.
    """
    count = min(count, len(values))
    medians = np.median(np.lib.stride_tricks.sliding_window_view(values, count), axis=1)
    found: Array = medians[np.clip(np.arange(len(values)) - count // 2, 0, len(values) - count)]
    return found


def largest_change(series: Series) -> Change | None:
    """Returns the change with the largest |z|; None for logs too few or too alike to judge."""
    if len(series.values) <= _LEAST_FREEDOM:
        return None
    changes = series.regression
    if changes.freedom < _LEAST_FREEDOM:
        return None
    best: tuple[float, Kind, int] | None = None
    for kind in Kind:
        points = np.arange(FEWEST_AFTER, len(series.values) - _LEAST_AFTER[kind] + 1)
        if not len(points):
            continue
        found = np.abs(changes.t(kind, points))
        if best is None or np.max(found) > best[0]:
            best = float(np.max(found)), kind, int(points[np.argmax(found)])
    if best is None or best[0] == 0:
        return None
    _, kind, at = best
    return changes.fitted(kind, at)


def largest_episode(series: Series) -> Episode | None:
    """Returns the episode with the largest |z|, in a long series only to within some logs; None for
    logs too few or too alike to judge."""
    count = len(series.values)
    last = count - FEWEST_AFTER
    if count < 3 * FEWEST_AFTER or (changes := series.regression).freedom < _LEAST_FREEDOM:
        return None
    ends = np.unique(
        np.linspace(FEWEST_AFTER, last, min(_ENDS, last - FEWEST_AFTER + 1)).astype(int)
    )
    t = np.abs(changes.t_of_episodes(ends))
    first, end = np.unravel_index(int(np.argmax(t)), t.shape)
    z = float(as_normal(t[first, end], changes.freedom))
    rarer = float(np.sqrt(max(z**2 - 2 * np.log(_RARER * _ENDS), 0.0)))
    if rarer == 0:
        return None
    begin = series.part(0, int(ends[end])).regression.fitted(Kind.STEP, int(ends[first]))
    return Episode(int(ends[first]), int(ends[end]), _with_common(rarer, begin.size, series.common))


def _sums(kind: Kind, times: Array, points: NDArray[np.intp], columns: Array) -> Array:
    """Returns the products of columns and the regressor of each change point, by cumulative sums.

    The regressor is 0 before the change, and 1 at the last log.

    times   in increasing order, 0 at the last log [size: logs]
    points  indices of the first log after each change, >= 1
    columns [size: logs x columns]

    Returns [size: points x columns].
    """
    later: Array = np.cumsum(columns[::-1], axis=0)[::-1][points]
    if kind is Kind.STEP:
        return later
    of_times: Array = np.cumsum((times[:, None] * columns)[::-1], axis=0)[::-1][points]
    begins = times[points - 1][:, None]
    return (of_times - begins * later) / _lengths(begins)


def _lengths(begins: Array) -> Array:
    """Returns the durations of trends until the last log, at time 0."""
    found: Array = np.maximum(-begins, 1e-9)
    return found


class _Regression:
    """Weighted regression on a constant, the effects, and one change.

    The coefficients of the effects have the prior N(0, 1), as further rows: an effect that hardly
    varies explains hardly anything, and one that changes much explains as much as is expected. It
    takes as many degrees of freedom as it explains of noise: the trace of the projection.
    """

    def __init__(self, series: Series) -> None:
        self._series = series
        self._logs, count = series.effects.shape
        self._weights = 1 / series.stds
        self._times = series.times - series.times[-1]
        centred = series.effects - np.mean(series.effects, axis=0)
        of_logs = np.column_stack([np.ones(self._logs), centred]) * self._weights[:, None]
        self._q, _ = np.linalg.qr(np.vstack([of_logs, np.eye(count, count + 1, 1)]))
        self._y = self._rest(self._limited() * self._weights)
        self._least = series.least**2 * float(np.mean(self._weights**2))
        self.freedom = self._logs - 1 - float(np.sum(self._q[: self._logs] ** 2))

    def t(self, kind: Kind, points: NDArray[np.intp]) -> Array:
        """Returns Student's t of a change at each point [size: points]."""
        return self._t(_sums(kind, self._times, points, self._columns()), self._own(kind, points))

    def t_of_episodes(self, ends: NDArray[np.intp]) -> Array:
        """Returns Student's t of an episode between each two logs, 0 for those with too few of them
        [size: ends x ends]."""
        sums = _sums(Kind.STEP, self._times, ends, self._columns())
        own = self._own(Kind.STEP, ends)
        between = self._t(sums[:, None] - sums[None], own[:, None] - own[None])
        return np.where(ends[None] - ends[:, None] >= FEWEST_AFTER, between, 0.0)

    def _columns(self) -> Array:
        """Returns the columns whose products with a regressor say all about it [size: logs x
        columns]: the values, and constant and effects."""
        weights, y = self._weights[:, None], self._y[: self._logs, None]
        return np.hstack([weights * y, weights * self._q[: self._logs]])

    def _t(self, sums: Array, own: Array) -> Array:
        """Returns Student's t of regressors [size: regressors].

        sums  products of the regressors and _columns() [size: regressors x columns]
        own   sums of squares of the weighted regressors [size: regressors]
        """
        products, explained = sums[..., 0], sums[..., 1:]
        squares = own - np.sum(explained**2, axis=-1)
        is_told_apart = squares > _TOLD_APART * own
        squares = np.where(is_told_apart, squares, 1.0)
        all_errors = float(self._y @ self._y)
        errors = np.maximum(all_errors - products**2 / squares, 1e-12 * all_errors + 1e-300)
        found = products / np.sqrt(squares * np.maximum(errors / self.freedom, self._least))
        return np.where(is_told_apart, found, 0.0)

    def _own(self, kind: Kind, points: NDArray[np.intp]) -> Array:
        """Returns the sum of squares of each weighted regressor [size: points]."""
        squares = self._weights[:, None] ** 2
        if kind is Kind.STEP:
            return _sums(kind, self._times, points, squares)[:, 0]
        begins = self._times[points - 1]
        both = _sums(
            kind, self._times, points, np.hstack([squares, self._times[:, None] * squares])
        )
        found: Array = (both[:, 1] - begins * both[:, 0]) / _lengths(begins)
        return found

    def _limited(self) -> Array:
        """Returns the values, less their median, of which bad logs are cut.

        A value counts up to 3.5 standard deviations below and above the range from the median of
        the series to that of its neighbours in time: half of the logs, nine or more, of which
        it is the middle one; at both ends, the first or the last of them. So bad logs are cut, also
        together and at the end, as long as they are fewer than half of the neighbours. A change of
        more logs is not, however large it is. With fewer than nine logs, all are neighbours.
        """
        values = self._series.values - np.median(self._series.values)
        around = running_median(values, max(NEIGHBOURS, self._logs // _SHARE))
        most = _LIMIT / self._weights
        found: Array = np.clip(values, np.minimum(around, 0) - most, np.maximum(around, 0) + most)
        return found

    def fitted(self, kind: Kind, at: int) -> Change:
        """Returns size and standard deviation of one change, in which bad logs count less."""
        z = float(as_normal(self.t(kind, np.array([at])), self.freedom)[0])
        own = self._rest(self._regressor(kind, at) * self._weights)
        squares = float(own @ own)
        values = self._series.values * self._weights
        limited = values
        for _ in range(_REFITS):  # Huber's method of modified residuals
            y = self._rest(limited)
            size = float(own @ y) / squares
            rest = y - size * own
            errors = rest[: self._logs] + values - limited
            middle = np.median(errors)
            limited = values - errors + middle + np.clip(errors - middle, -_LIMIT, _LIMIT)
        std = float(np.sqrt(max(rest @ rest / self.freedom, self._least) / squares))
        common = self._series.common
        z = _with_common(z, size, common)
        return Change(kind, at, z, size, float(np.hypot(std, common)), self.freedom)

    def step(self, at: int) -> tuple[float, float]:
        """Returns the size of a step, and its standard deviation by those of logs and effects; bad
        logs count as the others."""
        own = self._rest(self._regressor(Kind.STEP, at) * self._weights)
        squares = float(own @ own)
        y = self._rest(self._series.values * self._weights)
        return float(own @ y) / squares, 1 / float(np.sqrt(squares))

    def _regressor(self, kind: Kind, at: int) -> Array:
        """Returns what is 0 before a change, and 1 at the last log [size: logs]."""
        if kind is Kind.STEP:
            return (np.arange(self._logs) >= at).astype(np.float64)
        begin = self._times[at - 1]
        found: Array = np.maximum(self._times - begin, 0.0) / _lengths(begin)
        return found

    def _rest(self, column: Array) -> Array:
        """Returns what constant and effects leave of a weighted column, with the rows of the prior.

        column  [size: logs]
        """
        rows = np.concatenate([column, np.zeros(len(self._q) - self._logs)])
        rest: Array = rows - self._q @ (self._q.T @ rows)
        return rest


def _with_common(z: float, size: float, common: float) -> float:
    """Returns z of a change of this size that may also be one of Series.common."""
    if common == 0:
        return z
    return float(np.sign(z) / np.hypot(1 / max(abs(z), 1e-9), common / max(abs(size), 1e-300)))


def contrast(series: Series, first: int, last: int) -> tuple[float, float]:
    """Returns the value of the logs from `last` on less that of the logs before `first`, without
    what the effects explain, and its standard deviation by that of the logs and of the effects.

    first  1 to last
    last   below the number of logs
    """
    chosen = np.r_[0:first, last : len(series.values)]
    return series.taken(chosen).regression.step(first)


def segments(series: Series, limit: float) -> Sequence[Change]:
    """Returns all changes above a limit of |z|, in the order of time (binary segmentation).

    The largest change divides the series, and each part is looked at again. At the end, each change
    is looked for again between its neighbours: a division was made in ignorance of the others.
    """
    found = _divided(series, limit, 0)
    ends = [0, *(each.at for each in found), len(series.values)]
    for i in range(len(found) if len(found) > 1 else 0):
        again = largest_change(series.part(ends[i], ends[i + 2]))
        if again is not None and abs(again.z) > limit:
            found[i] = replace(again, at=ends[i] + again.at)
            ends[i + 1] = found[i].at
    return found


def _divided(series: Series, limit: float, first: int) -> list[Change]:
    """first  index of the first log of this part"""
    found = largest_change(series)
    if found is None or abs(found.z) <= limit:
        return _both_ends(series, limit, first)
    here = replace(found, at=first + found.at)
    before = _divided(series.part(0, found.at), limit, first)
    if found.kind is Kind.TREND:  # what follows is part of it
        return [*before, here]
    after = _divided(series.part(found.at, len(series.values)), limit, first + found.at)
    return [*before, here, *after]


def _both_ends(series: Series, limit: float, first: int) -> list[Change]:
    """Returns the two steps of an episode, of which none need be seen by itself: what was repaired
    is as before, so that no division of the logs in two shows much."""
    episode = largest_episode(series)
    if episode is None or episode.z <= limit:
        return []
    begin = series.part(0, episode.end).regression.fitted(Kind.STEP, episode.first)
    rest = series.part(episode.first, len(series.values)).regression
    end = rest.fitted(Kind.STEP, episode.end - episode.first)
    return [replace(begin, at=first + episode.first), replace(end, at=first + episode.end)]
