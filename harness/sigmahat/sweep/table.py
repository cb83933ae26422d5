"""The table of a sweep: a row for each run and comparison, and the mean over the seeds of each."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet

from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.fmi.instance import Fmu, Value
from sigmahat.paper.metrics import Indices, mean_interval
from sigmahat.paper.scenarios import SCENARIOS, Scenario
from sigmahat.sweep.plan import Plan, Run, fmu_names, prepare
from sigmahat.sweep.workers import Outcome

INDICES = {
    f.name: f"{f.name} [{'(N.m/rad)2' if f.name.split('_')[0] == 'mse' else '%'}]"
    for f in fields(Indices)
}
"""Titles of the columns of indices, by field of sigmahat.metrics.Indices."""

ERROR = "error of "
"""How the title of a column with the error of a parameter begins."""

_NOMINAL = {"model.k_s": "spring.k_s", "model.r_0": "spring.r_0", "model.b": "spring.b"}
_METADATA = b"sigmahat.sweep"


@dataclass(frozen=True)
class SweepTable:
    """Rows of a sweep and what they mean."""

    table: pa.Table
    listed: Sequence[str]
    """Columns of the parameters whose values are listed."""
    drawn: Sequence[str]
    """Columns of the parameters that are drawn."""

    @property
    def errors(self) -> list[str]:
        """Columns with the error of a parameter of the estimator, in % of that of the plant."""
        return [name for name in self.table.column_names if name.startswith(ERROR)]


@dataclass(frozen=True)
class Mean:
    """Indices over the seeds of one scenario, one combination of listed values, one comparison."""

    scenario: str
    listed: Mapping[str, Value]
    estimation: str
    runs: int
    failed: int
    indices: Mapping[str, tuple[float, float]]
    """Mean and half width of its 95 % interval, by field of Indices; over what did not fail."""


def build(plan: Plan, outcomes: Mapping[int, Outcome]) -> SweepTable:
    """The table of a complete sweep, rows in the order of the plan."""
    names = list(plan.parameters)
    columns: dict[str, list[Any]] = {}
    with ExitStack() as stack:
        fmus = {
            name: stack.enter_context(Fmu(installed_fmu(name)))
            for name in fmu_names(plan.scenarios)
        }
        titles = {name: _title(plan, name, fmus) for name in names}
        for run in plan.runs():
            outcome = outcomes[run.number]
            scenario = prepare(run)
            errors = _errors(run, scenario, fmus)
            for each in scenario.comparisons:
                row: dict[str, Any] = {
                    "run": run.number,
                    "scenario": run.scenario,
                    "seed": run.seed,
                    **{titles[name]: run.parameters[name] for name in names},
                    **errors[each.estimate.rpartition(".")[0]],
                    "estimation": each.name,
                    **dict.fromkeys(INDICES.values(), math.nan),
                    **_indices(outcome.indices.get(each.name)),
                    "failure": outcome.failure,
                }
                for title, value in row.items():
                    columns.setdefault(title, []).append(value)
    arrays = {title: _array(title, column) for title, column in columns.items()}
    drawn = [titles[name] for name in names if name not in plan.listed]
    listed = [titles[name] for name in plan.listed]
    meaning = json.dumps({"listed": listed, "drawn": drawn}).encode()
    table = pa.table(arrays).replace_schema_metadata({_METADATA: meaning})
    return SweepTable(table, listed, drawn)


def write(sweep: SweepTable, path: Path) -> None:
    """Writes Parquet; the same table gives the same bytes."""
    pa.parquet.write_table(sweep.table, path)


def read(path: Path) -> SweepTable:
    """Reads what write() wrote. Raises ValueError for another file, OSError if there is none."""
    try:
        table = pa.parquet.read_table(path)
        meaning = json.loads(table.schema.metadata[_METADATA])
    except (pa.ArrowInvalid, KeyError, TypeError, OSError) as error:
        if not path.exists():
            raise
        raise ValueError(f"{path}: not the table of a sweep; run the sweep again") from error
    return SweepTable(table, meaning["listed"], meaning["drawn"])


def means(sweep: SweepTable) -> list[Mean]:
    """The mean of each group, in the order of the table."""
    groups: dict[tuple[Any, ...], list[dict[str, Any]]] = {}
    for row in sweep.table.to_pylist():
        key = (row["scenario"], *(row[name] for name in sweep.listed), row["estimation"])
        groups.setdefault(key, []).append(row)
    found = []
    for (scenario, *listed, estimation), rows in groups.items():
        good = [row for row in rows if row["failure"] is None]
        found.append(
            Mean(
                scenario,
                dict(zip(sweep.listed, listed, strict=True)),
                estimation,
                len(rows),
                len(rows) - len(good),
                {
                    field: mean_interval([row[title] for row in good])
                    if good
                    else (math.nan, math.nan)
                    for field, title in INDICES.items()
                },
            )
        )
    return found


def _title(plan: Plan, full: str, fmus: Mapping[str, Fmu]) -> str:
    """Name of a parameter with its unit, "plant.motor.B [kg.m2]"."""
    owner, _, name = full.partition(".")
    base = SCENARIOS[plan.scenarios[0]]
    fmu = base.plant.fmu if owner == "plant" else next(iter(base.estimators.values())).fmu
    unit = fmus[fmu].variable(name).unit
    return f"{full} [{unit}]" if unit else full


def _errors(run: Run, scenario: Scenario, fmus: Mapping[str, Fmu]) -> dict[str, dict[str, float]]:
    """For each source of an estimate, the errors of the parameters swept that a plant has too."""
    swept = {name.partition(".")[2] for name in run.parameters}
    plant = fmus[scenario.plant.fmu].parameters(scenario.plant.start)
    found: dict[str, dict[str, float]] = {"plant": {}, "nominal": {}}
    for modality, estimator in scenario.estimators.items():
        own = fmus[estimator.fmu].parameters(estimator.start)
        found[modality] = {}
        for name in own:
            true = plant.get(_NOMINAL.get(name, name))
            if swept & {name, _NOMINAL.get(name, name)} and true:
                error = (float(own[name]) / float(true) - 1) * 100
                found[modality][f"{ERROR}{name} [%]"] = error
    return found


def _indices(values: Sequence[float] | None) -> dict[str, float]:
    if values is None:
        return {}
    return {INDICES[f.name]: x for f, x in zip(fields(Indices), values, strict=True)}


def _array(title: str, column: Sequence[Any]) -> pa.Array:
    if title == "failure":
        return pa.array(column, pa.string())
    kinds = {type(value) for value in column}
    if kinds == {int, float}:
        return pa.array([float(value) for value in column])
    return pa.array(column)
