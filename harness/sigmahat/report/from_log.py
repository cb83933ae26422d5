"""The contents of a report from what `sigmahat estimate` wrote."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet
from numpy.typing import NDArray

from sigmahat.files.columns import title
from sigmahat.files.read_table import NumericColumn, numeric_columns, read_csv
from sigmahat.report.contents import Contents, TextTable, number
from sigmahat.report.reduction import reduce
from sigmahat.report.time_panels import Estimate, quantity_panels, sampling, stiffness_panels

_PREFIX = "estimate."
"""Of the columns that `sigmahat estimate` adds to a log."""
_OF_THE_METHOD = ("a", "rho")
"""Outputs about the inner working of the method; they are not in the table."""


def from_log(folder: Path) -> Contents:
    """Stiffness and all other signals of the estimator.

    Raises ValueError, which says what to do, for a file that is damaged or of something else.
    """
    path = next(folder.glob("estimate.parquet"), folder / "estimate.csv")
    columns = _read(path)
    if not {"t", "sigma", "valid"} <= columns.keys():
        raise ValueError(f"{path}: no table of `sigmahat estimate`; run it again")
    used = columns.pop("valid").values.astype(bool)
    t = columns.pop("t").values
    reduced = reduce(t, {name: column.values for name, column in columns.items()})
    return Contents(
        f"Log: {folder.resolve().name}",
        [
            f"{len(used)} rows over {t[-1] - t[0]:.6g} s; in {np.count_nonzero(~used)} of them "
            "the estimator skipped the tick",
            *sampling(reduced),
        ],
        [_estimates(columns, used)],
        [
            *stiffness_panels(reduced, [Estimate("estimate", {"sigma": "sigma"})]),
            *quantity_panels(reduced, ""),
        ],
        reduced.every if reduced.bucket > 1 else None,
    )


def _read(path: Path) -> dict[str, NumericColumn]:
    """The columns of the estimator; a log may have many others."""
    if path.suffix == ".csv":
        table = read_csv(path)
    else:
        try:
            names = [n for n in pa.parquet.read_schema(path).names if n.startswith(_PREFIX)]
            table = pa.parquet.read_table(path, columns=names)
        except (pa.ArrowException, OSError) as error:
            raise ValueError(f"{path}: damaged; run `sigmahat estimate` again") from error
    return {
        name.removeprefix(_PREFIX): column
        for name, column in numeric_columns(table).items()
        if name.startswith(_PREFIX)
    }


def _estimates(columns: dict[str, NumericColumn], used: NDArray[np.bool_]) -> TextTable:
    """Each output at the end, and its range and RMS where the estimator ran in the second half."""
    late = used & (np.arange(len(used)) >= len(used) // 2)
    rows = []
    for name, column in columns.items():
        if name not in _OF_THE_METHOD:
            cells = [column.values[-1], *_range_and_rms(column.values[late])]
            rows.append([title(name, column.unit), *(number(float(cell)) for cell in cells)])
    return TextTable(
        "Estimates",
        ["", "at the end", "least *", "greatest *", "RMS *"],
        rows,
        [True, False, False, False, False],
        note="* in the second half",
    )


def _range_and_rms(values: NDArray[Any]) -> list[float]:
    if not len(values):
        return [np.nan] * 3
    return [values.min(), values.max(), float(np.sqrt(np.mean(values**2)))]
