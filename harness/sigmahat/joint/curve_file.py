"""`estimate.curve.csv`: the curve of a joint as a table, for every tool. Written and read here."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa

from sigmahat.files.columns import title
from sigmahat.files.csv_table import write_csv
from sigmahat.files.read_table import numeric_columns, read_csv
from sigmahat.joint.curve import Array, Branch, Curve
from sigmahat.joint.sheet import Polynomial

CURVE = "estimate.curve.csv"
"""Name of the file in the folder of results."""
_UNITS = {
    "setPoint": "1",
    "phi": "rad",
    "tau_e": "N.m",
    "tau_e_std": "N.m",
    "tau_e low": "N.m",
    "tau_e high": "N.m",
    "sigma": "N.m/rad",
    "sigma_std": "N.m/rad",
    "sigma low": "N.m/rad",
    "sigma high": "N.m/rad",
    "in the data": None,
}


def write_curve(curve: Curve, path: Path) -> None:
    """Writes a row for each point, numbers with all digits; without intervals, they are empty."""
    rows = (row for branch in curve.branches for row in _rows(branch))
    write_csv(path, [title(name, unit) for name, unit in _UNITS.items()], rows)


def _rows(branch: Branch) -> Iterator[tuple[object, ...]]:
    count = len(branch.phi)
    columns: list[Sequence[object]] = [
        [branch.set_point] * count,
        branch.phi.tolist(),
        branch.tau_e.tolist(),
        *_or_empty([branch.tau_e_std], count),
        *_or_empty(branch.torque_interval() or [None, None], count),
        branch.sigma.tolist(),
        *_or_empty([branch.sigma_std], count),
        *_or_empty(branch.stiffness_interval() or [None, None], count),
        ["true" if each else "false" for each in branch.within],
    ]
    yield from zip(*columns, strict=True)


def _or_empty(columns: Sequence[Array | None], count: int) -> Iterator[Sequence[object]]:
    for column in columns:
        yield [None] * count if column is None else column.tolist()


def read_curve(path: Path, polynomial: Polynomial) -> Curve:
    """Reads it back; the polynomial is in the data sheet beside it.

    Raises ValueError, which says what to do, for anything else.
    """
    again = "run `sigmahat estimate` again"
    try:
        table = read_csv(path)
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror}; {again}") from error
    if [name.partition(" [")[0] for name in table.column_names] != list(_UNITS):
        raise ValueError(f"{path}: expected the curve that `sigmahat estimate` writes; {again}")
    if not table.num_rows:
        return Curve(polynomial, ())
    empty = [name for name in table.column_names if pa.types.is_null(table[name].type)]
    columns = {name: c.values for name, c in numeric_columns(table.drop_columns(empty)).items()}
    if missing := set(_UNITS) - set(columns) - {name.partition(" [")[0] for name in empty}:
        raise ValueError(f"{path}: no numbers in column {min(missing)!r}; {again}")
    settings = np.unique(columns["setPoint"])
    return Curve(polynomial, [_branch(columns, columns["setPoint"] == each) for each in settings])


def _branch(columns: dict[str, Array], rows: Array) -> Branch:
    own = {name: values[rows] for name, values in columns.items()}
    within = own["phi"][own["in the data"] == 1]
    return Branch(
        set_point=float(own["setPoint"][0]),
        reach=(float(within.min()), float(within.max())),
        phi=own["phi"],
        tau_e=own["tau_e"],
        tau_e_std=own.get("tau_e_std"),
        sigma=own["sigma"],
        sigma_std=own.get("sigma_std"),
    )
