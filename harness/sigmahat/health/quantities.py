"""The quantities of a joint over its logs, without the gain of the torque where a log shows it.

A gain of the torque that is wrong by g changes stiffness, friction and inertia by g: no log can
tell. But the inertia of a motor does not wear. So where the log determines it, the ratio of the
other quantities to the inertia is without the gain, and a change of the inertia is one of the gain.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from sigmahat.estimator.instances import QUANTITIES
from sigmahat.health.change import NEIGHBOURS, Series, running_median
from sigmahat.health.logs import JointLogs, LogResult
from sigmahat.health.own import OwnEstimates, own_estimates
from sigmahat.health.scatter import variance_between

Array = NDArray[np.float64]

_MOST = 0.8  # share of the logs that have to determine the inertia
_REACHED = 0.9  # share of the logs that reach the agreed deformations, or have the set-point
_NEAR = 0.01
"""A log reaches a deformation up to this distance, relative to the usual range of a log: the curve
goes on as it ends."""
_USEFUL = 0.25
"""Least width of the agreed deformations, relative to the usual range of a log: closer together,
the shape of the curve between them is not known."""
_OF_PLACE = 0.1
"""Relative change of a stiffness by its nonlinearity, from the middle of the usual range of the
deformation to its end: standard deviation [1]."""
_OF_SET_POINT = 1.0
"""Relative change of a stiffness, per change of the set-point by the largest one: standard
deviation [1]."""
_LIKE = 0.05  # relative difference of set-points that count as equal [1]
_OF_MOTION = 0.1
"""Relative change of a quantity that another motion or load can explain, per relative change of
velocity, acceleration or torque: standard deviation [1]. The torque is without the usual gain where
logs show it: else it would explain a change of the gain, of which it is no cause."""
_PARTS = ("sigma", "middle", *QUANTITIES)
"""Of each log: mean stiffness at both ends of the agreed deformations, as backlash and worn teeth
soften the middle; the stiffness there [N.m/rad]; and the quantities of the estimator."""
_OF_TEMPERATURE = 0.005  # the same per kelvin: magnets and copper change by less [1/K]
_LEAST = 5e-3
"""Least relative scatter of results [1]: a motion that is always the same hides that a joint
differs by so much from day to day, without being worn."""
_OF_SLOPES = 0.01
"""Least scatter of the ratio of two slopes of the curve [1]: a smaller difference means nothing."""
_OF_DEFORMATION = 0.01
"""Least scatter of the backlash, relative to half the range of the deformation: a smaller dead zone
is seen in one log, and not in another."""
_SHOWN = 0.5  # largest median of the relative standard deviation of a quantity that is judged
_DAY = 86400.0  # [s]


class Name(Enum):
    """Quantities that are judged; the value is the word for people."""

    STIFFNESS = "stiffness"
    MIDDLE = "stiffness of the middle over that further out"
    BACKLASH = "backlash"
    HYSTERESIS = "hysteresis"
    COULOMB = "Coulomb friction"
    VISCOUS = "viscous friction"
    LOAD = "friction by load"
    GAIN = "gain of the torque"


_WITH_GAIN = (Name.STIFFNESS, Name.HYSTERESIS, Name.COULOMB, Name.VISCOUS)
"""Quantities that are in proportion to the gain of the torque."""


@dataclass(frozen=True)
class Quantity:
    """One quantity over the logs of a joint."""

    name: Name
    unit: str
    level: float
    """Value that stands for 1 in the series; 1 for a series in the unit itself."""
    series: Series  # values over the level
    logs: Sequence[int]  # indices of the logs of the joint that have a value
    claimed: Array  # standard deviations that the logs claim, over the level [size: logs]
    is_logarithm: bool  # whether the series has logarithms of values over the level
    gain: float  # relative standard deviation of the value by the gain of the torque [1]

    @property
    def is_relative(self) -> bool:
        """Whether a change is told relative to the value."""
        return self.name not in (Name.MIDDLE, Name.BACKLASH)


@dataclass(frozen=True)
class Agreed:
    """Deformations [rad] and set-point [1] at which the stiffnesses of all logs are compared.

    None: too few logs have one in common. Then each log is compared at its own, at the point where
    it knows its stiffness best, and a change of the place may explain one of the stiffness.
    """

    phi: tuple[float, float, float] | None
    set_point: float | None


class NoStiffness(Enum):
    """Why a log does not count for the stiffness; the value is what the log lacks, for people."""

    INERTIA = "do not determine the inertia of the motor, to which the others are compared"
    SET_POINT = "do not have two deformations at the agreed set-point"
    DEFORMATION = "do not reach the agreed deformations"
    NEGATIVE = "have a stiffness that is not above 0"


@dataclass(frozen=True)
class Quantities:
    """What the logs of a joint show."""

    logs: JointLogs
    agreed: Agreed | None  # None without logs
    gain_cancels: bool  # whether the logs determine the inertia of the motor
    every: Sequence[Quantity]
    without_stiffness: Mapping[int, NoStiffness]  # by index of the log


def quantities(logs: JointLogs) -> Quantities:
    """Computes all quantities that the logs of a joint show."""
    if not logs.used:
        return Quantities(logs, None, False, (), {})
    own = own_estimates([each.together for each in logs.used])
    cancels = bool(np.mean(own.determines_inertia) >= _MOST)
    agreed = _agreed(own)
    table = _Table(logs.used, own, agreed, cancels)
    return Quantities(logs, agreed, cancels, list(table.quantities()), table.without_stiffness())


def _agreed(own: OwnEstimates) -> Agreed:
    """Chooses the set-point of most logs, and deformations that nine of ten logs reach there.

    Of set-points that equally many logs have, it is the one in the middle.
    """
    every = np.unique(own.set_point[~np.isnan(own.set_point)])
    counts = np.array([np.sum(np.any(_at(own, each), axis=1)) for each in every])
    likely = every[counts == counts.max()]
    set_point = float(likely[len(likely) // 2])
    low, high = _ends(own, _at(own, set_point))
    reached = np.isfinite(low) & (high > low)
    if np.mean(reached) < _REACHED:
        return Agreed(None, None)
    low, high = low[reached], high[reached]
    first, last = _common_range(low, high)
    if last - first < _USEFUL * float(np.median(high - low)):
        return Agreed(None, set_point)
    middle = 0.0 if first <= 0 <= last else (first + last) / 2
    return Agreed((first, middle, last), set_point)


def _common_range(low: Array, high: Array) -> tuple[float, float]:
    """Returns the widest range that nine of ten logs contain; the ends are in the wrong order if no
    range is.

    low, high  ends of the range of each log [size: logs]
    """
    fewest = int(np.ceil(_REACHED * len(low)))
    found = []
    for first in np.unique(np.sort(low)[fewest - 1 :]):
        ends = np.sort(high[low <= first])
        found.append((float(first), float(ends[-fewest])))
    return max(found, key=lambda each: each[1] - each[0])


def _at(own: OwnEstimates, set_point: float | Array) -> NDArray[np.bool_]:
    """Marks the points at a set-point, one for all or one for each log [size: logs x points]."""
    wanted = np.broadcast_to(np.asarray(set_point), len(own.phi))[:, None]
    largest = np.max(np.abs(np.nan_to_num(np.hstack([own.set_point, wanted]))), axis=1)
    found: NDArray[np.bool_] = np.abs(own.set_point - wanted) <= _LIKE * largest[:, None]
    return found


def _ends(own: OwnEstimates, at: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Returns the least and the largest deformation of the marked points; infinite without any."""
    low = np.min(own.phi, axis=1, where=at, initial=np.inf)
    return low, np.max(own.phi, axis=1, where=at, initial=-np.inf)


@dataclass(frozen=True)
class _Found:
    """The values of one quantity: of the logs that show it [size: logs that show it]."""

    logs: NDArray[np.intp]  # their indices
    values: Array
    variances: Array
    per_gain: Array  # relative change with a relative change of the gain of the torque [1]


class _Table:
    """The values of all quantities of a joint, log by log."""

    def __init__(
        self, results: Sequence[LogResult], own: OwnEstimates, agreed: Agreed, cancels: bool
    ) -> None:
        self._results, self._own, self._agreed, self._cancels = results, own, agreed, cancels
        self._days = np.array([each.time.timestamp() / _DAY for each in results])
        self._gain = float(np.median([each.torque_gain for each in results]))
        inertias = own.values[own.determines_inertia, own.index("B")]
        self._inertia = float(np.median(inertias[:NEIGHBOURS])) if len(inertias) else 1.0
        """Inertia that stands for the gain of the first logs, to which all are taken [kg.m2]."""
        self._effects = self._of_motion()
        self._shows_gain = own.determines_inertia | (not cancels)
        """Whether a log shows the gain, or no log needs to [size: logs]."""
        at = _at(own, self._set_points())
        low, high = _ends(own, at)
        has_range = np.isfinite(low)
        self._half = float(np.median((high - low)[has_range])) / 2 if np.any(has_range) else 0.0
        """Half of the usual range of the deformation [rad]."""
        self._lacks = self._why_not(at)
        if agreed.phi is None:
            best = _best_known(own, at)
            parts = [best, np.zeros_like(best)]
        else:
            weights = [_interpolation(own.phi, wanted, at) for wanted in agreed.phi]
            parts = [(weights[0] + weights[2]) / 2, weights[1]]
        self._places = self._of_place(parts[0])
        rest = np.zeros((len(results), len(parts), len(QUANTITIES)))
        w = np.concatenate([np.stack(parts, axis=1), rest], axis=2)
        units = np.eye(len(QUANTITIES), w.shape[2], own.phi.shape[1])
        w = np.concatenate([w, np.broadcast_to(units, (len(results), *units.shape))], axis=1)
        # Of each log, _PARTS with their covariance.
        self._values = (w @ own.values[:, :, None])[:, :, 0]
        self._per_gain = (w @ own.per_gain[:, :, None])[:, :, 0]
        self._covariance = w @ own.covariance @ np.swapaxes(w, 1, 2)

    def quantities(self) -> Iterator[Quantity]:
        yield from self._logarithm(Name.STIFFNESS, "N.m/rad", "sigma", True)
        yield from self._middle()
        yield from self._backlash()
        yield from self._linear(Name.HYSTERESIS, "N.m", "hysteresis", True)
        yield from self._linear(Name.COULOMB, "N.m", "tau_coulomb", True)
        yield from self._linear(Name.VISCOUS, "N.m.s/rad", "D_theta", True)
        yield from self._linear(Name.LOAD, "1", "load_friction", False)
        if self._cancels:
            yield from self._logarithm(Name.GAIN, "kg.m2", "B", False)

    def without_stiffness(self) -> Mapping[int, NoStiffness]:
        """Returns why logs, by index, do not count for the stiffness."""
        sigma = self._values[:, _PARTS.index("sigma")]
        reasons = [
            reason or (None if value > 0 else NoStiffness.NEGATIVE)
            for reason, value in zip(self._lacks, sigma.tolist(), strict=True)
        ]
        return {i: reason for i, reason in enumerate(reasons) if reason is not None}

    def _set_points(self) -> Array:
        """Returns the set-point at which each log is compared [1] [size: logs]."""
        count = len(self._results)
        if self._agreed.set_point is not None:
            return np.full(count, self._agreed.set_point)
        usual = float(np.nanmedian(self._own.set_point))
        far = np.abs(self._own.set_point - usual)
        nearest = np.argmin(np.where(np.isnan(far), np.inf, far), axis=1)
        found: Array = self._own.set_point[np.arange(count), nearest]
        return found

    def _of_place(self, weights: Array) -> Array:
        """Effects of the deformation and the set-point on a stiffness, where each log has its own,
        relative [size: logs x effects].

        weights  of the points of a log in its stiffness [size: logs x points]
        """
        columns = list[Array]()
        if self._agreed.phi is None and self._half > 0:
            place = np.sum(weights * np.nan_to_num(self._own.phi), axis=1)
            columns.append(_OF_PLACE * place / self._half)
        if self._agreed.set_point is None:
            place = np.sum(weights * np.nan_to_num(self._own.set_point), axis=1)
            largest = float(np.max(np.abs(place)))
            columns.append(_OF_SET_POINT * place / max(largest, 1e-300))
        return np.stack(columns, axis=1) if columns else np.zeros((len(weights), 0))

    def _why_not(self, at: NDArray[np.bool_]) -> Sequence[NoStiffness | None]:
        """Returns for each log why it does not show the agreed stiffness; None if it does."""
        low, high = _ends(self._own, at)
        is_narrow = np.zeros(len(low), np.bool_)
        if self._agreed.phi is not None:
            first, _, last = self._agreed.phi
            slack = 2 * _NEAR * self._half
            is_narrow = (first < low - slack) | (last > high + slack)
        found: list[NoStiffness | None] = []
        for shows_gain, points, narrow in zip(
            self._shows_gain, np.sum(at, axis=1), is_narrow, strict=True
        ):
            if not shows_gain:
                found.append(NoStiffness.INERTIA)
            elif points < 2:
                found.append(NoStiffness.SET_POINT)
            else:
                found.append(NoStiffness.DEFORMATION if narrow else None)
        return found

    def _with_stiffness(self) -> NDArray[np.bool_]:
        """Marks logs with a stiffness that is compared, which may be negative."""
        return np.array([each is None for each in self._lacks])

    def _part(self, name: str, logs: NDArray[np.intp]) -> Array:
        found: Array = self._values[logs, _PARTS.index(name)]
        return found

    def _covariances(self, one: str, other: str, logs: NDArray[np.intp]) -> Array:
        found: Array = self._covariance[logs, _PARTS.index(one), _PARTS.index(other)]
        return found

    def _of_ratio(self, one: str, other: str, logs: NDArray[np.intp]) -> Array:
        """Returns the variance of the logarithm of a ratio."""
        a, b = self._part(one, logs), self._part(other, logs)
        found: Array = (
            self._covariances(one, one, logs) / a**2
            + self._covariances(other, other, logs) / b**2
            - 2 * self._covariances(one, other, logs) / (a * b)
        )
        return np.maximum(found, 0.0)

    def _gain_of(self, name: str, logs: NDArray[np.intp]) -> Array:
        """Returns the relative change of a part with a relative change of the gain."""
        values = self._part(name, logs)
        changes = self._per_gain[logs, _PARTS.index(name)]
        found: Array = np.divide(changes, values, out=np.zeros_like(values), where=values != 0)
        return found

    def _logarithm(self, name: Name, unit: str, part: str, over_gain: bool) -> Iterator[Quantity]:
        """The logarithm of an estimate, over the inertia where it shows the gain."""
        over_gain = over_gain and self._cancels
        is_stiffness = part == "sigma"
        shown = self._with_stiffness() if is_stiffness else self._shows_gain
        logs = np.flatnonzero(shown & (self._values[:, _PARTS.index(part)] > 0))
        if not len(logs):
            return
        values, per_gain = np.log(self._part(part, logs)), self._gain_of(part, logs)
        if over_gain:
            values -= np.log(self._part("B", logs))
            per_gain -= self._gain_of("B", logs)
            variances = self._of_ratio(part, "B", logs)
        else:
            variances = self._covariances(part, part, logs) / self._part(part, logs) ** 2
        middle = float(np.median(values))
        level = float(np.exp(middle + (np.log(self._inertia) if over_gain else 0.0)))
        found = _Found(logs, values - middle, variances, per_gain)
        places = self._places if is_stiffness else None
        yield self._quantity(name, unit, level, found, self._common(found), 1.0, _LEAST, places)

    def _middle(self) -> Iterator[Quantity]:
        """The relative difference of two stiffnesses; no quantity if they are always equal, nor
        where each log has its own deformations: another part of a curve has another shape."""
        if self._agreed.phi is None:
            return
        both = [self._values[:, _PARTS.index(name)] > 0 for name in ("middle", "sigma")]
        logs = np.flatnonzero(self._with_stiffness() & both[0] & both[1])
        values = np.log(self._part("middle", logs) / self._part("sigma", logs))
        if np.any(np.abs(values) > _OF_SLOPES):
            found = _Found(
                logs, values, self._of_ratio("middle", "sigma", logs), np.zeros_like(values)
            )
            yield self._quantity(Name.MIDDLE, "1", 1.0, found, 0.0, 1.0, _OF_SLOPES)

    def _backlash(self) -> Iterator[Quantity]:
        """The half width of the dead zone: the torque that it takes, over the stiffness."""
        is_positive = self._values[:, _PARTS.index("sigma")] > 0
        logs = np.flatnonzero(self._with_stiffness() & is_positive)
        lost = self._part("lost_torque", logs)
        if not np.any(lost):
            return
        values = lost / self._part("sigma", logs)
        seen = lost != 0
        variances = np.zeros(len(logs))
        variances[seen] = values[seen] ** 2 * self._of_ratio("lost_torque", "sigma", logs[seen])
        agreed = self._agreed.phi
        half = self._half if agreed is None else (agreed[2] - agreed[0]) / 2
        least = _OF_DEFORMATION * half
        found = _Found(logs, values, variances, np.zeros_like(values))
        yield self._quantity(Name.BACKLASH, "rad", 1.0, found, 0.0, least, least)

    def _linear(self, name: Name, unit: str, part: str, over_gain: bool) -> Iterator[Quantity]:
        """An estimate itself, without the gain where the inertia shows it."""
        at = _PARTS.index(part)
        logs = np.flatnonzero(self._shows_gain & (self._covariance[:, at, at] > 0))
        if not len(logs):
            return
        values, variances = self._part(part, logs), self._covariances(part, part, logs)
        per_gain = self._gain_of(part, logs)
        if over_gain and self._cancels:
            B = self._part("B", logs)
            of_B = values / B
            variances = (
                variances
                + of_B**2 * self._covariances("B", "B", logs)
                - 2 * of_B * self._covariances(part, "B", logs)
            ) * (self._inertia / B) ** 2
            values = of_B * self._inertia
        level = float(np.median(np.abs(values)))
        stds = np.sqrt(np.maximum(variances, 0.0))
        if not level > 0 or np.median(stds) > _SHOWN * level:
            return
        found = _Found(logs, values / level, (stds / level) ** 2, per_gain)
        common = self._common(found) if over_gain else 0.0
        yield self._quantity(name, unit, level, found, common, 1.0, _LEAST)

    def _common(self, found: _Found) -> float:
        """Standard deviation of the difference of two values by two gains [1]; 0 if they cancel.

        Where the inertia is not that of the log, a stiffness may change by more than the gain.
        """
        if self._cancels:
            return 0.0
        return float(np.sqrt(2) * self._gain * np.median(np.abs(found.per_gain)))

    def _quantity(
        self,
        name: Name,
        unit: str,
        level: float,
        found: _Found,
        common: float,
        effect: float,
        least: float,
        more: Array | None = None,
    ) -> Quantity:
        """effect  what stands for a relative change of 1 in the series; least  least scatter; more
        effects besides those of motion and temperature"""
        effects = self._effects
        values = found.values
        if more is not None:
            effects = np.hstack([effects, more])
            # What is left for these effects to explain is unknown: they stay in the regression.
            values = values - _explained(values, more[found.logs])
        between = max(variance_between(values, found.variances), least**2)
        stds = np.sqrt(found.variances + between)
        # No log counts more than the usual one: else the few that claim most would decide.
        stds = np.maximum(stds, np.median(stds))
        series = Series(
            self._days[found.logs],
            values,
            stds,
            effect * effects[found.logs],
            common,
            least,
        )
        is_logarithm = name in (Name.STIFFNESS, Name.GAIN)
        gain = self._gain if name in _WITH_GAIN else 0.0
        claimed = np.sqrt(found.variances)
        return Quantity(name, unit, level, series, found.logs.tolist(), claimed, is_logarithm, gain)

    def _gains(self) -> Array:
        """Usual gain of the torque of each log and its neighbours, over that of the first logs; 1
        where logs do not show it [size: logs].

        It is not the one of the log alone, whose error would be in the effect as in the inertia.
        """
        gains = np.ones(len(self._results))
        shown = self._own.determines_inertia
        if self._cancels:
            B = self._own.values[shown, self._own.index("B")]
            gains[shown] = running_median(B, NEIGHBOURS) / self._inertia
        return gains

    def _of_motion(self) -> Array:
        """Effects of motion and temperature on a quantity, relative [size: logs x effects]."""
        moved = [each.excitation for each in self._results]
        torques = np.array([each.torque for each in moved]) / self._gains()
        rows = np.array([(each.velocity, each.acceleration) for each in moved])
        logarithms = np.log(np.maximum(np.column_stack([rows, torques]), 1e-300))
        columns = [_OF_MOTION * (logarithms - np.median(logarithms, axis=0))]
        temperatures = [each.temperature for each in self._results]
        if all(each is not None for each in temperatures):
            measured = np.array(temperatures, np.float64)[:, None]
            columns.append(_OF_TEMPERATURE * (measured - np.median(measured)))
        return np.hstack(columns)


def _explained(values: Array, effects: Array) -> Array:
    """Returns what effects explain of the differences of successive values, which hardly contain a
    change; the coefficients have the prior N(0, 1) [size: logs]."""
    if len(values) < 2:
        return np.zeros_like(values)
    y, x = np.diff(values), np.diff(effects, axis=0)
    noise = max(float(np.median(y**2)), 1e-12)
    found = effects @ np.linalg.solve(x.T @ x + noise * np.eye(x.shape[1]), x.T @ y)
    centred: Array = found - np.median(found)
    return centred


def _best_known(own: OwnEstimates, at: NDArray[np.bool_]) -> Array:
    """Returns a weight of 1 for the marked point of each log with the smallest relative standard
    deviation of the stiffness; of 0 for logs without a positive one [size: logs x points]."""
    count = own.phi.shape[1]
    sigma, variances = own.values[:, :count], np.diagonal(own.covariance, 0, 1, 2)[:, :count]
    is_possible = at & (sigma > 0)
    relative = np.divide(variances, sigma**2, out=np.full(sigma.shape, np.inf), where=is_possible)
    weights = np.zeros(own.phi.shape)
    weights[np.arange(len(weights)), np.argmin(relative, axis=1)] = 1.0
    return np.where(is_possible, weights, 0.0)


def _interpolation(phi: Array, wanted: float, at: NDArray[np.bool_]) -> Array:
    """Returns weights of the marked points by which they are interpolated linearly; beyond them,
    the last one counts.

    phi     deformations [rad] [size: logs x points]
    wanted  deformation of the result [rad]
    at      marks of points [size: logs x points]
    """
    weights, rows = np.zeros(phi.shape), np.arange(len(phi))
    below = np.where(at & (phi <= wanted), phi, -np.inf)
    above = np.where(at & (phi > wanted), phi, np.inf)
    left, right = np.argmax(below, axis=1), np.argmin(above, axis=1)
    low, high = below[rows, left], above[rows, right]
    inside = np.isfinite(low) & np.isfinite(high)
    share = np.where(np.isfinite(low), 0.0, 1.0)
    share[inside] = (wanted - low[inside]) / (high[inside] - low[inside])
    weights[rows, left] += 1 - share
    weights[rows, right] += share
    return weights
