"""The table that `sigmahat reproduce` prints: performance indices, and those of the paper."""

from __future__ import annotations

import math
from collections.abc import Sequence

from sigmahat.files.tables import aligned
from sigmahat.paper.reproduction import Result
from sigmahat.runs.metrics import INDICES, Index
from sigmahat.runs.scenario import Scenario


def conditions(result: Result) -> str:
    """The conditions of the runs in one line."""
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


def table(result: Result) -> str:
    """The indices of each comparison and those of the paper, as text; "-": not defined."""
    tables = [
        _table(result, [INDICES[field] for field in fields], with_paper=i == 0)
        for i, fields in enumerate(result.scenario.tables)
    ]
    return "\n\n".join(tables)


def _table(result: Result, columns: Sequence[Index], with_paper: bool) -> str:
    """One table; the paper gives indices of the first two columns."""
    paper = result.scenario.paper if with_paper else {}
    rows = [_head(result.scenario, columns)]
    rows += [
        [each.name, *(_cell(result, each.name, index) for index in columns)]
        for each in result.scenario.comparisons
    ]
    if paper:
        beside = [("paper", "paper")]
        beside += [_paper(paper.get(each.name)) for each in result.scenario.comparisons]
        for row, (first, second) in zip(rows, beside, strict=True):
            row[2:2], row[4:4] = [first], [second]
    return "\n".join(aligned(rows))


def _head(scenario: Scenario, columns: Sequence[Index]) -> list[str]:
    """Titles of a table; where all columns are of the same time, that stands in the corner."""
    settled = {index.settled for index in columns}
    if len(settled) > 1:
        return ["", *(index.title(index.when(scenario.settled)) for index in columns)]
    time = columns[0].when(scenario.settled) or f"all {scenario.duration:g} s"
    return [time, *(index.title() for index in columns)]


def _cell(result: Result, comparison: str, index: Index) -> str:
    mean, half_width = result.mean(comparison, index.field)
    if math.isnan(mean):
        return "-"
    interval = "" if math.isnan(half_width) else f" +- {_number(half_width, index)}"
    return f"{_number(mean, index)}{interval}"


def _number(value: float, index: Index) -> str:
    """Fixed point, except for what is small once the start-up is over."""
    if index.settled and abs(value) < 0.01:
        return f"{value:.1e}"
    return f"{value:.3f}" if index.unit == "%" else f"{value:.2f}"


def _paper(indices: tuple[float, float] | None) -> tuple[str, str]:
    """Cells for the indices of the paper, with as many digits as show that they are not zero."""
    if indices is None:
        return "", ""
    mse, msrep = (f"{value:.2f}" if value >= 0.1 else f"{value:.2g}" for value in indices)
    return mse, msrep
