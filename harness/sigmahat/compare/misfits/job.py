"""The job of `sigmahat compare --misfits`: every row with every seed, and its accuracy.

Here, a *claim* is the standard deviation sigma_std of an estimate.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import astuple, dataclass
from functools import partial
from operator import add

import numpy as np
from numpy.typing import NDArray

from sigmahat.compare.misfits.conditions import CONDITIONS, Condition
from sigmahat.compare.misfits.experiment import JOINTS, Experiment, Joint, draw
from sigmahat.compare.misfits.motion import Motion, run
from sigmahat.estimator.estimator import Estimator
from sigmahat.experiments.engine import Progress, run_all
from sigmahat.fmi.model import Value

SETTLED = 2.0  # time after the start of the torque from which an estimate is judged [s]
DANGEROUS_ERROR, DANGEROUS_CLAIM = 0.1, 0.02
"""Limits of a dangerous instant: error above, and sigma_std / estimate below its limit [1]."""
WRONG = 0.2  # error above which a confident estimate is wrong [1]
_LARGEST = 10.0  # upper limit of a relative error or of a relative sigma_std


@dataclass(frozen=True)
class Score:
    """Sums over instants. Error and claim (sigma_std) are relative to the true stiffness."""

    instants: int = 0
    error: float = 0.0  # squares of the error [1]
    claim: float = 0.0  # squares of sigma_std divided by the true stiffness [1]
    coverage: int = 0  # instants with an error of at most 1.96 sigma_std
    dangerous: int = 0  # instants
    confident: int = 0  # instants
    wrong: int = 0  # instants that are confident, with an error above WRONG

    def __add__(self, other: Score) -> Score:
        return Score(*map(add, astuple(self), astuple(other)))

    @property
    def figures(self) -> dict[str, float]:
        """RMS of error and claim; percentages of instants with the truth within 1.96 sigma_std, and
        of dangerous, confident, and confident and wrong instants [%]; nan without instants.
        """
        found = {name: total / (self.instants or math.nan) for name, total in vars(self).items()}
        del found["instants"]
        found |= {name: math.sqrt(found[name]) for name in ("error", "claim")}
        return {name: 100 * value for name, value in found.items()}


def score(
    true: NDArray[np.float64],
    sigma: NDArray[np.float64],
    sigma_std: NDArray[np.float64],
    confident: NDArray[np.bool_],
) -> Score:
    """The score of an estimate; arguments [N.m/rad] and flags of shape (N,).

    Instants with a true stiffness of 0 are left out: the spring is in its dead zone.
    """
    engaged = true != 0
    true, sigma, sigma_std, confident = (a[engaged] for a in (true, sigma, sigma_std, confident))
    error = np.abs(sigma / true - 1)
    claim = sigma_std / np.abs(true)
    dangerous = (error > DANGEROUS_ERROR) & (sigma_std < DANGEROUS_CLAIM * np.abs(sigma))
    return Score(
        instants=len(true),
        error=float(np.sum(np.minimum(error, _LARGEST) ** 2)),
        claim=float(np.sum(np.minimum(claim, _LARGEST) ** 2)),
        coverage=int(np.sum(np.abs(sigma - true) <= 1.96 * sigma_std)),
        dangerous=int(np.sum(dangerous)),
        confident=int(np.sum(confident)),
        wrong=int(np.sum(confident & (error > WRONG))),
    )


def settings(experiment: Experiment, torque_gain: float) -> dict[str, Value]:
    """Start values of StiffnessEstimator, with method FilteredRegression.

    torque_gain  prior standard deviation of the gain of the measured torque [1]
    """
    joint, plant, errors = experiment.joint, experiment.plant, experiment.errors
    given: dict[str, Value] = {
        "method": "FilteredRegression",
        "modality": "Residual",
        "samplePeriod": experiment.T,
        "rls.n": joint.order,
        "rls.m": joint.order,
        "range.phi": joint.range_phi,
        "noise.tau": 3.2e-3,
        "encoder.theta": plant["encoder.theta"],
        "encoder.q": plant["encoder.q"],
        "motor.gamma": plant["motor.gamma"],
        "motor.D_theta": (1 + errors["D_theta"]) * plant["motor.D_theta"],
        "motor.B": (1 + errors["B"]) * plant["motor.B"],
        "prior.tau_e": 45.0,
        "prior.D_theta": 0.2,
        "prior.B": 0.1,
        # The nominal friction of this kind of joint; the joint itself may have other friction.
        "prior.tau_coulomb": joint.plant["motor.tau_coulomb"],
        "prior.torque_gain": torque_gain,
        "regression.bandwidth": 350.0,
    }
    return {**given, **experiment.estimator}


ESTIMATOR = "StiffnessEstimator"


@dataclass(frozen=True)
class Row:
    condition: Condition
    joint: Joint
    score: Score  # score over all instants of all seeds


def compare(
    conditions: Sequence[Condition],
    joints: Sequence[Joint],
    seeds: Sequence[int],
    processes: int | None = None,
    progress: Progress = lambda done: None,
) -> list[Row]:
    """Runs each condition of CONDITIONS on the joints where the misfit of the condition can occur.

    processes, progress   as for sigmahat.experiments.engine.run_all(); one run is one job

    Raises ValueError for an unknown start value, FmuError if an FMU refuses, and WorkerError if
    another program ended a process.
    """
    rows = pairs(conditions, joints)
    jobs = [
        # Indices, because other processes cannot receive the functions in a condition.
        partial(run_once, CONDITIONS.index(condition), JOINTS.index(joint), seed)
        for condition, joint in rows
        for seed in seeds
    ]
    scores = iter(run_all(jobs, processes, progress))
    return [Row(*row, sum((next(scores) for _ in seeds), Score())) for row in rows]


def pairs(
    conditions: Sequence[Condition], joints: Sequence[Joint]
) -> list[tuple[Condition, Joint]]:
    """Returns the rows of a table: each condition with the joints where its misfit can occur."""
    return [(each, joint) for each in conditions for joint in joints if joint in each.joints]


def run_once(condition: int, joint: int, seed: int) -> Score:
    """Computes the score of one run, given by indices in CONDITIONS and JOINTS."""
    row = CONDITIONS[condition]
    experiment = row.change(draw(JOINTS[joint], seed))
    return estimate(experiment, run(experiment), row.torque_gain)


def estimate(experiment: Experiment, motion: Motion, torque_gain: float) -> Score:
    """Computes the score of FilteredRegression on a run; torque_gain as for settings()."""
    names = ("sigma", "sigma_std", "confident")
    estimator = Estimator(settings(experiment, torque_gain), names, warn_of_range=False)
    found = estimator.run(**motion.measured)
    judged = experiment.T * np.arange(len(motion.sigma)) >= experiment.rest + SETTLED
    outputs = (found[name][judged] for name in names)
    return score(motion.sigma[judged], *outputs)
