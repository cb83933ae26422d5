"""Measured points: the torque over the deformation, as an estimator sees it, and their file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.files.tables import numeric_columns, read_csv, title, write_csv
from sigmahat.logs.log import Array

NEEDED = ("phi", "setPoint", "tau_e", "tau_e_residual", "epsilon", "a", "valid", "confident")
"""Outputs of the estimator that points are made of."""
_GOLDEN = 0.6180339887498949
_POINTS = 3000
"""That are shown, about."""


@dataclass(frozen=True)
class MeasuredPoints:
    """Of one size."""

    phi: Array
    """Deformation [rad]"""
    set_point: Array
    """[1]"""
    tau_e: Array
    """Flexibility torque [N.m]"""


def points_of(outputs: Mapping[str, NDArray[Any]], method: str) -> MeasuredPoints:
    """The points at the ticks from which the estimator has learned.

    FilteredRegression filters all signals and estimates friction, inertia and bias with the curve.
    What it leaves unexplained, its prediction error, is added to the torque of the curve: a partial
    residual. Paper2011 measures the torque itself, by its residual.

    outputs  of the estimator by name, of one size
    """
    used = outputs["valid"].astype(bool) & (outputs["a"] > 0)
    regression = method == "FilteredRegression"
    tau_e = outputs["tau_e"] + outputs["epsilon"] if regression else outputs["tau_e_residual"]
    return MeasuredPoints(outputs["phi"][used], outputs["setPoint"][used], tau_e[used])


def shown_points(outputs: Mapping[str, NDArray[Any]], method: str) -> MeasuredPoints:
    """The points behind a curve: with FilteredRegression about 3000, since it was first confident.

    Before, it does not yet know friction and bias, and sees other torques. If it never was
    confident, all points count.
    """
    if method != "FilteredRegression":
        return points_of(outputs, method)
    first = int(np.argmax(outputs["confident"]))
    every = points_of({name: values[first:] for name, values in outputs.items()}, method)
    shown = spread(0, len(every.phi), -(-len(every.phi) // _POINTS) or 1)
    return MeasuredPoints(every.phi[shown], every.set_point[shown], every.tau_e[shown])


def spread(first: int, count: int, stride: int) -> NDArray[np.intp]:
    """Indices, one in stride, of ticks first, first + 1 ...: they do not beat with a motion.

    Which index of each stretch of stride ticks is taken is the same for all ways to split a log.
    """
    stretches = np.arange(first // stride, -(-(first + count) // stride))
    within = np.floor(stretches * _GOLDEN % 1 * stride).astype(np.intp)
    found: NDArray[np.intp] = stretches * stride + within - first
    return found[(found >= 0) & (found < count)]


POINTS = "estimate.points.csv"
"""Name of the file in the folder of results."""
_UNITS = {"setPoint": "1", "phi": "rad", "tau_e": "N.m"}


def write_points(points: MeasuredPoints, path: Path) -> None:
    """Writes a row for each point."""
    columns = (points.set_point, points.phi, points.tau_e)
    head = [title(name, unit) for name, unit in _UNITS.items()]
    write_csv(path, head, zip(*(column.tolist() for column in columns), strict=True))


def read_points(path: Path) -> MeasuredPoints:
    """Reads it back. Raises ValueError, which says what to do, for anything else."""
    again = "run `sigmahat estimate` again"
    try:
        columns = numeric_columns(read_csv(path))
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror}; {again}") from error
    if missing := set(_UNITS) - set(columns):
        raise ValueError(f"{path}: no numbers in column {min(missing)!r}; {again}")
    return MeasuredPoints(
        columns["phi"].values, columns["setPoint"].values, columns["tau_e"].values
    )
