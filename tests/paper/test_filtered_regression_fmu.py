"""FilteredRegression on logs of the AwAS: motions it was not made for, odd beginnings, held torque,
springs that age, long rest."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

import sigmahat
from c_library import Array, Estimator, Library, load
from c_regression import covariance
from plant_runs import run_awas, times
from sigmahat.fmi.instance import Fmu, Slave
from sigmahat.fmi.sample_loop import Recorder, SampleLoop, step_times
from sigmahat.runs.metrics import msrep

T = 1e-3  # [s]
SHORTENED = {"initial.theta_c": 0.030 / (0.0025 / (2 * np.pi))}  # lever arm of 70 mm
MEASURED = ("theta_measured", "q_measured", "theta_c_measured", "tau_measured", "tau_e_measured")
SETTINGS = {"method": 2, "rls.n": 3, "motor.D_theta": 1.1e-3}  # 10 % too high


@pytest.fixture(scope="module")
def c(build: Path) -> Library:
    return load(build)


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
        run = run_awas(T, torques, {**SHORTENED, "noise.seed": seed}, (*MEASURED, "sigma"))
        estimates = Estimator(c, SETTINGS).run(np.column_stack([run[name] for name in MEASURED]))
        found.append(msrep(run["sigma"][2000:], estimates["sigma"][2000:]))
    assert np.median(found) <= 0.5
    assert max(found) <= 5.0


@pytest.mark.parametrize("period", [1e-3, 1e-4])
@pytest.mark.parametrize("velocity", [0.3, 0.5, 1.0, 2.4])
@pytest.mark.parametrize("friction", [0.0, 0.02])
def test_motor_that_turns_at_the_start(
    c: Library, period: float, velocity: float, friction: float
) -> None:
    """GIVEN a joint that moves at the first sample, in [rad/s], THEN that costs hardly more than to
    learn nothing for 12/w, at any sample period."""
    t = times(period, 1.0)
    torques = np.column_stack([0.3 * np.sin(2 * np.pi * t), 8 * np.sin(0.2 * np.pi * t), 0 * t])
    start = {"initial.theta_dot": velocity, "initial.q_dot": velocity}
    start["motor.tau_coulomb"] = friction
    run = run_awas(period, torques, {**SHORTENED, **start}, (*MEASURED, "sigma"))
    z = np.column_stack([run[name] for name in MEASURED])
    found = Estimator(c, {**SETTINGS, "samplePeriod": period}).run(z)
    learned = np.flatnonzero(found["a"] == 0)[-1] * period
    assert learned == pytest.approx(12 / 350, abs=5e-3)
    assert msrep(run["sigma"], found["sigma"]) <= 2 * 100 * (12 / 350)


@pytest.fixture(scope="module")
def ageing() -> Iterator[tuple[Array, Array]]:
    """Measurements [size: ticks x 5] and true stiffness [size: ticks] at 1 Hz.

    k_s falls by 30 % between 20 and 40 s; excitation is switched off at 60 s, end at 65 s.
    """
    t = times(T, 65.0)
    on = t <= 60.0
    torques = np.column_stack(
        [np.where(on, 0.3 * np.sin(2 * np.pi * t), 0), np.where(on, 8 * np.sin(0.2 * np.pi * t), 0)]
    )
    k_s = 14220 * (1 - 0.3 * np.clip((t - 20) / 20, 0, 1))
    with Fmu(sigmahat.fmu("AwasPlant")) as fmu, Slave(fmu, "plant") as plant:
        references = fmu.references(("tau", "tau_c"), "input")
        plant.initialize({**SHORTENED, "tau": 0.0, "tau_c": 0.0})
        recorder, loop = Recorder(plant, (*MEASURED, "sigma"), len(t)), SampleLoop()
        recorder.add_to(loop)
        loop.set_real(plant, fmu.references(("spring.k_s",)), k_s[:, None])
        loop.set_real(plant, references, torques)
        loop.set_slopes(plant, references, np.diff(torques, axis=0) / T)
        loop.step(plant, step_times(t, T))
        loop.run(0, len(t) - 1)
        recorder.sample(len(t) - 1)
    run = recorder.columns()
    yield np.column_stack([run[name] for name in MEASURED]), run["sigma"]


def test_follows_a_spring_that_ages_and_keeps_what_it_knows_at_rest(
    c: Library, ageing: tuple[Array, Array]
) -> None:
    z, sigma = ageing
    values = {**SETTINGS, "prior.B": 0.1, "prior.tau_coulomb": 0.02, "regression.drift": 1e-3}
    estimator = Estimator(c, values)
    estimates = estimator.run(z)
    late = slice(40_000, 60_001)
    assert msrep(sigma[late], estimates["sigma"][late]) <= 1.0
    without = {**values, "regression.drift": 0.0}
    # The misfit lets it forget the springs as they were, but later.
    forgets = msrep(sigma[late], Estimator(c, without).run(z)["sigma"][late])
    keeps = Estimator(c, {**without, "regression.memory": 0.0}).run(z)["sigma"][late]
    assert 1.0 < forgets < 10.0 < msrep(sigma[late], keeps)

    # The last second, with its noise, again and again: 10 minutes, then on to 1e6 ticks.
    before = estimator.estimate.sigma
    for ticks in (600_000, 400_000):
        assert estimator.repeat(z[-1000:], ticks) == ticks
        assert estimator.estimate.sigma == pytest.approx(before, rel=0.01)
        P = covariance(estimator)  # the variances of the priors are 1
        assert np.all(np.diag(P) <= 1 + 1e-9)
        assert np.all(np.linalg.eigvalsh(P) > 0)
