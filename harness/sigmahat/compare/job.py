"""The job of `sigmahat compare`: every joint with every seed, as rows of a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from sigmahat.compare.conditions import METHODS, Case, Joint, comparison_name
from sigmahat.compare.performance import Performance, mean_performance, performances
from sigmahat.runs.engine import Progress, measured, run_all
from sigmahat.runs.metrics import INDICES, Index
from sigmahat.runs.scenario import Scenario


@dataclass(frozen=True)
class Row:
    """One stiffness of a joint in one case, judged by one index."""

    joint: Joint
    case: Case
    part: str
    """An element of Joint.parts."""
    index: Index
    performance: Mapping[str, Performance]
    """Mean performance over the seeds, by method."""

    @property
    def judged_from(self) -> float:
        """Time from which on the index judges the stiffness [s]."""
        return self.joint.scenario.settled if self.index.settled else 0.0

    def error(self, method: str) -> float:
        """The index for a method, in its unit."""
        return float(getattr(self.performance[method].indices, self.index.field))


def compare(
    joints: Sequence[Joint],
    seeds: Sequence[int],
    processes: int | None = None,
    progress: Progress = lambda done: None,
) -> list[Row]:
    """Runs every joint with every seed of the plant's noise; the rows of the table.

    processes, progress   as for sigmahat.runs.engine.run_all(); one run is one job

    Raises what simulate() raises, and WorkerError if a process was ended from outside.
    """
    runs = [(i, seed) for i in range(len(joints)) for seed in seeds]
    # Longest runs first, so that no process waits for another process at the end.
    runs.sort(key=lambda run: -_effort(joints[run[0]].scenario))
    jobs = [partial(measured, joints[i].scenario, seed, performances) for i, seed in runs]
    results = dict(zip(runs, run_all(jobs, processes, progress), strict=True))
    return [
        row
        for i, joint in enumerate(joints)
        for row in rows_of(joint, [results[i, seed] for seed in seeds])
    ]


def rows_of(joint: Joint, runs: Sequence[Mapping[str, Performance]]) -> list[Row]:
    """The rows of a joint from its runs, each of which has a performance for each comparison."""
    return [
        Row(
            joint,
            case,
            part,
            INDICES[field],
            {
                method: mean_performance([run[comparison_name(i, method, part)] for run in runs])
                for method in METHODS
            },
        )
        for i, case in enumerate(joint.cases)
        for part in joint.parts
        for field in joint.scenario.tables[0]
    ]


def _effort(scenario: Scenario) -> float:
    return scenario.duration * len(scenario.estimators)
