"""FilteredRegression on logs of the AwAS: motions it was not made for, odd beginnings."""

import numpy as np
import pytest
from scipy.signal import lfilter

from c_library import Array, Estimator, Library
from plant_runs import run_awas, times
from recorded_logs import COLUMNS, RETRACTED, T
from sigmahat.runs.metrics import msrep

MEASURED = tuple(COLUMNS.values())
SETTINGS = {"method": 2, "rls.n": 3, "motor.D_theta": 1.1e-3}  # 10 % too high


def multisine(rng: np.random.Generator, t: Array) -> tuple[Array, Array]:
    """Torques of both motors: 3 to 6 sines of 0.1 to 10 Hz, 1 to 3 of 0.05 to 0.5 Hz."""
    count = rng.integers(3, 7)
    frequency = np.exp(rng.uniform(np.log(0.1), np.log(10), count))
    amplitude = rng.uniform(0.3, 1, count)
    phase = rng.uniform(0, 2 * np.pi, count)
    tau = (
        0.4
        * (amplitude / amplitude.sum())
        @ np.sin(2 * np.pi * np.outer(frequency, t) + phase[:, None])
    )
    count = rng.integers(1, 4)
    frequency = np.exp(rng.uniform(np.log(0.05), np.log(0.5), count))
    amplitude = rng.uniform(0.3, 1, count)
    amplitude *= 8 * min(1, frequency.min() / 0.1) / amplitude.sum()  # the lever arm stays long
    return tau, amplitude @ np.sin(2 * np.pi * np.outer(frequency, t))


def random_walk(rng: np.random.Generator, t: Array) -> tuple[Array, Array]:
    """Torques of both motors: random walks that come back, smooth over 20 and 50 ms."""

    def walk(memory: float, smooth: float) -> Array:
        white = rng.standard_normal(len(t))
        x = lfilter([1], [1, -np.exp(-T / memory)], white)
        decay = np.exp(-T / smooth)
        x = lfilter([1 - decay], [1, -decay], x)
        return np.asarray(x / np.std(x))

    tau, tau_c = 0.2 * walk(0.5, 0.02), 3.0 * walk(1.0, 0.05)
    return tau, tau_c - tau_c.mean()


@pytest.mark.slow("twenty motions of 15 s are simulated and estimated")
def test_motions_that_nothing_was_tuned_on(c: Library) -> None:
    """Seeds fixed beforehand; D_theta wrong by 10 %; after 2 s."""
    t = times(T, 15.0)
    found = []
    for seed in range(9000, 9020):
        rng = np.random.default_rng(seed)
        tau, tau_c = multisine(rng, t) if seed % 2 == 0 else random_walk(rng, t)
        torques = np.column_stack([tau, tau_c, 0 * t])
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
    """GIVEN a joint that moves at the first sample, in [rad/s], THEN that costs hardly more than to
    learn nothing for 12/w, at any sample period."""
    t = times(period, 1.0)
    torques = np.column_stack([0.3 * np.sin(2 * np.pi * t), 8 * np.sin(0.2 * np.pi * t), 0 * t])
    start = {"initial.theta_dot": velocity, "initial.q_dot": velocity}
    start["motor.tau_coulomb"] = friction
    run = run_awas(period, torques, {**RETRACTED, **start}, (*MEASURED, "sigma"))
    z = np.column_stack([run[name] for name in MEASURED])
    found = Estimator(c, {**SETTINGS, "samplePeriod": period}).run(z)
    learned = np.flatnonzero(found["a"] == 0)[-1] * period
    assert learned == pytest.approx(12 / 350, abs=5e-3)
    assert msrep(run["sigma"], found["sigma"]) <= 2 * 100 * (12 / 350)
