"""How often the true stiffness is within 1.96 sigma_std of the estimate of FilteredRegression.

    python tests/studies/calibration.py RUNS

prints the share of instants after 2 s, as the mean over runs with its 95 % interval: once with
errors of D_theta and Coulomb friction that are drawn from their priors, and once with an error of
B, too. Then the slowest motions with up to ten times the noise of the paper, 40 s each: the same
share, the share of confident instants, and of those that are confident and over 20 % wrong.
"""

from __future__ import annotations

import itertools
import math
import sys
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from sigmahat.compare.performance import CALIBRATED, performances
from sigmahat.fmi.instance import Value
from sigmahat.fmi.master import Recording
from sigmahat.paper.awas import against_the_plant, awas, estimator
from sigmahat.runs.engine import measured, run_all
from sigmahat.runs.metrics import mean_interval
from sigmahat.runs.scenario import Scenario, Sine
from sigmahat.runs.signals import signal_of

METHOD = "FilteredRegression"
FREQUENCIES = (0.05, 0.1, 0.15, 0.2, 0.3)  # [Hz]
NOISES = (1.0, 2.0, 5.0, 10.0)  # times the noise of the paper


def drawn(run: int, with_inertia: bool) -> Scenario:
    """The AwAS at 0.3 to 8 Hz, and an estimator whose motor data have errors."""
    rng = np.random.default_rng([4, run])
    frequency = math.exp(rng.uniform(math.log(0.3), math.log(8.0)))
    d, friction, b = rng.standard_normal(3) * (0.2, 0.02, 0.1)
    plant = awas(0.030, Sine(0.3 if frequency < 5 else 0.5, frequency))
    values: dict[str, Value] = {
        "method": METHOD,
        "rls.n": 3,
        "motor.D_theta": 1e-3 / (1 + d),
        "prior.D_theta": 0.2,
        "prior.tau_coulomb": 0.02,
        "prior.torque_gain": 0.0,  # that of the plant is exact
    }
    if with_inertia:
        values |= {"motor.B": 2.3e-5 / (1 + b), "prior.B": 0.1}
    start = {**plant.start, "motor.tau_coulomb": abs(friction)}
    return Scenario(
        name=f"drawn-{run}",
        description="AwAS with friction and motor data drawn at random",
        duration=15.0,
        plant=replace(plant, start=start),
        estimators={METHOD: replace(estimator(values), record=("sigma", "sigma_std"))},
        comparisons=against_the_plant([METHOD]),
        figures=(),
    )


def share(runs: Sequence[int], with_inertia: bool) -> tuple[float, float]:
    """Mean of the share over runs, and half the width of its 95 % interval [%]."""
    jobs = [partial(measured, drawn(k, with_inertia), k + 1, performances) for k in runs]
    return mean_interval([each[METHOD].inside for each in run_all(jobs, processes=2)])


def slow(frequency: float, noise: float, coulomb: float) -> Scenario:
    """The AwAS in slow motion, with exact motor data and so many times the noise of the paper."""
    plant = awas(0.030, Sine(0.3, frequency))
    start = {"motor.tau_coulomb": coulomb, "noise.tau_variance": 1e-5 * noise**2}
    values: dict[str, Value] = {"method": METHOD, "rls.n": 3, "noise.tau": 3.2e-3 * noise}
    record = ("sigma", "sigma_std", "confident")
    return Scenario(
        name=f"slow-{frequency}-{noise}-{coulomb}",
        description="AwAS in slow motion",
        duration=40.0,
        plant=replace(plant, start={**plant.start, **start}),
        estimators={METHOD: replace(estimator(values), record=record)},
        comparisons=against_the_plant([METHOD]),
        figures=(),
    )


def trust(scenario: Scenario, recording: Recording) -> tuple[float, float, float]:
    """Shares of instants after 2 s [%]: inside, confident, confident and over 20 % wrong."""
    estimate = recording.estimators[METHOD]
    late = recording.t >= CALIBRATED
    true = signal_of(recording, scenario.comparisons[0].reference)[late]
    error = np.abs(estimate["sigma"][late] - true)
    confident = estimate["confident"][late] > 0
    inside = error <= 1.96 * estimate["sigma_std"][late]
    wrong = confident & (error > 0.2 * true)
    every, sure, danger = (100 * float(np.mean(share)) for share in (inside, confident, wrong))
    return every, sure, danger


if __name__ == "__main__":
    for with_inertia in (False, True):
        mean, half_width = share(range(int(sys.argv[1])), with_inertia)
        print(f"{'with' if with_inertia else 'without'} B: {mean:.1f} +- {half_width:.1f} %")
    for cell in itertools.product(FREQUENCIES, NOISES, (0.0, 0.02)):
        jobs = [partial(measured, slow(*cell), seed, trust) for seed in (1, 2)]
        found = np.mean(run_all(jobs, processes=2), axis=0)
        print("{} Hz, noise x{}, Coulomb {} N.m:".format(*cell), np.round(found, 2))
