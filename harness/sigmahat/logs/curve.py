"""Computes the curve from an estimator: the ranges of the data, then torque and stiffness there."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sigmahat.fmi.instance import Slave, Value
from sigmahat.fmi.sample_loop import Recorder, SampleLoop, step_times
from sigmahat.fmi.saved_state import restore, save
from sigmahat.joint import sheet
from sigmahat.joint.curve import Branch, Curve, characteristic, nearest
from sigmahat.joint.sheet import Polynomial
from sigmahat.joint.start_values import start_values
from sigmahat.joint.stored import LearnedLog, Range
from sigmahat.logs.configuration import PORTS
from sigmahat.logs.log import Array
from sigmahat.logs.measured import MeasuredPoints

_OUTPUTS = ("tau_e", "tau_e_std", "sigma", "sigma_std", "sigma_per_gain", "phi", "setPoint")


def stiffness_at(
    slave: Slave, names: Sequence[str], points: Array, t_0: float, T: float
) -> dict[str, Array]:
    """The outputs _OUTPUTS at each point, by name, [size: points].

    Before each point a sample is missing. After such a gap FilteredRegression learns nothing until
    its filters have settled, and they never do: its answers are those of what it has learned
    before. The slave cannot be used for anything else afterwards.

    slave   of the method FilteredRegression, that has reached the time t_0 [s]
    names   of inputs, theta and q among them
    points  values of these inputs, finite [size: points x names]
    T       samplePeriod [s]
    """
    fmu = slave.fmu
    t = t_0 + T * np.arange(2 * len(points), dtype=np.float64).reshape(-1, 2)
    gap, sample = (step_times(each, T) for each in t.T)
    recorder = Recorder(slave, _OUTPUTS, len(points))
    loop = SampleLoop()
    loop.set_real(slave, fmu.references(PORTS, "input"), np.zeros(len(PORTS)))
    loop.set_real(slave, fmu.references(names[:1], "input"), np.full(1, np.nan))
    loop.step(slave, gap)
    loop.set_real(slave, fmu.references(names, "input"), np.ascontiguousarray(points))
    loop.step(slave, sample)
    recorder.add_to(loop)
    with slave.only_errors():
        loop.run(0, len(points))
    return recorder.columns()


_FAMILY = 5
"""Set-points of a curve whose set-point moves."""
_MOST_LEVELS = 7
"""Set-points of a curve whose set-point takes a few values."""
_GAP = 0.05
"""Of the range of the set-point: values further apart are of different levels."""
_OUTER = 0.1
"""Percent of the points at either end: single wrong samples do not set the reach."""


@dataclass(frozen=True)
class Reach:
    """The data at a set-point."""

    set_point: float
    """[1]"""
    phi: Range
    """Range of the deformation that was measured at this set-point [rad]."""


def reaches(points: MeasuredPoints, before: Sequence[LearnedLog], one_curve: bool) -> list[Reach]:
    """Where the points of a log reach, and the logs that were learned from before it.

    Of those only the ranges are known, and not over which deformations at which set-point. So where
    their set-point moved they count only at set-points in their range that this log has not.

    one_curve  whether it is the same at all set-points
    """
    values = _inner(points.set_point)
    low = min([values.min(initial=np.inf), *(b.set_point[0] for b in before if b.set_point)])
    high = max([values.max(initial=-np.inf), *(b.set_point[1] for b in before if b.set_point)])
    if low > high:
        return []
    found = []
    settings = _settings(values, float(low), float(high), one_curve)
    of_setting = nearest(settings, points.set_point)
    for i, setting in enumerate(settings):
        own = points.phi[of_setting == i]
        ranges = [_range(own)] if len(own) else []
        ranges += [
            each.phi
            for each in before
            if each.phi
            and each.set_point
            and (one_curve or each.set_point[0] <= setting <= each.set_point[1])
            and (one_curve or not len(own) or each.set_point[0] == each.set_point[1])
        ]
        if ranges:
            phi = min(r[0] for r in ranges), max(r[1] for r in ranges)
            found.append(Reach(setting, phi))
    return found


def _inner(values: Array) -> Array:
    """Values without the outermost."""
    if not len(values):
        return values
    low, high = _range(values)
    inner: Array = values[(values >= low) & (values <= high)]
    return inner


def _range(values: Array) -> Range:
    low, high = np.percentile(values, [_OUTER, 100 - _OUTER]).tolist()
    return low, high


def _settings(values: Array, low: float, high: float, one_curve: bool) -> list[float]:
    """Set-points: levels of the data, else evenly over the range."""
    if one_curve or not high - low > 1e-9 * max(abs(low), abs(high)):
        return [(low + high) / 2]
    ordered = np.unique(values)
    gap = _GAP * (high - low)
    levels = np.split(ordered, np.flatnonzero(np.diff(ordered) > gap) + 1)
    complete = len(ordered) > 0 and low == ordered[0] and high == ordered[-1]
    if complete and len(levels) <= _MOST_LEVELS and all(np.ptp(each) < gap for each in levels):
        return [float(np.median(each)) for each in levels]
    evenly: list[float] = np.linspace(low, high, _FAMILY).tolist()
    return evenly


_WITHIN = 41
"""Points of a branch in the reach of the data."""
_BEYOND, _BEYOND_POINTS = 0.2, 8
"""What is shown beyond either end, over the reach, and its points."""


def curve(
    slave: Slave, every: Mapping[str, Value], logs: Sequence[LearnedLog], points: MeasuredPoints
) -> Curve:
    """Torque and stiffness over the deformation, at each set-point that the data reach.

    The slave does not change. With the method FilteredRegression it gives the standard deviations
    at each point, tau_e_std and sigma_std.

    every   parameters of the slave
    logs    that it has learned from, the last of them now
    points  of the last log
    """
    covered = _union([log.phi for log in logs]), _union([log.set_point for log in logs])
    polynomial = sheet.polynomial(start_values(slave, every), *covered)
    reach = reaches(points, logs[:-1], not polynomial.is_of_set_point)
    grids = [_grid(each, polynomial) for each in reach]
    if every["method"] == "FilteredRegression" and grids:
        found = _evaluated(slave, every, reach, grids)
        polynomial = sheet.with_knees(polynomial, found["phi"], found["setPoint"], found["sigma"])
        return Curve(polynomial, list(_branches(reach, grids, found)))
    branches = []
    for each, phi in zip(reach, grids, strict=True):
        tau_e, sigma = polynomial.at(phi, each.set_point)
        branches.append(Branch(each.set_point, each.phi, phi, tau_e, None, sigma, None))
    return Curve(polynomial, branches)


def _branches(
    reach: Sequence[Reach], grids: Sequence[Array], found: Mapping[str, Array]
) -> Iterator[Branch]:
    ends = np.cumsum([len(grid) for grid in grids])[:-1]
    names = ("tau_e", "tau_e_std", "sigma", "sigma_std")
    rows = zip(*(np.split(found[name], ends) for name in names), strict=True)
    for each, phi, values in zip(reach, grids, rows, strict=True):
        yield Branch(each.set_point, each.phi, phi, *values)


def _union(ranges: Sequence[Range | None]) -> Range | None:
    found = [each for each in ranges if each is not None]
    return (min(low for low, _ in found), max(high for _, high in found)) if found else None


def _grid(reach: Reach, polynomial: Polynomial) -> Array:
    """Deformations of a branch: in the reach, beyond it, and those at which something is told."""
    low, high = reach.phi
    further = _BEYOND * (high - low)
    odd = 0 not in polynomial.powers_of_phi
    known = 0.0 if odd else float(np.clip(0.0, low, high))
    return np.unique(
        np.concatenate(
            [
                np.linspace(low, high, _WITHIN),
                np.linspace(min(low - further, known), low, _BEYOND_POINTS),
                np.linspace(high, max(high + further, known), _BEYOND_POINTS),
                [known, *characteristic(reach.phi)],
            ]
        )
    )


def _evaluated(
    slave: Slave, every: Mapping[str, Value], reach: Sequence[Reach], grids: Sequence[Array]
) -> dict[str, Array]:
    """The outputs _OUTPUTS at each point of each grid, as a copy of the estimator gives them."""
    scale, offset = float(every["setPoint.scale"]), float(every["setPoint.offset"])
    points = [
        (0.0, phi, (each.set_point - offset) / scale if scale else 0.0)
        for each, grid in zip(reach, grids, strict=True)
        for phi in grid
    ]
    with Slave(slave.fmu, "curve") as other:
        other.initialize(every)
        t_0, T = restore(other, save(slave)), float(every["samplePeriod"])
        return stiffness_at(other, ("theta", "q", "theta_c"), np.array(points), t_0, T)


@dataclass(frozen=True)
class Answer:
    """What a replay found."""

    curve: Curve
    """Torque and stiffness over the deformation."""
    points: MeasuredPoints
    """That stand behind it."""
    doubt: str
    """Item of the output doubt at the end."""
