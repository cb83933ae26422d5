"""The main job: runs of a scenario over seeds, and the mean of their performance indices."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from numpy.typing import NDArray

from sigmahat.fmi.master import Recording, simulate
from sigmahat.paper.metrics import Indices, indices
from sigmahat.paper.nominal_awas import nominal
from sigmahat.paper.processes import spread
from sigmahat.paper.scenarios import Scenario, T

Progress = Callable[[int], object]


@dataclass(frozen=True)
class Result:
    """Runs of one scenario."""

    scenario: Scenario
    seeds: Sequence[int]
    recording: Recording
    """Run of the first seed, with the variants that only the figures need."""
    indices: Sequence[dict[str, Indices]]
    """For each seed, by comparison."""


def work(scenario: Scenario, seeds: Sequence[int]) -> int:
    """Length of the job in the units that reproduce() reports: runs, or the steps of a single run.

    seeds must not be empty.
    """
    return len(seeds) if len(seeds) > 1 else scenario.steps


def reproduce(
    scenario: Scenario,
    seeds: Sequence[int],
    processes: int | None = None,
    progress: Progress = lambda done: None,
) -> Result:
    """Runs the scenario once for each seed of the plant's noise.

    seeds      one or more; several are spread over processes, by default one per processor.
               The result does not depend on their number
    progress   called now and then with the amount of work done since the last call, see work()

    Raises what simulate() raises.
    """
    if len(seeds) == 1:
        recording = run(scenario, seeds[0], variants=True, progress=progress)
        return Result(scenario, seeds, recording, [all_indices(scenario, recording)])

    jobs: list[partial[Any]] = [partial(run, scenario, seeds[0], variants=True)]
    jobs += [partial(_run_indices, scenario, seed) for seed in seeds[1:]]
    first, *others = spread(jobs, processes, progress)
    return Result(scenario, seeds, first, [all_indices(scenario, first), *others])


def run(
    scenario: Scenario,
    seed: int,
    variants: bool = False,
    progress: Progress = lambda steps: None,
) -> Recording:
    """Runs the scenario once, with this seed of the plant's noise.

    With variants the estimators that only figures need run too. From time to time progress is
    called with the number of steps made since the last call. Raises what simulate() raises.
    """
    plant = replace(scenario.plant, start={**scenario.plant.start, "noise.seed": seed})
    estimators = {**scenario.estimators, **(scenario.variants if variants else {})}
    return simulate(plant, estimators, T, scenario.steps, progress)


def _run_indices(scenario: Scenario, seed: int) -> dict[str, Indices]:
    return all_indices(scenario, run(scenario, seed))


def all_indices(scenario: Scenario, recording: Recording) -> dict[str, Indices]:
    """The indices of each comparison of the scenario, by its name."""
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


def signal_of(recording: Recording, name: str) -> NDArray[Any]:
    """Returns a signal, shape (N + 1,), by its name as in scenarios.Comparison.

    Raises KeyError if it was not recorded.
    """
    source, _, variable = name.rpartition(".")
    if source == "nominal":
        return nominal(recording)[variable]
    series = recording.plant if source == "plant" else recording.estimators[source]
    return series[variable]
