"""The FMUs that a sweep needs, and whether two machines or two days have the same."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict

from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.paper.scenarios import scenario
from sigmahat.sweep.plan import Plan


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
