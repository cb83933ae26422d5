"""The results of `sigmahat reproduce`: its files, their reader, printed table, JSON."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from sigmahat.experiments.metrics import INDICES, MSREP_IN_WORDS, Index, Indices, mean_interval
from sigmahat.experiments.scenario import Scenario
from sigmahat.files import tables
from sigmahat.files.tables import aligned, numeric_columns, read_csv, write_csv
from sigmahat.fmi.master import Recording
from sigmahat.fmi.series import Series

if TYPE_CHECKING:  # `reproduce` writes its files without pyarrow
    import pyarrow as pa


@dataclass(frozen=True)
class Reproduced:
    """The runs of one scenario with several seeds, and their indices."""

    scenario: Scenario
    seeds: Sequence[int]
    recording: Recording  # run of the first seed, with the variants that only the figures need
    indices: Sequence[Mapping[str, Indices]]  # indices for each seed, by comparison

    def mean(self, comparison: str, field: str) -> tuple[float, float]:
        """Computes the mean of an index for all seeds, and half of the 95 % interval."""
        return mean_interval([getattr(of_seed[comparison], field) for of_seed in self.indices])


TABLE = "table.csv"  # file with the indices of each comparison; the others are over time
ESTIMATION, SEEDS = "estimation", "seeds"  # the first columns of the file with the indices
TIME = "t"  # the first column of a file over time
PLANT = "plant."  # prefix of the names of plant signals in a file over time


_ORDER = ("MODEL", "SENSOR", "RESIDUAL")  # the order of Table I; other estimators follow by name


def read_result_files(folder: Path) -> tuple[pa.Table, Mapping[str, Mapping[str, NDArray[Any]]]]:
    """The files of a folder of `sigmahat reproduce`, estimators in the order of Table I.

    Returns the indices of each comparison, as in table.csv, and the signals by estimator and by
    name, of one shape: t, plant.<output>, <output>.

    Raises ValueError, which says what to do, if the files are not from one run.
    """
    table = read_csv(folder / TABLE)
    series = {}
    names = {path.stem for path in folder.glob("*.csv") if path.name != TABLE}
    for name in sorted(names, key=lambda name: (*(name != each for each in _ORDER), name)):
        signals = numeric_columns(read_csv(folder / f"{name}.csv"))
        if next(iter(signals), None) == TIME:  # the folder may have files of other commands
            series[name] = signals
    if not series or table.column_names[:2] != [ESTIMATION, SEEDS]:
        raise ValueError(f"{folder}: expected results of `sigmahat reproduce`; run it again")
    if len({len(signals[TIME]) for signals in series.values()}) > 1:
        raise ValueError(
            f"{folder}: expected files of equal length; run `sigmahat reproduce` again, "
            "with an empty folder as --out"
        )
    return table, series


def write(result: Reproduced, folder: Path) -> None:
    """Writes table.csv, and a file over time for each estimator."""
    write_csv(folder / TABLE, *_indices(result))
    for name in result.scenario.estimators:
        write_series(result.recording, name, folder / f"{name}.csv")


def values(result: Reproduced) -> dict[str, Any]:
    """The contents of table.csv for JSON, with the units of the indices."""
    scenario = result.scenario
    fields = dict.fromkeys(field for table in scenario.tables for field in table)
    rows = []
    for comparison in scenario.comparisons:
        row: dict[str, Any] = {"estimation": comparison.name, "seeds": len(result.seeds)}
        for field in fields:
            mean, half_width = result.mean(comparison.name, field)
            row[field] = {"mean": mean, "half_width": half_width}
        mse, msrep = scenario.paper.get(comparison.name, (None, None))
        rows.append({**row, "paper": {"mse": mse, "msrep": msrep}})
    return {
        "scenario": scenario.name,
        "seeds": list(result.seeds),
        "settled": scenario.settled,
        "units": {"settled": "s", **{i.field: i.unit for i in INDICES.values()}},
        "table": rows,
    }


def _indices(result: Reproduced) -> tuple[list[str], list[list[Any]]]:
    """Titles and rows of the table, with half the width of the 95 % interval of each index."""
    scenario = result.scenario
    indices = [INDICES[field] for fields in scenario.tables for field in fields]
    head = [ESTIMATION, SEEDS]
    for index in indices:
        name = index.name(index.when(scenario.settled))
        head += [tables.title(name, index.unit)]
        head += [tables.title(f"{name} 95 % half width", index.unit)]
    head += ["MSE of the paper [(N.m/rad)2]", "MSREP of the paper [%]"]
    rows: list[list[Any]] = []
    for comparison in scenario.comparisons:
        row: list[Any] = [comparison.name, len(result.seeds)]
        for index in indices:
            row += (None if math.isnan(x) else x for x in result.mean(comparison.name, index.field))
        rows.append([*row, *scenario.paper.get(comparison.name, (None, None))])
    return head, rows


def write_series(recording: Recording, estimator: str, path: Path) -> None:
    """Writes plant and one estimator over time: columns t, plant.<output>, <output>, with units."""
    series = recording.estimators[estimator]
    head = [tables.title(TIME, "s"), *_titles(recording.plant, PLANT), *_titles(series, "")]
    values = [recording.t, *recording.plant.values.values(), *series.values.values()]
    write_csv(path, head, zip(*(column.tolist() for column in values), strict=True))


def _titles(series: Series, prefix: str) -> Iterator[str]:
    for name in series.values:
        yield tables.title(f"{prefix}{name}", series.units.get(name))


def text(result: Reproduced) -> str:
    """The tables of the scenario with their conditions."""
    scenario = result.scenario
    return (
        f"{scenario.name}: {scenario.description}\n{conditions(result)}\n"
        f"{MSREP_IN_WORDS}\n\n{printed_table(result)}"
    )


def conditions(result: Reproduced) -> str:
    """Describes the conditions of the runs in one line."""
    scenario, seeds = result.scenario, result.seeds
    noise = f"seed {seeds[0]}"
    if len(seeds) > 1:
        noise = f"mean +- 95 % interval over {len(seeds)} seeds"
    parameters = result.recording.estimators["RESIDUAL"].parameters
    prior = float(parameters["rls.c"]) * float(parameters["rls.P_0"])
    return (
        f"{scenario.duration:g} s, T = {scenario.T * 1e3:g} ms, "
        f"V_a = {parameters['filter.V_a']:g} rad2/s4, c P(0) = {prior:g}, {noise}"
    )


def printed_table(result: Reproduced) -> str:
    """The indices of each comparison and of the paper, as text; "-": not defined."""
    tables = [
        _table(result, [INDICES[field] for field in fields], with_paper=i == 0)
        for i, fields in enumerate(result.scenario.tables)
    ]
    return "\n\n".join(tables)


def _table(result: Reproduced, columns: Sequence[Index], with_paper: bool) -> str:
    """Formats one table of indices; the first two columns have values of the paper."""
    paper = result.scenario.paper if with_paper else {}
    rows = [_head(result.scenario, columns)]
    beside = [("paper", "paper")]
    for comparison in result.scenario.comparisons:
        cells = [_cell(result, comparison.name, index) for index in columns]
        rows.append([comparison.name, *cells])
        beside.append(_paper(paper.get(comparison.name)))
    if paper:
        for row, (first, second) in zip(rows, beside, strict=True):
            row[2:2], row[4:4] = [first], [second]
    return "\n".join(aligned(rows))


def _head(scenario: Scenario, columns: Sequence[Index]) -> list[str]:
    """Formats the titles of a table; a time common to all columns is in the corner cell."""
    settled = {index.settled for index in columns}
    if len(settled) > 1:
        return ["", *(index.title(index.when(scenario.settled)) for index in columns)]
    time = columns[0].when(scenario.settled) or f"all {scenario.duration:g} s"
    return [time, *(index.title() for index in columns)]


def _cell(result: Reproduced, comparison: str, index: Index) -> str:
    mean, half_width = result.mean(comparison, index.field)
    if math.isnan(mean):
        return "-"
    interval = "" if math.isnan(half_width) else f" +- {_number(half_width, index)}"
    return f"{_number(mean, index)}{interval}"


def _number(value: float, index: Index) -> str:
    """A number in fixed point, but in exponential form for small values after the start-up."""
    if index.settled and abs(value) < 0.01:
        return f"{value:.1e}"
    return f"{value:.3f}" if index.unit == "%" else f"{value:.2f}"


def _paper(indices: tuple[float, float] | None) -> tuple[str, str]:
    """Formats the indices of the paper with enough digits to distinguish them from zero."""
    if indices is None:
        return "", ""
    mse, msrep = (f"{value:.2f}" if value >= 0.1 else f"{value:.2g}" for value in indices)
    return mse, msrep
