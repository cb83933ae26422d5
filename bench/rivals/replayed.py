"""A log through the estimator of this package, as its FMU."""

from __future__ import annotations

import time
from collections.abc import Mapping

import numpy as np

import sigmahat
from rivals.records import Array, JointLog
from rivals.spring import Spring, spring
from sigmahat.fmi.instance import Fmu, Slave, Value
from sigmahat.fmi.sample_loop import Recorder, SampleLoop, step_times

OUTPUTS = ("sigma", "sigma_std", "confident")


def replayed(log: JointLog, start: Mapping[str, Value]) -> tuple[dict[str, Array], float]:
    """Outputs by name at every sample, and the wall time of the ticks [s].

    start  values besides those of the motor, the sampling and the spring's orders

    Raises FmuError if the FMU refuses a value.
    """
    samples = np.column_stack([log.theta, log.q, log.theta_c, log.tau])
    with (
        Fmu(sigmahat.fmu("StiffnessEstimator")) as fmu,
        Slave(fmu, "estimator") as slave,
    ):
        slave.initialize({**_common(log, spring(log)), **start})
        inputs = fmu.references(("theta", "q", "theta_c", "tau"), "input")
        recorder, loop = Recorder(slave, OUTPUTS, len(samples)), SampleLoop()
        t = log.sample_period * np.arange(len(samples), dtype=np.float64)
        loop.set_real(slave, inputs, samples)
        loop.step(slave, step_times(t, log.sample_period))
        recorder.add_to(loop)
        begin = time.perf_counter()
        loop.run(0, len(samples))
        seconds = time.perf_counter() - begin
        return recorder.columns(), seconds


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
