"""The CSV files that `sigmahat reproduce` writes; read_result_files.py reads them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from sigmahat.files import columns
from sigmahat.files.csv_table import write_csv
from sigmahat.fmi.master import Recording, Series
from sigmahat.paper.file_format import ESTIMATION, PLANT, SEEDS, TABLE, TIME
from sigmahat.paper.reproduction import Result
from sigmahat.runs.metrics import INDICES


def write_results(result: Result, folder: Path) -> None:
    """Writes table.csv, and a file over time for each estimator."""
    write_table(result, folder / TABLE)
    for name in result.scenario.estimators:
        write_series(result.recording, name, folder / f"{name}.csv")


def write_table(result: Result, path: Path) -> None:
    """Writes the indices of each comparison, with half the width of their 95 % interval."""
    write_csv(path, *_indices(result))


def as_dict(result: Result) -> dict[str, Any]:
    """For JSON: what table.csv has."""
    head, rows = _indices(result)
    table = [dict(zip(head, row, strict=True)) for row in rows]
    return {"scenario": result.scenario.name, "seeds": list(result.seeds), "table": table}


def _indices(result: Result) -> tuple[list[str], list[list[Any]]]:
    """Titles and rows of the table."""
    scenario = result.scenario
    indices = [INDICES[field] for fields in scenario.tables for field in fields]
    head = [ESTIMATION, SEEDS]
    for index in indices:
        name = index.name(index.when(scenario.settled))
        head += [columns.title(each, index.unit) for each in (name, f"{name} 95 % half width")]
    head += ["MSE of the paper [(N.m/rad)2]", "MSREP of the paper [%]"]
    rows: list[list[Any]] = []
    for each in scenario.comparisons:
        row: list[Any] = [each.name, len(result.seeds)]
        for index in indices:
            row += (None if math.isnan(x) else x for x in result.mean(each.name, index.field))
        rows.append([*row, *scenario.paper.get(each.name, (None, None))])
    return head, rows


def write_series(recording: Recording, estimator: str, path: Path) -> None:
    """Writes plant and one estimator over time: columns t, plant.<output>, <output>, with units."""
    series = recording.estimators[estimator]
    head = [columns.title(TIME, "s"), *_titles(recording.plant, PLANT), *_titles(series, "")]
    values = [recording.t, *recording.plant.values.values(), *series.values.values()]
    write_csv(path, head, zip(*(column.tolist() for column in values), strict=True))


def _titles(series: Series, prefix: str) -> Iterator[str]:
    for name in series.values:
        yield columns.title(f"{prefix}{name}", series.units.get(name))
