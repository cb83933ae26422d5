"""From the outcomes of a complete sweep to its table."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import astuple
from typing import Any

from sigmahat.fmi.instance import Value, installed
from sigmahat.runs.metrics import INDICES, Indices
from sigmahat.runs.scenario import PLANT, source_and_variable
from sigmahat.sweep.plan import Outcome, Plan
from sigmahat.sweep.preparation import ALL, models, parameters_by_owner, reduced
from sigmahat.sweep.table import (
    ESTIMATION,
    FAILURE,
    RUN,
    SCENARIO,
    SEED,
    Column,
    ParameterColumn,
    Role,
    SweepTable,
    from_columns,
    name_in_the_plant,
)

_FAILED = Indices(*[math.nan] * len(INDICES))


def build(plan: Plan, outcomes: Mapping[int, Outcome]) -> SweepTable:
    """The table of a complete sweep, rows in the order of the plan.

    outcomes  by number of the run
    """
    scenarios = {name: reduced(name, plan.modalities) for name in plan.scenarios}
    usual = {
        name: {o: installed(m.fmu).parameters(m.start) for o, m in models(each).items()}
        for name, each in scenarios.items()
    }
    parameters: dict[str, ParameterColumn] = {}
    first = models(scenarios[plan.scenarios[0]])
    for full in plan.parameters:
        owner, _, name = full.partition(".")
        model = first[next(each for each in first if each != PLANT) if owner == ALL else owner]
        role = Role.LISTED if full in plan.listed else Role.DRAWN
        unit = installed(model.fmu).variable(name).unit
        parameters[full] = ParameterColumn(role, owner, name, unit)
    swept = {name_in_the_plant(each.parameter) for each in parameters.values()}
    errors = dict.fromkeys(
        ParameterColumn(Role.ERROR, ALL, name, "%")
        for own in usual.values()
        for owner, values in own.items()
        for name in values
        if owner != PLANT and name_in_the_plant(name) in swept & own[PLANT].keys()
    )
    order: list[Column] = [RUN, SCENARIO, SEED, *parameters.values(), *errors]
    columns: dict[Column, list[Any]] = {
        column: [] for column in (*order, ESTIMATION, *INDICES.values(), FAILURE)
    }
    for run in plan.runs:
        outcome = outcomes[run.number]
        chosen = parameters_by_owner(run.parameters, scenarios[run.scenario])
        given = {o: {**own, **chosen[o]} for o, own in usual[run.scenario].items()}
        for comparison in scenarios[run.scenario].comparisons:
            estimator, _ = source_and_variable(comparison.estimate)
            indices = astuple(outcome.indices.get(comparison.name, _FAILED))
            row: dict[Column, Any] = {
                RUN: run.number,
                SCENARIO: run.scenario,
                SEED: run.seed,
                **{column: run.parameters[name] for name, column in parameters.items()},
                **{each: _error(each.parameter, given[estimator], given[PLANT]) for each in errors},
                ESTIMATION: comparison.name,
                **dict(zip(INDICES.values(), indices, strict=True)),
                FAILURE: outcome.failure,
            }
            for column, values in columns.items():
                values.append(row[column])
    return from_columns(columns)


def _error(name: str, estimator: Mapping[str, Value], plant: Mapping[str, Value]) -> float:
    """Error of a parameter, relative to the plant [%]; nan if the plant has 0 or no such value."""
    true = float(plant.get(name_in_the_plant(name), 0.0))
    return (float(estimator[name]) / true - 1) * 100 if true and name in estimator else math.nan
