"""The main job: runs of a scenario over seeds, and the mean of their performance indices."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass, replace
from multiprocessing.resource_tracker import ensure_running
from typing import Any

from numpy.typing import NDArray

from sigmahat.cosimulation import Recording, simulate
from sigmahat.metrics import Indices, indices
from sigmahat.nominal import nominal
from sigmahat.scenarios import Scenario, T

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

    workers = min(len(seeds), processes or os.cpu_count() or 1)
    context = multiprocessing.get_context("spawn")
    executor = ProcessPoolExecutor(workers, mp_context=context)
    try:
        with interrupts_for_the_parent_alone():
            first = executor.submit(run, scenario, seeds[0], variants=True)
            others = [executor.submit(_run_indices, scenario, seed) for seed in seeds[1:]]
        futures: list[Future[Any]] = [first, *others]
        for future in as_completed(futures):
            future.result()
            progress(1)
        every = [all_indices(scenario, first.result()), *(future.result() for future in others)]
        return Result(scenario, seeds, first.result(), every)
    finally:
        executor.shutdown(cancel_futures=True)


def run(
    scenario: Scenario,
    seed: int,
    variants: bool = False,
    progress: Progress = lambda steps: None,
) -> Recording:
    """Runs the scenario once; with or without the estimators that only the figures need."""
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


@contextmanager
def interrupts_for_the_parent_alone() -> Iterator[None]:
    """Processes started inside do not hear Ctrl-C, which a terminal sends to them too.

    They inherit the blocked signal. Here it waits until the end of the block, also if it comes to
    another thread, so that no process is left half started.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    waiting: list[int] = []
    main = threading.current_thread() is threading.main_thread()
    if main:
        handler = signal.signal(signal.SIGINT, lambda number, frame: waiting.append(number))
    ensure_running()  # this helper of multiprocessing would lift the block when it starts
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        if main:
            signal.signal(signal.SIGINT, handler)
    if waiting:
        raise KeyboardInterrupt
