"""Checks a plan with the FMUs before it starts: they refuse what does not fit at once."""

from __future__ import annotations

from dataclasses import replace

from sigmahat.fmi.instance import Slave
from sigmahat.fmi.master import EstimatorFmu, Plant
from sigmahat.fmi.opened import installed
from sigmahat.runs.signals import PLANT
from sigmahat.sweep.plan import Plan, Run
from sigmahat.sweep.preparation import prepare


def check(plan: Plan) -> None:
    """Lets the FMUs of each scenario see each listed value once, with the first of the others.

    Raises ValueError for a name or value that does not fit, FmuError if an FMU refuses a value.
    """
    for run in plan.samples():
        # What is drawn may leave its range now and then: that run fails, not the sweep.
        listed = {name: run.parameters[name] for name in plan.listed}
        starts = _models(replace(run, parameters=listed))
        for name, model in _models(run).items():
            fmu = installed(model.fmu)
            for parameter, value in model.start.items():
                fmu.variable(parameter, "parameter")
                fmu.number(parameter, value)
            with Slave(fmu, name) as slave:
                slave.initialize(starts[name].start)


def _models(run: Run) -> dict[str, Plant | EstimatorFmu]:
    scenario = prepare(run)
    return {PLANT: scenario.plant, **scenario.estimators}
