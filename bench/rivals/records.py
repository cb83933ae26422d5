"""Data that the joints give to the methods, and results of the methods."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sigmahat.experiments.benchmark import LogWithTruth
from sigmahat.experiments.scores import Score

Array = NDArray[np.float64]

# Relative standard deviations of the data sheets, as drawn, and as given to the methods.
STD_B = 0.05
STD_D = 0.2
STD_GAIN = 0.015  # of the measured torque, which no log shows


@dataclass(frozen=True)
class JointLog:
    """The log of one simulation of one joint. All arrays have one entry per sample."""

    kind: str  # series_elastic, variable_stiffness or arm
    seed: int
    sample_period: float  # [s]
    theta: Array  # measured motor position behind the gear [rad]
    q: Array  # measured link position [rad]
    tau: Array  # measured motor torque on the motor's axis [N.m]
    theta_c: Array  # measured position of the stiffness motor; 0 where there is none [rad]
    tau_e: Array  # true torque of the spring, which acts on the motor [N.m]
    stiffness: Array  # true slope d tau_e / d phi, phi = q - theta [N.m/rad]
    known: Mapping[str, float]
    """Start values of the estimator from the data sheet of the owner, which has errors."""

    @property
    def with_truth(self) -> LogWithTruth:
        """The log as the benchmark of the package has it."""
        return LogWithTruth(
            name=f"{self.kind}-{self.seed}",
            kind=self.kind,
            seed=self.seed,
            sample_period=self.sample_period,
            measured={"theta": self.theta, "q": self.q, "tau": self.tau, "theta_c": self.theta_c},
            stiffness=self.stiffness,
            parameters={"samplePeriod": self.sample_period, **self.known},
        )


@dataclass(frozen=True)
class RivalEstimate:
    """The estimate of a method for a log; NaN at samples without an estimate."""

    stiffness: Array  # at every sample [N.m/rad]
    std: Array  # standard deviation [N.m/rad]; NaN: the method gives none
    confident: NDArray[np.bool_]
    seconds: float  # wall time of the estimation

    def score(self, log: JointLog) -> Score:
        """The score for the log. Raises ValueError as LogWithTruth.score() does."""
        return log.with_truth.score(self.stiffness, self.confident, std=self.std)
