"""Measured points: the torque over the deformation, as an estimator sees it, and their file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.files.tables import numeric_columns, read_csv, title, write_csv
from sigmahat.fmi.instance import Slave, Value
from sigmahat.fmi.saved_state import restore, save
from sigmahat.logs.log import Array
from sigmahat.logs.replay import gap, play
from sigmahat.logs.sampling import Samples

NEEDED = ("phi", "setPoint", "tau_e", "tau_e_residual", "epsilon", "a", "valid")
"""Outputs of the estimator that points are made of."""
_GOLDEN = 0.6180339887498949
_BLOCKS, _TICKS = 12, 5000
"""Parts of the log that are looked at again, at most, and ticks of each."""
_POINTS = 3000
"""That are kept, about."""


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


def with_what_was_learned(
    slave: Slave, every: Mapping[str, Value], samples: Samples
) -> MeasuredPoints:
    """About 3000 points of up to 60000 samples, as FilteredRegression sees them at the end of a
    log.

    At the start it does not yet know friction and bias, and sees other torques. So a copy of it,
    with all that it has learned, is given up to 12 parts of the log again. The slave does not
    change.

    every  parameters of the slave
    """
    count = len(samples.values)
    blocks = min(_BLOCKS, -(-count // _TICKS))
    starts = np.linspace(0, max(0, count - _TICKS), blocks).astype(int)
    found: list[dict[str, NDArray[Any]]] = []
    with Slave(slave.fmu, "points") as other:
        other.initialize(every)
        t = restore(other, save(slave))
        for first in starts:
            t = gap(other, t, every)
            part = replace(samples, values=samples.values[first : first + _TICKS])
            with other.only_errors():
                found += play(other, part, _TICKS, t)
            t += len(part.values) * samples.T
    columns = {name: np.concatenate([each[name] for each in found]) for name in NEEDED}
    every_point = points_of(columns, "FilteredRegression")
    stride = -(-len(every_point.phi) // _POINTS) or 1
    shown = spread(0, len(every_point.phi), stride)
    return MeasuredPoints(
        every_point.phi[shown], every_point.set_point[shown], every_point.tau_e[shown]
    )


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
