"""Computes measured points and the curve of an estimator: torque and stiffness by deformation."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sigmahat.estimator.estimator import Estimator
from sigmahat.files.tables import numeric_columns, read_csv, title, write_csv
from sigmahat.recording.gaps import stretches
from sigmahat.recording.log import Array
from sigmahat.result import sheet
from sigmahat.result.curve import Branch, Curve, characteristic, nearest
from sigmahat.result.headline import Confidence, StiffnessChange
from sigmahat.result.sheet import Polynomial
from sigmahat.result.stored import LearnedLog, Range

NEEDED = (
    *("phi", "setPoint", "tau_e", "tau_e_residual", "epsilon", "a", "valid", "confident"),
    "change_age",
)
"""Outputs of the estimator from which measured points are computed."""
_GOLDEN = 0.6180339887498949
_POINTS = 3000  # approximate number of points that are shown


def since_change(outputs: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Selects the outputs after the last change of the stiffness, which belong to one curve.

    Without a change, or without a used sample since the last change, all outputs are selected.
    """
    begins = restarts(outputs["change_age"])
    first = int(begins[-1]) if len(begins) and _used(outputs)[begins[-1] :].any() else 0
    return {name: values[first:] for name, values in outputs.items()}


def restarts(age: NDArray[np.float64], before: float = -1.0) -> NDArray[np.intp]:
    """Finds indices at which the output change_age [s] restarts; before: the preceding value."""
    last = np.concatenate([[before], age[:-1]])
    return np.flatnonzero((age >= 0) & ((age < last) | (last < 0)))


def _used(outputs: Mapping[str, NDArray[Any]]) -> NDArray[np.bool_]:
    """Marks the ticks that the regression used."""
    return outputs["valid"].astype(bool) & (outputs["a"] > 0)


@dataclass(frozen=True)
class MeasuredPoints:
    """Measured points of the curve; all arrays have the same size."""

    phi: Array  # deformation [rad]
    set_point: Array  # [1]
    tau_e: Array  # flexibility torque [N.m]


def points_of(outputs: Mapping[str, NDArray[Any]], method: str) -> MeasuredPoints:
    """Computes the measured points at the ticks that the regression used.

    FilteredRegression filters all signals and estimates friction, inertia and bias with the curve.
    The torque of a point is the torque of the curve plus the prediction error (partial residual).
    With Paper2011, the torque of a point is the residual itself.

    outputs  outputs of the estimator by name, of one size
    """
    used = _used(outputs)
    regression = method == "FilteredRegression"
    tau_e = outputs["tau_e"] + outputs["epsilon"] if regression else outputs["tau_e_residual"]
    return MeasuredPoints(outputs["phi"][used], outputs["setPoint"][used], tau_e[used])


def shown_points(outputs: Mapping[str, NDArray[Any]], method: str) -> MeasuredPoints:
    """Selects points for a plot, with FilteredRegression about 3000 after the first confident tick.

    Before the first confident tick, unknown friction and bias falsify the torques. Without a
    confident tick, points of all ticks are selected.
    """
    if method != "FilteredRegression":
        return points_of(outputs, method)
    first = int(np.argmax(outputs["confident"]))
    every = points_of({name: values[first:] for name, values in outputs.items()}, method)
    shown = spread(0, len(every.phi), -(-len(every.phi) // _POINTS) or 1)
    return MeasuredPoints(every.phi[shown], every.set_point[shown], every.tau_e[shown])


def spread(first: int, count: int, stride: int) -> NDArray[np.intp]:
    """Selects one tick of each stride, at varying places to avoid aliasing with the motion.

    The selected ticks do not depend on how a log is split into chunks from `first` on.
    """
    stretches = np.arange(first // stride, -(-(first + count) // stride))
    within = np.floor(stretches * _GOLDEN % 1 * stride).astype(np.intp)
    found: NDArray[np.intp] = stretches * stride + within - first
    return found[(found >= 0) & (found < count)]


def extremes(values: NDArray[Any], bucket: int) -> NDArray[Any]:
    """Returns minimum and maximum of each bucket of values in turn; nan values are ignored."""
    starts = np.arange(0, len(values), bucket)
    return np.column_stack([f.reduceat(values, starts) for f in (np.fmin, np.fmax)]).ravel()


POINTS = "estimate.points.csv"  # name of the file in the folder of results
_UNITS = {"setPoint": "1", "phi": "rad", "tau_e": "N.m"}


def write_points(points: MeasuredPoints, path: Path) -> None:
    """Writes the measured points as CSV, one row for each point."""
    columns = (points.set_point, points.phi, points.tau_e)
    head = [title(name, unit) for name, unit in _UNITS.items()]
    write_csv(path, head, zip(*(column.tolist() for column in columns), strict=True))


def read_points(path: Path) -> MeasuredPoints:
    """Reads measured points. Raises ValueError with a remedy for a file without such points."""
    again = "run `sigmahat estimate` again"
    try:
        columns = numeric_columns(read_csv(path))
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror}; {again}") from error
    if missing := set(_UNITS) - set(columns):
        raise ValueError(f"{path}: no numbers in column {min(missing)!r}; {again}")
    return MeasuredPoints(columns["phi"], columns["setPoint"], columns["tau_e"])


_FAMILY = 5  # set-points of a curve whose set-point moves
_MOST_LEVELS = 7  # set-points of a curve whose set-point takes a few values
_BINS, _WIDEST = 40, 3
"""Number of bins of the set-point range, and largest number of adjacent bins of one level."""
_FEW = 0.01
"""Smallest fraction of the points in a bin of a level; with fewer points, the set-point moved."""
_AT_LEVELS = 0.9  # fraction of the points at levels, if the set-point takes a few values
_OUTER = 0.1
"""Percentage of points left out at both ends, so that outliers do not determine the range."""


class Reach(NamedTuple):
    """A set-point [1], and the range of the deformations measured at this set-point [rad]."""

    set_point: float
    phi: Range


def reaches(points: MeasuredPoints, before: Sequence[LearnedLog], one_curve: bool) -> list[Reach]:
    """Computes the ranges of the data from the points of a log and from earlier logs.

    Only total ranges of earlier logs are known, not the deformations at each set-point. If the
    set-point moved in an earlier log, the range counts only at set-points without own points.

    one_curve  whether the curve is equal at all set-points
    """
    values = points.set_point
    if len(values):  # outliers are ignored
        least, most = _range(values)
        values = values[(values >= least) & (values <= most)]
    low = min([values.min(initial=np.inf), *(b.set_point[0] for b in before if b.set_point)])
    high = max([values.max(initial=-np.inf), *(b.set_point[1] for b in before if b.set_point)])
    if low > high:
        return []
    found = []
    settings = _settings(values, float(low), float(high), one_curve)
    of_setting = nearest(settings, points.set_point)
    for i, setting in enumerate(settings):
        own = points.phi[of_setting == i]
        ranges = [_range(own)] if len(own) > _FEW * len(points.phi) else []
        ranges += [
            each.phi
            for each in before
            if each.phi
            and each.set_point
            and (one_curve or each.set_point[0] <= setting <= each.set_point[1])
            and (one_curve or not ranges or each.set_point[0] == each.set_point[1])
        ]
        if phi := union(ranges):
            found.append(Reach(setting, phi))
    return found


def _range(values: Array) -> Range:
    low, high = np.percentile(values, [_OUTER, 100 - _OUTER]).tolist()
    return low, high


def _settings(values: Array, low: float, high: float, one_curve: bool) -> list[float]:
    """Chooses set-points for the curve: levels of the data, else evenly spaced values."""
    if one_curve or not high - low > 1e-9 * max(abs(low), abs(high)):
        return [(low + high) / 2]
    if len(values) and low == values.min() and high == values.max():
        part = np.minimum((_BINS * (values - low) / (high - low)).astype(int), _BINS - 1)
        begins, ends = stretches(np.bincount(part, minlength=_BINS) > _FEW * len(values))
        levels = [values[(part >= i) & (part < j)] for i, j in zip(begins, ends, strict=True)]
        is_narrow = len(levels) <= _MOST_LEVELS and max(ends - begins, default=0) <= _WIDEST
        if is_narrow and sum(map(len, levels)) >= _AT_LEVELS * len(values):
            return [float(np.median(each)) for each in levels]
    evenly: list[float] = np.linspace(low, high, _FAMILY).tolist()
    return evenly


_WITHIN = 41  # number of points of a branch in the range of the data
_BEYOND, _BEYOND_POINTS = 0.2, 8
"""Extrapolation beyond each end, relative to the range, and its number of points."""


def curve(estimator: Estimator, logs: Sequence[LearnedLog], points: MeasuredPoints) -> Curve:
    """Computes torque and stiffness by deformation, at each set-point with data.

    With the method FilteredRegression, the curve has the standard deviations tau_e_std and
    sigma_std at each point.

    estimator  for one joint; it does not change
    logs       logs that the estimator has processed; the last is the present log
    points     measured points of the last log
    """
    covered = union([log.phi for log in logs]), union([log.set_point for log in logs])
    polynomial = sheet.polynomial(sheet.start_values(estimator), *covered)
    reach = reaches(points, logs[:-1], not polynomial.is_of_set_point)
    grids = [_grid(each, polynomial) for each in reach]
    (parameters,) = estimator.parameters
    if parameters["method"] == "FilteredRegression" and grids:
        return _evaluated(estimator, polynomial, reach, grids)
    branches = []
    for at, phi in zip(reach, grids, strict=True):
        tau_e, sigma = polynomial.at(phi, at.set_point)
        branches.append(Branch(*at, phi, tau_e, None, sigma, None))
    return Curve(polynomial, branches)


def _evaluated(
    estimator: Estimator, polynomial: Polynomial, reach: Sequence[Reach], grids: Sequence[Array]
) -> Curve:
    """Computes the curve by Estimator.evaluate. The polynomial is fitted to it, if it has knees."""
    found = [estimator.evaluate(phi, at.set_point) for at, phi in zip(reach, grids, strict=True)]
    tau_e = [values["tau_e"] for values in found]
    sigma = [values["sigma"] for values in found]
    set_points = np.repeat([at.set_point for at in reach], [len(phi) for phi in grids])
    fitted = sheet.with_knees(
        polynomial,
        np.concatenate(grids),
        set_points,
        np.concatenate(tau_e),
        np.concatenate(sigma),
    )
    branches = [
        Branch(*at, phi, *(values[name] for name in ("tau_e", "tau_e_std", "sigma", "sigma_std")))
        for at, phi, values in zip(reach, grids, found, strict=True)
    ]
    return Curve(fitted, branches)


def union(ranges: Sequence[Range | None]) -> Range | None:
    """Returns the smallest range that contains all given ranges; None without a range."""
    found = [each for each in ranges if each is not None]
    return (min(low for low, _ in found), max(high for _, high in found)) if found else None


def _grid(reach: Reach, polynomial: Polynomial) -> Array:
    """Chooses deformations of a branch inside and outside of the data range, and to be printed."""
    low, high = reach.phi
    further = _BEYOND * (high - low)
    odd = 0 not in polynomial.powers_of_phi
    known = 0.0 if odd else float(np.clip(0.0, low, high))
    inside = np.linspace(low, high, _WITHIN)
    below = np.linspace(min(low - further, known), low, _BEYOND_POINTS)
    above = np.linspace(high, max(high + further, known), _BEYOND_POINTS)
    return np.unique([*inside, *below, *above, known, *characteristic(reach.phi)])


@dataclass(frozen=True)
class Answer:
    """The result of a replay: curve, measured points, confidence, and changes of the stiffness."""

    curve: Curve  # torque and stiffness against the deformation
    points: MeasuredPoints  # measured points of the curve
    confidence: Confidence
    changes: Sequence[StiffnessChange]
