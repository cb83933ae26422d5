"""Runs a scenario once, with one seed, and judges its estimates by the indices of the paper."""

from dataclasses import replace

from sigmahat.experiments.metrics import Indices, indices
from sigmahat.experiments.pool import Progress
from sigmahat.experiments.scenario import Scenario, signal_of
from sigmahat.fmi.instance import named
from sigmahat.fmi.master import Recording, simulate
from sigmahat.fmi.model import Value

SEED = "noise.seed"  # parameter of every plant
SAMPLE_PERIOD = "noise.samplePeriod"  # parameter of the plants with noise that this version makes


def run(
    scenario: Scenario,
    seed: int,
    variants: bool = False,
    progress: Progress = lambda steps: None,
) -> Recording:
    """Runs the scenario once, with this seed of the plant's noise.

    The noise is drawn at the sampling times of the scenario, unless its plant has another period.
    With variants the estimators that only figures need run too. From time to time progress is
    called with the number of steps made since the last call. Raises what simulate() raises.
    """
    start: dict[str, Value] = {**scenario.plant.start, SEED: seed}
    if SAMPLE_PERIOD in named(str(scenario.plant.fmu)).variables:
        start = {SAMPLE_PERIOD: scenario.T, **start}
    plant = replace(scenario.plant, start=start)
    estimators = {**scenario.estimators, **(scenario.variants if variants else {})}
    return simulate(plant, estimators, scenario.T, scenario.steps, progress)


def indices_by_comparison(scenario: Scenario, recording: Recording) -> dict[str, Indices]:
    """Computes the performance indices of each comparison in a scenario, by name."""
    return {
        comparison.name: indices(
            recording.t,
            signal_of(recording, comparison.reference),
            signal_of(recording, comparison.estimate),
            signal_of(recording, comparison.relative_to or comparison.reference),
            scenario.settled,
        )
        for comparison in scenario.comparisons
    }
