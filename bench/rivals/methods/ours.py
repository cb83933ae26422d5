"""The methods of this package, as their FMU: FilteredRegression and Paper2011."""

from __future__ import annotations

import time
from collections.abc import Mapping

import numpy as np

from rivals.records import Array, Estimate, JointLog
from rivals.spring import spring
from sigmahat.fmi.instance import Slave, Value, installed
from sigmahat.fmi.sample_loop import Recorder, SampleLoop, step_times

P_0 = 1e20
"""Initial covariance, as in the paper."""
SAMPLE = 1e7
"""What a sample at the range of the deformation counts, the start being 1."""
_INPUTS = ("theta", "q", "theta_c", "tau")
_OUTPUTS = ("sigma", "sigma_std", "confident")


def filtered_regression(log: JointLog) -> Estimate:
    """On line: the estimate at each sample is from those up to it.

    Parameters are as docs/filtered-regression.md advises: what the data sheet says becomes ranges,
    priors and noise, and all else keeps its start value.
    """
    known = log.known
    found, seconds = _replayed(
        log,
        {
            "method": "FilteredRegression",
            "range.phi": known.range_phi,
            "range.setPoint": spring(log).range_theta_c,
            "prior.tau_e": known.range_tau_e,
            "prior.B": known.relative_std_B,
            "prior.D_theta": known.relative_std_D_theta,
            "prior.tau_coulomb": known.tau_coulomb,
            "prior.torque_gain": known.relative_std_gain,
        },
    )
    confident = found["confident"].astype(bool)
    return Estimate(found["sigma"], found["sigma_std"], confident, seconds)


def paper2011(log: JointLog) -> Estimate:
    """On line, without a standard deviation, and never confident.

    F. Flacco, A. De Luca, I. Sardellitti, N. G. Tsagarakis, "Robust estimation of variable
    stiffness in flexible joints", Proc. IEEE/RSJ IROS 2011: residual (6), (8), kinematic Kalman
    filter (9) to (11), recursive least squares (14), (27). Its own parameters are those of the
    paper, which are the start values of the FMU, but for c of (27): with it the start P(0) counts
    as 1/(c P(0)) in units of the squares of the columns. The paper's columns go up to (100 mm)^2
    times 0.3 rad, so that a single sample counts 1e7 times as much as the start; c is such that a
    sample at the range of the deformation does so here, too.
    """
    c = SAMPLE / (P_0 * log.known.range_phi**2)
    found, seconds = _replayed(log, {"method": "Paper2011", "rls.P_0": P_0, "rls.c": c})
    nothing = np.full(len(log.theta), np.nan)
    return Estimate(found["sigma"], nothing, np.zeros(len(nothing), bool), seconds)


def _replayed(log: JointLog, start: Mapping[str, Value]) -> tuple[dict[str, Array], float]:
    """Outputs by name at every sample, and the wall time of the ticks [s].

    start  values besides those of the motor, the sampling and the orders of the spring
    """
    samples = np.column_stack([getattr(log, name) for name in _INPUTS])
    with Slave(installed("StiffnessEstimator"), "estimator") as slave:
        slave.initialize({**_common(log), **start})
        recorder, loop = Recorder(slave, _OUTPUTS, len(samples)), SampleLoop()
        t = log.sample_period * np.arange(len(samples), dtype=np.float64)
        loop.set_real(slave, slave.fmu.references(_INPUTS, "input"), samples)
        loop.step(slave, step_times(t, log.sample_period))
        recorder.add_to(loop)
        begin = time.perf_counter()
        loop.run(0, len(samples))
        return recorder.columns(), time.perf_counter() - begin


def _common(log: JointLog) -> dict[str, Value]:
    known, shape = log.known, spring(log)
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
