"""Results as text and as CSV files."""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from shutil import rmtree
from typing import Any

from sigmahat.fmi.master import Recording, Series
from sigmahat.paper.comparisons import METHODS, Line
from sigmahat.paper.metrics import mean_interval
from sigmahat.paper.reproduction import Result
from sigmahat.paper.scenarios import Scenario, T

_TITLES = {"mse": "MSE [(N.m/rad)2]", "msrep": "MSREP [%]", "error": "mean error [%]"}


@contextmanager
def folder(path: Path) -> Iterator[Path]:
    """Yields a folder to write into; its files appear in path together, once all is well.

    Creates path, and leaves nothing behind after an exception. Raises OSError if path cannot be
    written to.
    """
    missing = [p for p in (path, *path.parents) if not p.exists()]
    # A name known beforehand, so that an interrupt at any moment leaves nothing behind.
    unfinished = path / f".unfinished-{os.getpid()}"
    try:
        unfinished.mkdir(parents=True)
        yield unfinished
        for file in sorted(unfinished.iterdir()):
            file.replace(path / file.name)
        unfinished.rmdir()
    except BaseException:
        rmtree(unfinished, ignore_errors=True)
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
    prior = float(parameters["rls.c"]) * float(parameters["rls.P_0"])
    return (
        f"{scenario.duration:g} s, T = {T * 1e3:g} ms, "
        f"V_a = {parameters['filter.V_a']:g} rad2/s4, c P(0) = {prior:g}, {noise}"
    )


def table(result: Result) -> str:
    """The indices of each comparison beside the paper's, as text; "-": not defined."""
    tables = [_table(result, columns, i == 0) for i, columns in enumerate(result.scenario.tables)]
    return "\n\n".join(tables)


def _table(result: Result, columns: Sequence[str], with_paper: bool) -> str:
    """One table; the paper gives indices of the first two columns."""
    paper = result.scenario.paper if with_paper else {}
    head = _head(result.scenario, columns)
    if paper:
        head[2:2] = ["paper"]
        head[4:4] = ["paper"]
    rows = [head]
    for each in result.scenario.comparisons:
        cells = [_cell(result, each.name, index) for index in columns]
        if paper:
            known = [_paper(index) for index in paper.get(each.name, ())] or ["", ""]
            cells[1:1], cells[3:3] = known[:1], known[1:]
        rows.append([each.name, *cells])
    return "\n".join(_aligned(rows))


def _aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows as lines of columns, the first to the left and the others to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]) for row in rows
    ]


def comparison_table(lines: Sequence[Line]) -> str:
    """Both methods beside each other, as text, a part for each group of joints; "-": not known.

    What is there of MatchedFilter alone: the standard deviation that it gives, whether it keeps it,
    and the motor data that it found.
    """
    head = [
        "",
        *(f"{method} [%]" for method in METHODS),
        "sigma_std [%]",
        "within [%]",
        "D_theta_hat",
        "B_hat",
        "tau_coulomb_hat",
    ]
    rows = [head]
    for line in lines:
        found = line.found[METHODS[1]]
        motor = (found.D_theta, found.B, found.tau_coulomb)
        rows.append(
            [
                f"  {line.joint}, {line.case}{_since(line)}",
                *(f"{line.found[method].msrep:.3g}" for method in METHODS),
                f"{found.sigma_std:.2f}",
                f"{found.inside:.0f}",
                *("-" if math.isnan(value) else f"{value:.4g}" for value in motor),
            ]
        )
    first, *others = _aligned(rows)
    text, group = [first], ""
    for line, row in zip(lines, others, strict=True):
        if line.group != group:
            text += ["", group := line.group]
        text.append(row)
    return "\n".join(text)


def _since(line: Line) -> str:
    return f", after {line.after:g} s" if line.after else ""


def write_comparison(lines: Sequence[Line], seeds: int, path: Path) -> None:
    """Writes a row for every line and method, numbers in full."""
    head = [
        "group",
        "joint",
        "case",
        "method",
        "seeds",
        "judged from [s]",
        "MSREP [%]",
        "sigma_std [%]",
        "within 1.96 sigma_std [%]",
        "D_theta_hat [N.m.s/rad]",
        "B_hat [kg.m2]",
        "tau_coulomb_hat [N.m]",
    ]
    _write(
        path,
        head,
        (
            [line.group, line.joint, line.case, method, seeds, line.after]
            + [None if math.isnan(value) else value for value in vars(line.found[method]).values()]
            for line in lines
            for method in METHODS
        ),
    )


def write_table(result: Result, path: Path) -> None:
    """Writes the indices of each comparison, with half the width of their 95 % interval."""
    _write(path, *_indices(result))


def as_dict(result: Result) -> dict[str, Any]:
    """For JSON: what write_table writes."""
    head, rows = _indices(result)
    table = [dict(zip(head, row, strict=True)) for row in rows]
    return {"scenario": result.scenario.name, "seeds": list(result.seeds), "table": table}


def _indices(result: Result) -> tuple[list[str], list[list[Any]]]:
    """Titles and rows of the table of all indices."""
    columns = [index for each in result.scenario.tables for index in each]
    head = ["estimation", "seeds"]
    for title in (_title(result.scenario, index) for index in columns):
        head += [title, title.replace(" [", " 95 % half width [")]
    head += ["MSE of the paper [(N.m/rad)2]", "MSREP of the paper [%]"]
    rows: list[list[Any]] = []
    for each in result.scenario.comparisons:
        row: list[Any] = [each.name, len(result.seeds)]
        for index in columns:
            row += (None if math.isnan(x) else x for x in _mean(result, each.name, index))
        rows.append([*row, *result.scenario.paper.get(each.name, (None, None))])
    return head, rows


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


def _head(scenario: Scenario, columns: Sequence[str]) -> list[str]:
    """Titles of a table; where all columns are of the same time, that stands in the corner."""
    settled = {index.endswith("_settled") for index in columns}
    if len(settled) > 1:
        return ["", *(_title(scenario, index) for index in columns)]
    time = f"after {scenario.settled:g} s" if settled.pop() else f"all {scenario.duration:g} s"
    return [time, *(_TITLES[index.removesuffix("_settled")] for index in columns)]


def _title(scenario: Scenario, index: str) -> str:
    title = _TITLES[index.removesuffix("_settled")]
    if index.endswith("_settled"):
        title = title.replace(" [", f" after {scenario.settled:g} s [")
    return title


def _mean(result: Result, name: str, index: str) -> tuple[float, float]:
    return mean_interval([getattr(each[name], index) for each in result.indices])


def _cell(result: Result, name: str, index: str) -> str:
    mean, half_width = _mean(result, name, index)
    if math.isnan(mean):
        return "-"
    interval = "" if math.isnan(half_width) else f" +- {_number(half_width, index)}"
    return f"{_number(mean, index)}{interval}"


def _number(value: float, index: str) -> str:
    """Fixed point, but for what is small once the start-up is over."""
    if index.endswith("_settled") and abs(value) < 0.01:
        return f"{value:.1e}"
    return f"{value:.{2 if index.startswith('mse') else 3}f}"


def _paper(value: float) -> str:
    """As many digits as tell it from zero."""
    return f"{value:.2f}" if value >= 0.1 else f"{value:.2g}"


def _write(path: Path, head: list[str], rows: Iterable[Iterable[Any]]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(rows)
