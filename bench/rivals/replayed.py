"""A log through the estimator of this package, as its FMU."""

from __future__ import annotations

import time
from collections.abc import Mapping

import numpy as np

import sigmahat
from rivals.records import Array, JointLog
from rivals.spring import Spring, spring
from sigmahat.fmi.instance import Fmu, Slave, Value
from sigmahat.logs.replay import replay
from sigmahat.logs.sampling import Samples

_CHUNK = 1 << 14


def replayed(log: JointLog, start: Mapping[str, Value]) -> tuple[dict[str, Array], float]:
    """Outputs by name at every sample, and the wall time of the ticks [s].

    start  values besides those of the motor, the sampling and the spring's orders

    Raises FmuError if the FMU refuses a value.
    """
    names = ("theta", "q", "theta_c", "tau")
    values = np.column_stack([log.theta, log.q, log.theta_c, log.tau])
    samples = Samples(log.sample_period, names, values, np.arange(len(values)), [])
    with (
        Fmu(sigmahat.fmu("StiffnessEstimator")) as fmu,
        Slave(fmu, "estimator") as slave,
    ):
        begin = time.perf_counter()
        parts = list(replay(slave, samples, {**_common(log, spring(log)), **start}, _CHUNK))
        seconds = time.perf_counter() - begin
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}, seconds


def _common(log: JointLog, shape: Spring) -> dict[str, Value]:
    known = log.known
    return {
        "samplePeriod": log.sample_period,
        "motor.gamma": known.gamma,
        "motor.B": known.B,
        "motor.D_theta": known.D_theta,
        "encoder.theta": float(known.counts_theta),
        "encoder.q": float(known.counts_q),
        "setPoint.offset": 0.0,
        "setPoint.scale": 1.0,
        "rls.n": shape.n,
        "rls.m": shape.m,
        "noise.tau": known.noise_tau,
    }
