"""From the outcomes of a complete sweep to its table."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import astuple
from typing import Any

from sigmahat.fmi.instance import Fmu
from sigmahat.fmi.opened import installed
from sigmahat.runs.metrics import INDICES, Indices
from sigmahat.runs.scenario import Scenario
from sigmahat.runs.signals import PLANT, source_and_variable
from sigmahat.sweep.columns import Column, ParameterColumn, Role
from sigmahat.sweep.fmus import fmu_names
from sigmahat.sweep.parameter_errors import ParameterErrors
from sigmahat.sweep.plan import Outcome, Plan
from sigmahat.sweep.preparation import reduced
from sigmahat.sweep.table import ESTIMATION, FAILURE, RUN, SCENARIO, SEED, SweepTable, from_columns

_FAILED = Indices(*[math.nan] * len(INDICES))


def build(plan: Plan, outcomes: Mapping[int, Outcome]) -> SweepTable:
    """The table of a complete sweep, rows in the order of the plan.

    outcomes  by number of the run
    """
    scenarios = {name: reduced(name, plan.modalities) for name in plan.scenarios}
    fmus = {name: installed(name) for name in fmu_names(plan.scenarios)}
    parameters = _parameter_columns(plan, scenarios[plan.scenarios[0]], fmus)
    errors = {
        name: ParameterErrors(plan.parameters, each, fmus) for name, each in scenarios.items()
    }
    error_columns = dict.fromkeys(column for each in errors.values() for column in each.columns)
    order: list[Column] = [RUN, SCENARIO, SEED, *parameters.values(), *error_columns]
    columns: dict[Column, list[Any]] = {
        column: [] for column in (*order, ESTIMATION, *INDICES.values(), FAILURE)
    }
    for run in plan.runs:
        outcome = outcomes[run.number]
        errors_of_run = errors[run.scenario].of(run.parameters)
        for comparison in scenarios[run.scenario].comparisons:
            estimator, _ = source_and_variable(comparison.estimate)
            indices = astuple(outcome.indices.get(comparison.name, _FAILED))
            row: dict[Column, Any] = {
                RUN: run.number,
                SCENARIO: run.scenario,
                SEED: run.seed,
                **{column: run.parameters[name] for name, column in parameters.items()},
                **dict.fromkeys(error_columns, math.nan),
                **errors_of_run[estimator],
                ESTIMATION: comparison.name,
                **dict(zip(INDICES.values(), indices, strict=True)),
                FAILURE: outcome.failure,
            }
            for column, values in columns.items():
                values.append(row[column])
    return from_columns(columns)


def _parameter_columns(
    plan: Plan, scenario: Scenario, fmus: Mapping[str, Fmu]
) -> dict[str, ParameterColumn]:
    """The columns of the parameters of a plan, by name with owner."""
    columns = {}
    for full in plan.parameters:
        owner, _, name = full.partition(".")
        model = scenario.plant if owner == PLANT else next(iter(scenario.estimators.values()))
        role = Role.LISTED if full in plan.listed else Role.DRAWN
        columns[full] = ParameterColumn(role, owner, name, fmus[model.fmu].variable(name).unit)
    return columns
