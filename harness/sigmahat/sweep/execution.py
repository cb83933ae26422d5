"""One run of a sweep, as a process or a machine of a cluster does it."""

from __future__ import annotations

from functools import lru_cache

from sigmahat.fmi.instance import FmuError
from sigmahat.runs.engine import indices_by_comparison, measured
from sigmahat.runs.pool import WorkerError
from sigmahat.sweep.fmus import fmu_digest
from sigmahat.sweep.plan import Outcome, Run
from sigmahat.sweep.preparation import prepare


def execute(run: Run, fmus: str) -> Outcome:
    """Does a run. Raises WorkerError if the FMUs here are not those of this digest."""
    if _digest(run.scenario) != fmus:
        raise WorkerError(
            "a worker has other FMUs than this machine; install the same sigmahat on both"
        )
    try:
        indices = measured(prepare(run), run.seed, indices_by_comparison)
    except (FmuError, ValueError) as error:
        return Outcome(run.number, {}, " ".join(str(error).split()))
    return Outcome(run.number, indices, None)


@lru_cache
def _digest(scenario: str) -> str:
    return fmu_digest([scenario])
