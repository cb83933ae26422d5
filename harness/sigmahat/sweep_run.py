"""One run of a sweep, in whatever process or on whatever machine."""

from __future__ import annotations

from dataclasses import astuple, dataclass
from functools import lru_cache

from sigmahat.cosimulation import simulate
from sigmahat.reproduce import all_indices
from sigmahat.scenarios import T
from sigmahat.slave import FmuError
from sigmahat.sweep_plan import Run, fmu_digest, prepare


class WorkerError(RuntimeError):
    """A worker cannot do runs of this sweep."""


@dataclass(frozen=True)
class Outcome:
    """What came out of a run."""

    number: int
    """Of the run."""
    indices: dict[str, tuple[float, ...]]
    """Fields of sigmahat.metrics.Indices by comparison; empty if the run failed."""
    failure: str | None
    """Why it failed: an FMU refused a value, or an estimate is not finite."""


def execute(run: Run, fmus: str) -> Outcome:
    """Does a run. Raises WorkerError if the FMUs here are not those of this digest."""
    if _digest(run.scenario) != fmus:
        raise WorkerError(
            "a worker has other FMUs than this machine; install the same sigmahat on both"
        )
    try:
        scenario = prepare(run)
        recording = simulate(scenario.plant, scenario.estimators, T, scenario.steps)
        found = all_indices(scenario, recording)
    except (FmuError, ValueError) as error:
        return Outcome(run.number, {}, " ".join(str(error).split()))
    return Outcome(run.number, {name: astuple(each) for name, each in found.items()}, None)


@lru_cache
def _digest(scenario: str) -> str:
    return fmu_digest([scenario])
