"""The job of `sigmahat compare`: runs every joint with every seed, and judges each method."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial

import numpy as np

from sigmahat.compare.conditions import METHODS, Case, Joint, comparison_name
from sigmahat.experiments.engine import Progress, indices_by_comparison, measured, run_all
from sigmahat.experiments.metrics import INDICES, Index
from sigmahat.experiments.scenario import Scenario, signal_of, source_and_variable
from sigmahat.fmi.master import Recording

CALIBRATED = 2.0  # time from which on sigma_std is compared with the error [s]
MOTOR = ("D_theta", "B", "tau_coulomb")
"""Motor data estimated at the end [N.m.s/rad, kg.m2, N.m]; nan for several motors."""
_UNKNOWN = np.array([np.nan])

Performance = Mapping[str, float]
"""Numbers of one method, in one run or as means over runs: the fields of Indices, MOTOR, and

sigma_std  RMS relative to the true stiffness, from CALIBRATED on [%]
inside     instants from CALIBRATED on with an error of at most 1.96 sigma_std [%]
"""


def performances(scenario: Scenario, recording: Recording) -> dict[str, Performance]:
    """The performance of each comparison of the scenario, by its name.

    Every estimate is a stiffness sigma, sigma_1 or sigma_2, with its standard deviation recorded.
    """
    indices, late = indices_by_comparison(scenario, recording), recording.t >= CALIBRATED
    found: dict[str, Performance] = {}
    for each in scenario.comparisons:
        estimator, variable = source_and_variable(each.estimate)
        part, estimate = variable.removeprefix("sigma"), recording.estimators[estimator]
        true = signal_of(recording, each.reference)
        relative_std = (estimate[f"sigma_std{part}"] / true)[late]
        error = np.abs(estimate[variable] / true - 1)[late]
        found[each.name] = {
            **asdict(indices[each.name]),
            "sigma_std": 100 * float(np.sqrt(np.mean(relative_std**2))),
            "inside": 100 * float(np.mean(error <= 1.96 * relative_std)),
            **{n: float(estimate.values.get(f"{n}_hat{part}", _UNKNOWN)[-1]) for n in MOTOR},
        }
    return found


@dataclass(frozen=True)
class Row:
    """A stiffness of a joint in one case, evaluated by one index."""

    joint: Joint
    case: Case
    part: str  # an element of Joint.parts
    index: Index
    performance: Mapping[str, Performance]  # mean performance over the seeds, by method

    @property
    def judged_from(self) -> float:
        """Time from which on the index judges the stiffness [s]."""
        return self.joint.scenario.settled if self.index.settled else 0.0

    def error(self, method: str) -> float:
        """The index for a method, in its unit."""
        return self.performance[method][self.index.field]


def compare(
    joints: Sequence[Joint],
    seeds: Sequence[int],
    processes: int | None = None,
    progress: Progress = lambda done: None,
) -> list[Row]:
    """Runs every joint with every seed of the plant's noise; the rows of the table.

    processes, progress   as for sigmahat.experiments.engine.run_all(); one run is one job

    Raises what simulate() raises, and WorkerError if another program ended a process.
    """
    runs = [(i, seed) for i in range(len(joints)) for seed in seeds]
    # Longest runs first, so that no process waits for another process at the end.
    efforts = [each.scenario.duration * len(each.scenario.estimators) for each in joints]
    runs.sort(key=lambda run: -efforts[run[0]])
    jobs = [partial(measured, joints[i].scenario, seed, performances) for i, seed in runs]
    results = dict(zip(runs, run_all(jobs, processes, progress), strict=True))

    def mean(i: int, comparison: str) -> Performance:
        each = [results[i, seed][comparison] for seed in seeds]
        means = np.mean([list(found.values()) for found in each], axis=0)
        return dict(zip(each[0], means.tolist(), strict=True))

    return [
        Row(
            joint,
            case,
            part,
            INDICES[field],
            {m: mean(i, comparison_name(k, m, part)) for m in METHODS},
        )
        for i, joint in enumerate(joints)
        for k, case in enumerate(joint.cases)
        for part in joint.parts
        for field in joint.scenario.tables[0]
    ]
