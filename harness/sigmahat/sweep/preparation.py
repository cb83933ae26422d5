"""The scenario of a run of a sweep: only what is compared, with the parameters of the run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from sigmahat.fmi.instance import Slave, Value
from sigmahat.fmi.master import EstimatorFmu, Plant
from sigmahat.fmi.opened import installed
from sigmahat.fmi.unknown_name import unknown
from sigmahat.paper.scenarios import scenario
from sigmahat.runs.engine import SEED
from sigmahat.runs.scenario import Scenario
from sigmahat.runs.signals import PLANT, to_record
from sigmahat.sweep.plan import Plan, Run

ALL = "estimator"
"""Owner of a parameter of all estimators."""


def prepare(run: Run) -> Scenario:
    """The scenario of a run with its parameters; the seed is left to the engine.

    Raises ValueError for a name that does not fit the scenario.
    """
    chosen = reduced(run.scenario, run.modalities)
    own = parameters_by_owner(run.parameters, chosen)
    return replace(
        chosen,
        plant=replace(chosen.plant, start={**chosen.plant.start, **own[PLANT]}),
        estimators={
            name: replace(each, start={**each.start, **own[name]})
            for name, each in chosen.estimators.items()
        },
    )


def reduced(name: str, modalities: tuple[str, ...]) -> Scenario:
    """A scenario with the estimators of these modalities, or of all that it compares.

    Recorded is only what their comparisons need. Raises ValueError for a name that does not fit.
    """
    base = scenario(name)
    needed = to_record(base.comparisons)
    compared = [name for name in base.estimators if name in needed]
    for modality in modalities:
        if modality not in compared:
            raise ValueError(unknown(f"modality of {base.name}", modality, compared))
    chosen = modalities or tuple(compared)
    comparisons = [c for c in base.comparisons if set(to_record([c])) <= {PLANT, *chosen}]
    if not comparisons:
        raise ValueError(f"{base.name} compares nothing with {', '.join(chosen)} alone")
    signals = to_record(comparisons)
    return replace(
        base,
        comparisons=comparisons,
        plant=replace(base.plant, record=sorted(signals[PLANT])),
        estimators={
            name: replace(each, record=sorted(signals[name]))
            for name, each in base.estimators.items()
            if name in chosen
        },
    )


def parameters_by_owner(
    parameters: Mapping[str, Value], chosen: Scenario
) -> dict[str, dict[str, Value]]:
    """The parameters of the plant and of each estimator of a scenario.

    Raises ValueError for an owner that the scenario does not have, and for the seed.
    """
    own: dict[str, dict[str, Value]] = {name: {} for name in (PLANT, *chosen.estimators)}
    # What is set for all estimators gives way to what is set for one.
    for full in sorted(parameters, key=lambda full: not full.startswith(f"{ALL}.")):
        owner, _, name = full.partition(".")
        if owner != ALL and owner not in own:
            raise ValueError(unknown("owner of a parameter", owner, [ALL, *own]))
        if (owner, name) == (PLANT, SEED):
            raise ValueError(f"{full}: the seeds are those of --seeds")
        for each in chosen.estimators if owner == ALL else (owner,):
            own[each][name] = parameters[full]
    return own


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
