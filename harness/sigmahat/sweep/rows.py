"""From the outcomes of a complete sweep to its table."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import astuple
from typing import Any

from sigmahat.fmi.instance import Fmu, Value
from sigmahat.fmi.opened import installed
from sigmahat.runs.metrics import INDICES, Indices
from sigmahat.runs.scenario import Scenario
from sigmahat.runs.signals import PLANT, source_and_variable
from sigmahat.sweep.plan import Outcome, Plan
from sigmahat.sweep.preparation import ALL, fmu_names, parameters_by_owner, reduced
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


class ParameterErrors:
    """Errors of the parameters of one scenario."""

    def __init__(self, swept: Iterable[str], scenario: Scenario, fmus: Mapping[str, Fmu]) -> None:
        """swept: the parameters of the sweep by name with owner; fmus: by name."""
        self._scenario = scenario
        self._plant = fmus[scenario.plant.fmu].parameters(scenario.plant.start)
        self._estimators = {
            name: fmus[each.fmu].parameters(each.start)
            for name, each in scenario.estimators.items()
        }
        names = {name_in_the_plant(full.partition(".")[2]) for full in swept}
        self.columns = [
            ParameterColumn(Role.ERROR, ALL, name, "%")
            for name in dict.fromkeys(name for own in self._estimators.values() for name in own)
            if name_in_the_plant(name) in names & self._plant.keys()
        ]
        """The parameters of which there is an error."""

    def of(self, parameters: Mapping[str, Value]) -> dict[str, dict[Column, float]]:
        """For each estimator the errors in a run with these parameters [%].

        Relative to the parameter of the plant; nan where that is 0.
        """
        own = parameters_by_owner(parameters, self._scenario)
        plant = {**self._plant, **own[PLANT]}
        return {
            modality: {
                column: _error(
                    {**values, **own[modality]}[column.parameter],
                    plant[name_in_the_plant(column.parameter)],
                )
                for column in self.columns
            }
            for modality, values in self._estimators.items()
        }


def _error(value: Value, true: Value) -> float:
    return (float(value) / float(true) - 1) * 100 if float(true) else math.nan


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
