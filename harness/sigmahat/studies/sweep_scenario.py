"""The scenario of one run of a sweep, with the parameters of the run."""

from collections.abc import Mapping
from dataclasses import replace

from sigmahat.experiments.scenario import PLANT, Scenario, to_record
from sigmahat.experiments.simulation import SEED
from sigmahat.fmi.master import EstimatorFmu, Plant
from sigmahat.fmi.model import Value
from sigmahat.fmi.unknown_name import unknown
from sigmahat.paper.scenarios import scenario
from sigmahat.studies.sweep_grid import Run

ALL = "estimator"  # owner of a parameter of all estimators


def prepare(run: Run) -> Scenario:
    """The scenario of a run with its parameters, but without its seed.

    Raises ValueError for a name that does not fit the scenario.
    """
    chosen = reduced(run.scenario, run.modalities)
    parameters = parameters_by_owner(run.parameters, chosen)
    return replace(
        chosen,
        plant=replace(chosen.plant, start={**chosen.plant.start, **parameters[PLANT]}),
        estimators={
            name: replace(estimator, start={**estimator.start, **parameters[name]})
            for name, estimator in chosen.estimators.items()
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
            name: replace(estimator, record=sorted(signals[name]))
            for name, estimator in base.estimators.items()
            if name in chosen
        },
    )


def parameters_by_owner(
    parameters: Mapping[str, Value], chosen: Scenario
) -> dict[str, dict[str, Value]]:
    """The parameters of the plant and of each estimator of a scenario.

    Raises ValueError for an owner that the scenario does not have, and for the seed.
    """
    by_owner: dict[str, dict[str, Value]] = {name: {} for name in (PLANT, *chosen.estimators)}
    # A value for one estimator replaces a value for all estimators.
    for full in sorted(parameters, key=lambda full: not full.startswith(f"{ALL}.")):
        owner, _, name = full.partition(".")
        if owner != ALL and owner not in by_owner:
            raise ValueError(unknown("owner of a parameter", owner, [ALL, *by_owner]))
        if (owner, name) == (PLANT, SEED):
            raise ValueError(f"{full}: set the seeds with --seeds instead")
        for model in chosen.estimators if owner == ALL else (owner,):
            by_owner[model][name] = parameters[full]
    return by_owner


def models(scenario: Scenario) -> dict[str, Plant | EstimatorFmu]:
    """Returns plant and estimators of a scenario, by the prefixes of their parameters."""
    return {PLANT: scenario.plant, **scenario.estimators}
