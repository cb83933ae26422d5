"""`estimate.points.csv`: the measured points behind the curve. Written and read here."""

from __future__ import annotations

from pathlib import Path

from sigmahat.files.columns import title
from sigmahat.files.csv_table import write_csv
from sigmahat.files.read_table import numeric_columns, read_csv
from sigmahat.logs.measured import MeasuredPoints

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
