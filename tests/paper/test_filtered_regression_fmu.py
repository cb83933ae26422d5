"""FilteredRegression on logs of the AwAS with random motions, moving starts and strong noise."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import lfilter

from c_library import Array, Estimator, Library
from dense_regression import START
from dense_signals import GROUPS, Filtered, Inputs
from plant_runs import run_awas, times
from recorded_logs import COLUMNS, RETRACTED, T
from sigmahat.experiments.metrics import msrep

MEASURED = tuple(COLUMNS.values())
SETTINGS = {"method": 2, "rls.n": 3, "motor.D_theta": 1.1e-3}  # D_theta is 10 % too high


def random_walk(rng: np.random.Generator, t: Array) -> tuple[Array, Array]:
    """Torques of both motors: filtered noise with zero mean, smoothed over 20 ms and 50 ms."""

    def walk(memory: float, smooth: float) -> Array:
        white = rng.standard_normal(len(t))
        x = lfilter([1], [1, -np.exp(-T / memory)], white)
        decay = np.exp(-T / smooth)
        x = lfilter([1 - decay], [1, -decay], x)
        return np.asarray(x / np.std(x))

    tau, tau_c = 0.2 * walk(0.5, 0.02), 3.0 * walk(1.0, 0.05)
    return tau, tau_c - tau_c.mean()


@pytest.mark.slow("ten motions of 15 s are simulated and estimated")
def test_motions_that_nothing_was_tuned_on(c: Library) -> None:
    """GIVEN random motions and a D_theta 10 % too high, THEN the error after 2 s is small."""
    t = times(T, 15.0)
    found = []
    for seed in range(9001, 9020, 2):
        torques = np.column_stack([*random_walk(np.random.default_rng(seed), t), 0 * t])
        run = run_awas(T, torques, {**RETRACTED, "noise.seed": seed}, (*MEASURED, "sigma"))
        estimates = Estimator(c, SETTINGS).run(np.column_stack([run[name] for name in MEASURED]))
        found.append(msrep(run["sigma"][2000:], estimates["sigma"][2000:]))
    assert np.median(found) <= 0.5
    assert max(found) <= 5.0


@pytest.mark.parametrize(
    ("period", "velocity", "friction"), [(1e-3, 0.3, 0.0), (1e-3, 2.4, 0.02), (1e-4, 2.4, 0.0)]
)
def test_motor_that_turns_at_the_start(
    c: Library, period: float, velocity: float, friction: float
) -> None:
    """GIVEN a motor with a `velocity` at the start [rad/s], THEN the error hardly increases.
    The estimator waits for 12/w after the first row, where w is the filter bandwidth."""
    t = times(period, 1.0)
    torques = np.column_stack([0.3 * np.sin(2 * np.pi * t), 8 * np.sin(0.2 * np.pi * t), 0 * t])
    start = {"initial.theta_dot": velocity, "initial.q_dot": velocity}
    start["motor.tau_coulomb"] = friction
    run = run_awas(period, torques, {**RETRACTED, **start}, (*MEASURED, "sigma"))
    z = np.column_stack([run[name] for name in MEASURED])
    found = Estimator(c, {**SETTINGS, "samplePeriod": period}).run(z)
    learned = np.flatnonzero(found["a"] == 0)[-1] * period
    assert 12 / 350 < learned < (12 + 2.5) / 350 + period
    assert msrep(run["sigma"], found["sigma"]) <= 2 * 100 * (12 / 350)


# In slow motions with a noisy torque, the estimator must not mistake noise for friction.
# The lower bound of the standard deviation is the van Trees bound (Cramer-Rao with priors).
# A regression with the estimator's columns, but without noise in the columns, gives the bound.
# The regression has no column for a delay, which would contain the derivative of the noise.

TRUE = ("theta", "q", "theta_c", "tau", "tau_e", "sigma")
PRIORS = {
    **{**START, "prior.B": 0.0, "prior.torque_gain": 0.0, "prior.damping": 4e-3},
    **{"prior.load_friction": 0.05, "prior.eccentric": 3e-4, "prior.delay": 0.0},
}


def bound(c: Library, p: dict[str, float], run: dict[str, Array], at: NDArray[np.intp]) -> Array:
    """Lower bound of the standard deviation of sigma at samples `at`, given all data [N.m/rad]."""
    z = np.column_stack([run[name] for name in TRUE[:5]])
    everything = slice(0, len(z))
    inputs = Inputs(p, z, [everything])
    filtered = Filtered(c, p, inputs, z, everything, False)
    kinds = [kind for kind, _, _ in inputs.columns]
    load = -p["prior.load_friction"] * np.abs(run["tau_e"]) * filtered.sign
    filtered.rows[:, kinds.index("LOAD")] = filtered.filtered(np.append(load[1:], 0.0), 0, True)
    filtered.rows[:, kinds.index("DRIVE")] *= np.abs(filtered.sides[:, 0])
    used = [i for i, kind in enumerate(kinds) if GROUPS.get(kind, 0) == 0]
    x = filtered.rows[:, used] / (p["motor.gamma"] * p["noise.tau"])
    P = np.linalg.inv(np.eye(len(used)) + x.T @ x)
    dF = inputs.dF[at][:, used]
    std: Array = np.sqrt(np.einsum("ij,jk,ik->i", dF, P, dF))
    return std


def slow_run(frequency: float, coulomb: float, noise: float, seed: int) -> dict[str, Array]:
    """Simulates 40 s of the AwAS; `noise` scales the standard deviation of the torque noise."""
    t = times(T, 40.0)
    torques = [0.3 * np.sin(2 * np.pi * frequency * t), 8 * np.sin(0.2 * np.pi * t), 0 * t]
    start = {**RETRACTED, "motor.tau_coulomb": coulomb, "noise.seed": seed}
    start["noise.tau_variance"] = 1e-5 * noise**2
    return run_awas(T, np.column_stack(torques), start, {*MEASURED, *TRUE})


@pytest.mark.slow("a run of 40 s is simulated and estimated")
@pytest.mark.parametrize(
    ("frequency", "coulomb", "noise"),
    [(0.1, 0.0, 1.0), (0.2, 0.02, 1.0), (0.1, 0.02, 5.0), (0.2, 0.0, 5.0)],
)
def test_noise_is_not_friction(c: Library, frequency: float, coulomb: float, noise: float) -> None:
    p = {**PRIORS, "noise.tau": 3.2e-3 * noise}
    run = slow_run(frequency, coulomb, noise, seed=9)
    found = Estimator(c, p).run(np.column_stack([run[name] for name in MEASURED]))
    late = np.arange(2000, len(run["sigma"]))
    inside = np.abs(found["sigma"] - run["sigma"]) <= 1.96 * found["sigma_std"]
    assert np.mean(inside[late]) >= 0.9
    last = np.arange(len(run["sigma"]) - 10000, len(run["sigma"]), 100)
    ratio = np.mean(found["sigma_std"][last] / bound(c, p, run, last))
    assert 1 <= ratio <= (6 if noise < 2 else 2)
    assert abs(found["load_friction_hat"][-1]) <= 0.1
