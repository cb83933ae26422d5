"""The job of `sigmahat compare`: every joint with every seed, and how well each method did."""

from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass
from functools import partial

import numpy as np

from sigmahat.compare.conditions import METHODS, Case, Joint, comparison_name
from sigmahat.fmi.master import Recording
from sigmahat.runs.engine import Progress, indices_by_comparison, measured, run_all
from sigmahat.runs.metrics import INDICES, Index, Indices
from sigmahat.runs.scenario import Comparison, Scenario, signal_of, source_and_variable

CALIBRATED = 2.0  # time from which on sigma_std is compared with the error [s]
_UNKNOWN = np.array([np.nan])


@dataclass(frozen=True)
class Performance:
    """Performance of one method, in one run or as the mean over runs.

    Motor data are those at the end; nan for a device of several motors.
    """

    indices: Indices
    sigma_std: float  # RMS relative to the true stiffness, from CALIBRATED on [%]
    inside: float  # instants from CALIBRATED on with an error of at most 1.96 sigma_std [%]
    D_theta: float  # [N.m.s/rad]
    B: float  # [kg.m2]
    tau_coulomb: float  # [N.m]


def performances(scenario: Scenario, recording: Recording) -> dict[str, Performance]:
    """The performance of each comparison of the scenario, by its name.

    Every estimate is a stiffness sigma, sigma_1 or sigma_2, with its standard deviation recorded.
    """
    indices = indices_by_comparison(scenario, recording)
    return {c.name: _performance(c, indices[c.name], recording) for c in scenario.comparisons}


def _performance(comparison: Comparison, indices: Indices, recording: Recording) -> Performance:
    name, variable = source_and_variable(comparison.estimate)
    part = variable.removeprefix("sigma")
    estimate = recording.estimators[name]
    true = signal_of(recording, comparison.reference)
    late = recording.t >= CALIBRATED
    relative_std = (estimate[f"sigma_std{part}"] / true)[late]
    error = np.abs(estimate[variable] / true - 1)[late]
    motor = {
        name: float(estimate.values.get(f"{name}_hat{part}", _UNKNOWN)[-1])
        for name in ("D_theta", "B", "tau_coulomb")
    }
    sigma_std = 100 * float(np.sqrt(np.mean(relative_std**2)))
    inside = 100 * float(np.mean(error <= 1.96 * relative_std))
    return Performance(indices, sigma_std, inside, **motor)


def mean_performance(runs: Sequence[Performance]) -> Performance:
    """The mean of each number over runs."""
    indices = np.mean([astuple(each.indices) for each in runs], axis=0).tolist()
    others = np.mean([list(vars(each).values())[1:] for each in runs], axis=0).tolist()
    return Performance(Indices(*indices), *others)


@dataclass(frozen=True)
class Row:
    """One stiffness of a joint in one case, judged by one index."""

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
    efforts = [each.scenario.duration * len(each.scenario.estimators) for each in joints]
    runs.sort(key=lambda run: -efforts[run[0]])
    jobs = [partial(measured, joints[i].scenario, seed, performances) for i, seed in runs]
    results = dict(zip(runs, run_all(jobs, processes, progress), strict=True))
    rows = []
    for i, joint in enumerate(joints):
        for k, case in enumerate(joint.cases):
            for part in joint.parts:
                names = {method: comparison_name(k, method, part) for method in METHODS}
                found = {
                    method: mean_performance([results[i, seed][name] for seed in seeds])
                    for method, name in names.items()
                }
                fields = joint.scenario.tables[0]
                rows += [Row(joint, case, part, INDICES[field], found) for field in fields]
    return rows
