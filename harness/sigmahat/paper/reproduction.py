"""The job of `sigmahat reproduce`: runs of a scenario over seeds, and their performance indices."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from sigmahat.fmi.master import Recording
from sigmahat.runs.engine import Progress, indices_by_comparison, measured, run, run_all
from sigmahat.runs.metrics import Indices, mean_interval
from sigmahat.runs.scenario import Scenario


@dataclass(frozen=True)
class Result:
    """Runs of one scenario."""

    scenario: Scenario
    seeds: Sequence[int]
    recording: Recording
    """Run of the first seed, with the variants that only the figures need."""
    indices: Sequence[dict[str, Indices]]
    """Indices for each seed, by comparison."""

    def mean(self, comparison: str, field: str) -> tuple[float, float]:
        """An index over the seeds: its mean, and half the width of the 95 % interval."""
        return mean_interval([getattr(each[comparison], field) for each in self.indices])


def progress_length(scenario: Scenario, seeds: Sequence[int]) -> int:
    """Total of the progress of reproduce(): runs, or the steps of a single run.

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
               The result does not depend on the number of processes
    progress   called now and then with what was done since the last call, see progress_length()

    Raises what simulate() raises, and WorkerError if a process was ended from outside.
    """
    if len(seeds) == 1:
        recording = run(scenario, seeds[0], variants=True, progress=progress)
        return Result(scenario, seeds, recording, [indices_by_comparison(scenario, recording)])

    jobs: list[Callable[[], Any]] = [partial(run, scenario, seeds[0], variants=True)]
    jobs += [partial(measured, scenario, seed, indices_by_comparison) for seed in seeds[1:]]
    first, *others = run_all(jobs, processes, progress)
    return Result(scenario, seeds, first, [indices_by_comparison(scenario, first), *others])
