"""Runs of scenarios over seeds: a single run, or many in parallel, and the evaluation of each run.

A command makes its jobs from `run` and `measured`, and gives them to `run_all`.
"""

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import replace
from typing import TypeVar

from sigmahat.experiments.metrics import Indices, indices
from sigmahat.experiments.pool import spread
from sigmahat.experiments.scenario import Scenario, signal_of
from sigmahat.fmi.instance import named
from sigmahat.fmi.master import Recording, simulate
from sigmahat.fmi.model import Value

Progress = Callable[[int], object]
Result = TypeVar("Result")
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


def measured(
    scenario: Scenario, seed: int, measure: Callable[[Scenario, Recording], Result]
) -> Result:
    """Runs the scenario once and returns what `measure` computes of it, not the recording.

    Raises what simulate() and measure raise.
    """
    return measure(scenario, run(scenario, seed))


def run_all(
    jobs: Sequence[Callable[[], Result]],
    processes: int | None = None,
    progress: Progress = lambda done: None,
) -> list[Result]:
    """Returns the results of all jobs in order; the first exception of a job ends all jobs.

    jobs       partial objects of run or measured: other processes receive them
    processes  largest number of processes, by default one per processor; no effect on results
    progress   called with 1 for every job that is done
    """
    results: dict[int, Result] = {}
    with closing(spread(jobs, processes)) as done:
        for place, result in done:
            results[place] = result
            progress(1)
    return [results[place] for place in range(len(jobs))]


def indices_by_comparison(scenario: Scenario, recording: Recording) -> dict[str, Indices]:
    """Computes the performance indices of each comparison in a scenario, by name."""
    return {
        each.name: indices(
            recording.t,
            signal_of(recording, each.reference),
            signal_of(recording, each.estimate),
            signal_of(recording, each.relative_to or each.reference),
            scenario.settled,
        )
        for each in scenario.comparisons
    }
