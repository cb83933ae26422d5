"""Performance of a method in a run: its error, its standard deviation, and its motor data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass

import numpy as np

from sigmahat.fmi.master import Recording
from sigmahat.runs.engine import indices_by_comparison
from sigmahat.runs.metrics import Indices
from sigmahat.runs.scenario import Comparison, Scenario, signal_of, source_and_variable

CALIBRATED = 2.0
"""Time from which on sigma_std is compared with the error [s]."""
_UNKNOWN = np.array([np.nan])


@dataclass(frozen=True)
class Performance:
    """Performance of one method, in one run or as the mean over runs."""

    indices: Indices
    sigma_std: float
    """Root mean square of sigma_std relative to the true stiffness, from CALIBRATED on [%]"""
    inside: float
    """Percentage of instants from CALIBRATED on with an error of at most 1.96 sigma_std [%]"""
    D_theta: float
    """D_theta_hat at the end [N.m.s/rad]; nan for a device of several motors"""
    B: float
    """B_hat at the end [kg.m2]; nan for a device of several motors"""
    tau_coulomb: float
    """tau_coulomb_hat at the end [N.m]; nan for a device of several motors"""


def performances(scenario: Scenario, recording: Recording) -> dict[str, Performance]:
    """The performance of each comparison of the scenario, by its name.

    Every estimate is a stiffness sigma, sigma_1 or sigma_2 of an estimator. Its standard deviation
    is recorded too.
    """
    indices = indices_by_comparison(scenario, recording)
    return {
        each.name: _performance(each, indices[each.name], recording)
        for each in scenario.comparisons
    }


def _performance(comparison: Comparison, indices: Indices, recording: Recording) -> Performance:
    name, variable = source_and_variable(comparison.estimate)
    part = variable.removeprefix("sigma")
    estimate = recording.estimators[name]
    true = signal_of(recording, comparison.reference)
    late = recording.t >= CALIBRATED
    relative_std = (estimate[f"sigma_std{part}"] / true)[late]
    error = np.abs(estimate[variable] / true - 1)[late]
    D_theta, B, tau_coulomb = (
        float(estimate.values.get(f"{output}{part}", _UNKNOWN)[-1])
        for output in ("D_theta_hat", "B_hat", "tau_coulomb_hat")
    )
    return Performance(
        indices=indices,
        sigma_std=100 * float(np.sqrt(np.mean(relative_std**2))),
        inside=100 * float(np.mean(error <= 1.96 * relative_std)),
        D_theta=D_theta,
        B=B,
        tau_coulomb=tau_coulomb,
    )


def mean_performance(runs: Sequence[Performance]) -> Performance:
    """The mean of each number over runs."""
    indices = np.mean([astuple(each.indices) for each in runs], axis=0).tolist()
    others = np.mean([list(vars(each).values())[1:] for each in runs], axis=0).tolist()
    return Performance(Indices(*indices), *others)
