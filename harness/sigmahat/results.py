"""Results as text and as CSV files."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from sigmahat.cosimulation import Recording, Series
from sigmahat.metrics import SETTLED, mean_interval
from sigmahat.reproduce import Result
from sigmahat.scenarios import T

_INDICES = (
    ("mse", "MSE [(N.m/rad)2]"),
    ("msrep", "MSREP [%]"),
    ("msrep_settled", f"MSREP after {SETTLED:g} s [%]"),
)


@contextmanager
def folder(path: Path) -> Iterator[Path]:
    """Yields a folder to write into; its files appear in path together, once all is well.

    Creates path, and leaves nothing behind after an exception. Raises OSError if path cannot be
    written to.
    """
    missing = [p for p in (path, *path.parents) if not p.exists()]
    try:
        path.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(prefix=".unfinished-", dir=path) as unfinished:
            yield Path(unfinished)
            for file in sorted(Path(unfinished).iterdir()):
                file.replace(path / file.name)
    except BaseException:
        for p in missing:
            with suppress(OSError):
                p.rmdir()
        raise


def conditions(result: Result) -> str:
    """The conditions of the runs in one line."""
    scenario, seeds = result.scenario, result.seeds
    noise = f"seed {seeds[0]}"
    if len(seeds) > 1:
        noise = f"mean +- 95 % interval over {len(seeds)} seeds"
    parameters = result.recording.estimators["RESIDUAL"].parameters
    return (
        f"{scenario.duration:g} s, T = {T * 1e3:g} ms, "
        f"V_a = {parameters['filter.V_a']:g} rad2/s4, {noise}"
    )


def table(result: Result) -> str:
    """The indices of each modality beside the paper's, as text."""
    paper = result.scenario.paper
    head = ["", *(title for _, title in _INDICES)]
    if paper:
        head[2:2] = ["paper"]
        head[4:4] = ["paper"]
    rows = [head]
    for name in result.scenario.estimators:
        cells = [_cell(result, name, index) for index, _ in _INDICES]
        if paper:
            known = [f"{index:.2f}" for index in paper.get(name, ())] or ["", ""]
            cells[1:1], cells[3:3] = known[:1], known[1:]
        rows.append([name, *cells])
    widths = [max(len(row[i]) for row in rows) for i in range(len(head))]
    return "\n".join(
        "  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]) for row in rows
    )


def write_table(result: Result, path: Path) -> None:
    """Writes the indices of each modality, with half the width of their 95 % interval."""
    head = ["estimation", "seeds"]
    for _, title in _INDICES:
        head += [title, title.replace(" [", " 95 % half width [")]
    head += ["MSE of the paper [(N.m/rad)2]", "MSREP of the paper [%]"]
    rows: list[list[Any]] = []
    for name in result.scenario.estimators:
        row: list[Any] = [name, len(result.seeds)]
        for index, _ in _INDICES:
            row += (None if math.isnan(x) else x for x in _mean(result, name, index))
        rows.append([*row, *result.scenario.paper.get(name, (None, None))])
    _write(path, head, rows)


def write_series(recording: Recording, name: str, path: Path) -> None:
    """Writes plant and one estimator over time: columns t, plant.<output>, <output>, with units."""
    estimator = recording.estimators[name]
    head = ["t [s]", *_titles(recording.plant, "plant."), *_titles(estimator, "")]
    columns = [recording.t, *recording.plant.values.values(), *estimator.values.values()]
    _write(path, head, zip(*(column.tolist() for column in columns), strict=True))


def _titles(series: Series, prefix: str) -> Iterator[str]:
    for name in series.values:
        unit = series.units.get(name)
        yield f"{prefix}{name} [{unit}]" if unit else f"{prefix}{name}"


def _mean(result: Result, name: str, index: str) -> tuple[float, float]:
    return mean_interval([getattr(each[name], index) for each in result.indices])


def _cell(result: Result, name: str, index: str) -> str:
    mean, half_width = _mean(result, name, index)
    form = {"mse": ".2f", "msrep": ".3f", "msrep_settled": ".1e"}[index]
    interval = "" if math.isnan(half_width) else f" +- {half_width:{form}}"
    return f"{mean:{form}}{interval}"


def _write(path: Path, head: list[str], rows: Iterable[Iterable[Any]]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(rows)
