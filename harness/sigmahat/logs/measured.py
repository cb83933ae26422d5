"""Measured points: torque against deformation, as an estimator computes them, and their file."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.files.tables import numeric_columns, read_csv, title, write_csv
from sigmahat.logs.log import Array

NEEDED = ("phi", "setPoint", "tau_e", "tau_e_residual", "epsilon", "a", "valid", "confident")
"""Outputs of the estimator from which points are computed."""
_GOLDEN = 0.6180339887498949
_POINTS = 3000  # approximate number of points that are shown


@dataclass(frozen=True)
class MeasuredPoints:
    """Arrays of one size."""

    phi: Array  # deformation [rad]
    set_point: Array  # [1]
    tau_e: Array  # flexibility torque [N.m]


def points_of(outputs: Mapping[str, NDArray[Any]], method: str) -> MeasuredPoints:
    """The points at the ticks from which the estimator has learned.

    FilteredRegression filters all signals and estimates friction, inertia and bias with the curve.
    Its prediction error is added to the torque of the curve, which gives a partial residual.
    Paper2011 uses the residual itself as the measured torque.

    outputs  of the estimator by name, of one size
    """
    used = outputs["valid"].astype(bool) & (outputs["a"] > 0)
    regression = method == "FilteredRegression"
    tau_e = outputs["tau_e"] + outputs["epsilon"] if regression else outputs["tau_e_residual"]
    return MeasuredPoints(outputs["phi"][used], outputs["setPoint"][used], tau_e[used])


def shown_points(outputs: Mapping[str, NDArray[Any]], method: str) -> MeasuredPoints:
    """The points of a curve: with FilteredRegression about 3000, from the first confident tick on.

    Before this tick, friction and bias are not known, so the torques differ. Without a confident
    tick, all points count.
    """
    if method != "FilteredRegression":
        return points_of(outputs, method)
    first = int(np.argmax(outputs["confident"]))
    every = points_of({name: values[first:] for name, values in outputs.items()}, method)
    shown = spread(0, len(every.phi), -(-len(every.phi) // _POINTS) or 1)
    return MeasuredPoints(every.phi[shown], every.set_point[shown], every.tau_e[shown])


def spread(first: int, count: int, stride: int) -> NDArray[np.intp]:
    """Indices of ticks first, first + 1 ..., one per stride, without a beat with the motion.

    The chosen index of each stride does not depend on how a log is split.
    """
    stretches = np.arange(first // stride, -(-(first + count) // stride))
    within = np.floor(stretches * _GOLDEN % 1 * stride).astype(np.intp)
    found: NDArray[np.intp] = stretches * stride + within - first
    return found[(found >= 0) & (found < count)]


POINTS = "estimate.points.csv"  # name of the file in the folder of results
_UNITS = {"setPoint": "1", "phi": "rad", "tau_e": "N.m"}


def write_points(points: MeasuredPoints, path: Path) -> None:
    """Writes a row for each point."""
    columns = (points.set_point, points.phi, points.tau_e)
    head = [title(name, unit) for name, unit in _UNITS.items()]
    write_csv(path, head, zip(*(column.tolist() for column in columns), strict=True))


def read_points(path: Path) -> MeasuredPoints:
    """Reads this file. Raises ValueError, which says what to do, for any other file."""
    again = "run `sigmahat estimate` again"
    try:
        columns = numeric_columns(read_csv(path))
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror}; {again}") from error
    if missing := set(_UNITS) - set(columns):
        raise ValueError(f"{path}: no numbers in column {min(missing)!r}; {again}")
    return MeasuredPoints(columns["phi"], columns["setPoint"], columns["tau_e"])
