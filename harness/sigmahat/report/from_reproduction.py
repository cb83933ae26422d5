"""The contents of a report from what `sigmahat reproduce` wrote."""

from __future__ import annotations

import re
from pathlib import Path

import pyarrow as pa

from sigmahat.files.columns import name_and_unit
from sigmahat.paper.file_format import SEEDS, TIME
from sigmahat.paper.read_result_files import read_result_files
from sigmahat.plotting.symbols import plain_title
from sigmahat.report.contents import Contents, TextTable, number
from sigmahat.report.over_deformation import over_deformation
from sigmahat.report.reduction import reduce
from sigmahat.report.time_panels import Estimate, quantity_panels, sampling, stiffness_panels

_MAIN = "RESIDUAL"
"""What is shown of one estimator is shown of the one that needs no sensor of torque."""
_STIFFNESS = re.compile(r"sigma(_\d)?")


def from_reproduction(folder: Path) -> Contents:
    """Stiffness of every estimator, and all other signals of one of them.

    Raises ValueError as read_result_files() does.
    """
    files = read_result_files(folder)
    main = _MAIN if _MAIN in files.series else next(iter(files.series))
    signals = dict(files.series[main])
    t = signals.pop(TIME)
    estimates = []
    for name, own in files.series.items():
        keys = {
            variable: f"{name} {variable}" for variable in own if _STIFFNESS.fullmatch(variable)
        }
        signals |= {key: own[variable] for variable, key in keys.items()}
        estimates.append(Estimate(name, keys))
    reduced = reduce(t, signals)
    seeds = files.table[SEEDS][0].as_py()
    of_seeds = f" of {seeds} seeds; the plots show the first" if seeds > 1 else ""
    return Contents(
        f"Reproduction: {folder.resolve().name}",
        [f"{len(t)} samples{of_seeds}"],
        [_indices(files.table)],
        [
            *stiffness_panels(reduced, estimates),
            *quantity_panels(reduced, main if len(files.series) > 1 else ""),
        ],
        answer=list(over_deformation(files.series[main], main)),
        notes=sampling(reduced),
        every=reduced.every if reduced.bucket > 1 else None,
    )


def _indices(table: pa.Table) -> TextTable:
    """The columns that have a value in some row."""
    shown = [field for field in table.schema if table[field.name].null_count < len(table)]
    columns = [[number(cell) for cell in table[field.name].to_pylist()] for field in shown]
    return TextTable(
        "Performance indices",
        [plain_title(*name_and_unit(field.name)) for field in shown],
        list(zip(*columns, strict=True)),
        [pa.types.is_string(field.type) for field in shown],
    )
