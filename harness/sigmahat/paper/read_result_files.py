"""What `sigmahat reproduce` wrote, read back; result_files.py writes it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa
from numpy.typing import NDArray

from sigmahat.files.read_table import numeric_columns, read_csv
from sigmahat.paper.file_format import ESTIMATION, SEEDS, TABLE, TIME

_ORDER = ("MODEL", "SENSOR", "RESIDUAL")
"""That of Table I; other estimators follow by name."""


@dataclass(frozen=True)
class ResultFiles:
    """The files of one folder."""

    table: pa.Table
    """The indices of each comparison, as in table.csv."""
    series: Mapping[str, Mapping[str, NDArray[Any]]]
    """Signals by estimator and by name, of one shape: t, plant.<output>, <output>."""


def read_result_files(folder: Path) -> ResultFiles:
    """Reads a folder of `sigmahat reproduce`, the estimators in the order of Table I.

    Raises ValueError, which says what to do, if its files are not those of one run.
    """
    table = read_csv(folder / TABLE)
    series = {}
    names = {path.stem for path in folder.glob("*.csv") if path.name != TABLE}
    for name in sorted(names, key=lambda name: (*(name != each for each in _ORDER), name)):
        signals = {
            n: c.values for n, c in numeric_columns(read_csv(folder / f"{name}.csv")).items()
        }
        if next(iter(signals), None) == TIME:  # files of other commands may be there
            series[name] = signals
    if not series or table.column_names[:2] != [ESTIMATION, SEEDS]:
        raise ValueError(f"{folder}: no result of `sigmahat reproduce`; run it again")
    if len({len(signals[TIME]) for signals in series.values()}) > 1:
        raise ValueError(
            f"{folder}: files of different lengths; run `sigmahat reproduce` again, "
            "with an empty folder as --out"
        )
    return ResultFiles(table, series)
