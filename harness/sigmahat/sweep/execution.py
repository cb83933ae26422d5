"""One run of a sweep, as a process or a machine of a cluster does it, and the FMUs it needs."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict
from functools import lru_cache

from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.fmi.instance import FmuError
from sigmahat.paper.scenarios import scenario
from sigmahat.runs.engine import indices_by_comparison, measured
from sigmahat.runs.pool import WorkerError
from sigmahat.sweep.plan import Outcome, Plan, Run
from sigmahat.sweep.preparation import prepare


def fmu_names(scenarios: Sequence[str]) -> list[str]:
    """Names of the FMUs of some scenarios, sorted, each once."""
    chosen = [scenario(name) for name in scenarios]
    estimators = {e.fmu for each in chosen for e in each.estimators.values()}
    return sorted(estimators | {each.plant.fmu for each in chosen})


def fmu_digest(scenarios: Sequence[str]) -> str:
    """Of the FMUs of some scenarios, as they are installed here: 32 hexadecimal digits."""
    text = hashlib.sha256()
    for name in fmu_names(scenarios):
        text.update(installed_fmu(name).read_bytes())
    return text.hexdigest()[:32]


def sweep_digest(plan: Plan) -> str:
    """Differs between sweeps that would not give the same numbers: 32 hexadecimal digits."""
    text = hashlib.sha256(fmu_digest(plan.scenarios).encode())
    for run in plan.runs:
        text.update(json.dumps(asdict(run)).encode())
    return text.hexdigest()[:32]


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
