"""Errors of the parameters of a sweep: those that an estimator and the plant both have."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from sigmahat.fmi.instance import Fmu, Value
from sigmahat.runs.scenario import Scenario
from sigmahat.runs.signals import PLANT
from sigmahat.sweep.columns import Column, ParameterColumn, Role, name_in_the_plant
from sigmahat.sweep.preparation import ALL, parameters_by_owner


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
