"""Prepares and executes one run of a sweep: its scenario with the parameters of the run."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache

from sigmahat.experiments.engine import SEED, indices_by_comparison, measured
from sigmahat.experiments.pool import WorkerError
from sigmahat.experiments.scenario import PLANT, Scenario, to_record
from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.fmi.instance import Slave, installed
from sigmahat.fmi.master import EstimatorFmu, Plant
from sigmahat.fmi.model import FmuError, Value
from sigmahat.fmi.unknown_name import unknown
from sigmahat.paper.scenarios import scenario
from sigmahat.sweep.plan import Outcome, Plan, Run

ALL = "estimator"  # owner of a parameter of all estimators


def prepare(run: Run) -> Scenario:
    """The scenario of a run with its parameters; the engine sets the seed.

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
    """A scenario with the estimators of these modalities, or with all estimators of comparisons.

    Only variables of the comparisons are recorded. Raises ValueError for a name that does not fit.
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
        raise ValueError(f"{base.name} needs more modalities than {', '.join(chosen)}")
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
    # A value for one estimator replaces a value for all estimators.
    for full in sorted(parameters, key=lambda full: not full.startswith(f"{ALL}.")):
        owner, _, name = full.partition(".")
        if owner != ALL and owner not in own:
            raise ValueError(unknown("owner of a parameter", owner, [ALL, *own]))
        if (owner, name) == (PLANT, SEED):
            raise ValueError(f"{full}: set the seeds with --seeds instead")
        for each in chosen.estimators if owner == ALL else (owner,):
            own[each][name] = parameters[full]
    return own


def check(plan: Plan) -> None:
    """Initialises the FMUs of each scenario with each listed value, and first other values.

    Raises ValueError for a name or value that does not fit, FmuError if an FMU refuses a value.
    """
    for run in plan.samples():
        # A drawn value may be out of range in some runs: then the run fails, not the sweep.
        listed = {name: run.parameters[name] for name in plan.listed}
        starts = models(prepare(replace(run, parameters=listed)))
        for name, model in models(prepare(run)).items():
            fmu = installed(model.fmu)
            for parameter, value in model.start.items():
                fmu.variable(parameter, "parameter")
                fmu.number(parameter, value)
            with Slave(fmu, name) as slave:
                slave.initialize(starts[name].start)


def models(scenario: Scenario) -> dict[str, Plant | EstimatorFmu]:
    """Returns plant and estimators of a scenario, by the prefixes of their parameters."""
    return {PLANT: scenario.plant, **scenario.estimators}


def identity(run: Run) -> str:
    """Returns a text that identifies the result of a run, independent of the run number."""
    fmus = _fmu_digest(run.scenario)
    every = [fmus, run.scenario, run.modalities, run.seed, run.parameters]
    return json.dumps(every, sort_keys=True)


@lru_cache
def _fmu_digest(name: str) -> str:
    """Computes a digest of the installed FMUs of a scenario: 32 hexadecimal digits."""
    text = hashlib.sha256()
    for fmu in scenario(name).fmus:
        text.update(installed_fmu(fmu).read_bytes())
    return text.hexdigest()[:32]


def execute(run: Run, known_as: str) -> Outcome:
    """Does a run that has this identity. Raises WorkerError if the FMUs here are different."""
    if identity(run) != known_as:
        raise WorkerError(
            "the FMUs of a worker differ from those here; install the same sigmahat on both"
        )
    try:
        indices = measured(prepare(run), run.seed, indices_by_comparison)
    except (FmuError, ValueError) as error:
        return Outcome({}, " ".join(str(error).split()))
    return Outcome(indices, None)
