"""Features of all plants: limits of torques, sines that drive the motors, noise of sensors."""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy import stats

from fmi_instance import OK
from fmi_runs import FMI2, PLANTS
from plant_runs import QUIET, Array, run_awas, run_plant, times
from sigmahat.experiments.simulation import run
from sigmahat.paper.scenarios import scenario


@pytest.mark.parametrize("name", ["FlexibleJointPlant", "RealJointPlant"])
def test_the_torques_of_a_large_robot_are_accepted(name: str) -> None:
    """GIVEN torque steps of 1e5 N.m on the link and of 1e3 N.m on the axis of the motor."""
    joint = {"link.M": 1e3, "motor.B": 0.02, "motor.gamma": 200.0, "spring.k_1": 1e6}
    friction = {"link.tau_coulomb": 100.0, "motor.tau_coulomb": 1.0}
    with FMI2(name).initialise({**joint, **friction}) as fmu:
        for k in range(500):
            jump = 1.0 if k // 50 % 2 else -1.0
            fmu.set_all({"tau": 1e3 * jump, "tau_ext": 1e5 * jump})
            assert fmu.step(k * 1e-3, 1e-3) == OK, fmu.messages


# Plants can add a sine to the torque of each motor, so that they move without a signal source.


@pytest.mark.parametrize("name", PLANTS)
def test_every_motor_has_a_signal_that_is_an_input_linear_over_a_step(name: str) -> None:
    motors = {"AwasPlant": ["tau", "tau_c"], "AntagonisticVsaPlant": ["tau_1", "tau_2"]}
    t = times(1e-3, 0.05)
    for motor in motors.get(name, ["tau"]):
        sine = 0.2 * np.sin(10 * np.pi * t)[:, None]
        angle = motor.replace("tau", "theta")
        driven = run_plant(name, [motor], 1e-3, sine, QUIET, [angle])
        start = {f"signal.{motor}.amplitude": 0.2, f"signal.{motor}.frequency": 5.0}
        still = run_plant(name, [motor], 1e-3, 0 * sine, {**QUIET, **start}, [angle])
        np.testing.assert_allclose(still[angle], driven[angle], rtol=0, atol=1e-12)
        assert np.ptp(still[angle]) > 1e-3


def test_a_signal_begins_at_zero_at_any_start_time() -> None:
    with FMI2("AwasPlant") as early, FMI2("AwasPlant") as late:
        for fmu, begin in ((early, 0.0), (late, 0.125)):
            fmu.set_all({**QUIET, "signal.tau.amplitude": 0.3, "signal.tau.frequency": 2.0})
            assert (fmu.enter(begin), fmu.exit()) == (OK, OK)
            assert fmu.get("tau_measured") == 0.0
            for k in range(100):
                assert fmu.step(begin + k / 1024, 1 / 1024) == OK
        names = [n for n, v in early.variables.items() if v.causality == "output"]
        assert late.get_all(names) == early.get_all(names)
        assert early.get("tau_measured") == pytest.approx(0.3 * np.sin(4 * np.pi * 100 / 1024))
        assert early.get("q") != 0.0


def test_a_late_importer_gets_the_sine_of_the_right_time() -> None:
    """GIVEN a communication point that differs a little from the end of the last step."""
    late, h, k = 0.9e-6, 1e-3, 2
    with FMI2("AwasPlant") as fmu:
        values = {"signal.tau.amplitude": 1.0, "signal.tau.frequency": 100.0}
        fmu.initialise({**values, "noise.tau_variance": 0.0})
        for i in range(k):
            assert fmu.step(i * h, h) == OK
        assert fmu.step(k * h + late, h) == OK
        expected = math.sin(2 * math.pi * 100.0 * ((k + 1) * h + late))
        assert fmu.get("tau_measured") == pytest.approx(expected, abs=1e-9)


# Noise of the sensors

SAMPLES = 25_000
MASK = (1 << 64) - 1


@cache
def normals(seed: int, samples: int = SAMPLES, h: float = 1e-3) -> Array:
    """Noise of tau and tau_e of a plant at rest, with unit variance [size: samples x 2]."""
    start = {"noise.tau_variance": 1.0, "noise.tau_e_variance": 1.0, "noise.seed": seed}
    run = run_awas(h, np.zeros((samples, 3)), start, ["tau_measured", "tau_e_measured"])
    return np.column_stack([run["tau_measured"], run["tau_e_measured"]])


def splitmix64(state: int) -> Iterator[int]:
    """Random generator splitmix64 of Steele, Lea and Flood (2014), with Python integers."""
    while True:
        state = (state + 0x9E3779B97F4A7C15) & MASK
        z = ((state ^ (state >> 30)) * 0xBF58476D1CE4E5B9) & MASK
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
        yield z ^ (z >> 31)


def normal(seed: int, channel: int, sample: int) -> float:
    """Standard normal random number by the ratio-of-uniforms method (Kinderman, Monahan 1977)."""
    by_channel = next(splitmix64(next(splitmix64(seed & MASK)) + channel))
    bits = splitmix64(next(splitmix64(by_channel + sample)))
    uniforms = (((each >> 12) + 0.5) / 2.0**52 for each in bits)
    while True:
        v = math.sqrt(8 / math.e) * (next(uniforms) - 0.5)
        u = next(uniforms)
        if (v / u) ** 2 <= -4 * math.log(u):
            return v / u


@pytest.mark.parametrize("seed", [1, 2**31 - 1, -(2**31)])
def test_noise_is_the_published_method_bit_for_bit(seed: int) -> None:
    expected = [[normal(seed, channel, k) for channel in (0, 1)] for k in range(300)]
    np.testing.assert_array_equal(normals(seed, 300), expected)


def test_noise_is_standard_normal_white_and_independent_between_channels_and_seeds() -> None:
    """Each statistic of the noise may differ from its true value by five standard deviations."""
    five = 5 / math.sqrt(SAMPLES)
    streams = np.column_stack([normals(seed) for seed in (1, 2, 3)])
    assert np.abs(streams.mean(axis=0)).max() < five
    assert np.abs(streams.var(axis=0) - 1).max() < five * math.sqrt(2)
    assert np.abs(stats.skew(streams)).max() < five * math.sqrt(6)
    assert np.abs(stats.kurtosis(streams)).max() < five * math.sqrt(24)
    assert stats.kstest(streams, "norm").pvalue.min() > 1e-3
    assert np.abs(np.corrcoef(streams.T) - np.eye(6)).max() < five
    for lag in (1, 2, 3, 10, 1000):
        assert np.abs(streams[lag:].T @ streams[:-lag]).max() / (SAMPLES - lag) < five


@pytest.mark.parametrize("steps_in_a_period", [1, 2, 10])
def test_noise_is_drawn_at_multiples_of_its_period_and_held_in_between(
    steps_in_a_period: int,
) -> None:
    found = normals(1, 5000 * steps_in_a_period + 1, 1e-3 / steps_in_a_period)
    expected = np.repeat(normals(1)[:5001], steps_in_a_period, axis=0)
    np.testing.assert_array_equal(found, expected[: len(found)])


def test_noise_in_steps_that_do_not_fit_its_period() -> None:
    """GIVEN steps of 16 2/3 noise periods, THEN only every third step ends at a noise sample."""
    found = normals(1, 1201, 1 / 60)
    last = [50 * k // 3 for k in range(len(found))]
    np.testing.assert_array_equal(found, normals(1)[last])


def test_noise_does_not_depend_on_a_last_step_of_a_moment() -> None:
    """GIVEN a tiny last step, as OMSimulator makes it after rounding errors of its time."""
    with FMI2("AwasPlant").initialise({"noise.tau_variance": 1.0}) as fmu:
        t = 0.0
        for _ in range(2000):
            assert fmu.step(t, 1e-3) == OK
            t += 1e-3
        before = fmu.get("tau_measured")
        assert before == normals(1)[2000, 0]
        assert t != 2.0
        assert fmu.step(t, 1e-13) == OK
        assert fmu.get("tau_measured") == before
        # THEN the tiny step does not shift the times of later noise samples.
        assert fmu.step(t + 1e-13, 1e-3) == OK
        assert fmu.get("tau_measured") == normals(1)[2001, 0]


def test_a_scenario_draws_noise_at_its_own_sampling_times() -> None:
    """GIVEN noise with a sample period, THEN the noise samples do not depend on the step size T."""
    table1 = scenario("table1")
    plant = replace(
        table1.plant, start={"noise.tau_variance": 1.0}, inputs={}, record=["tau_measured"]
    )
    short = replace(table1, plant=plant, estimators={}, comparisons=[], duration=0.02, T=2e-4)
    np.testing.assert_array_equal(run(short, 1).plant["tau_measured"], normals(1)[:101, 0])
    slower = replace(plant, start={**plant.start, "noise.samplePeriod": 4e-4})
    held = run(replace(short, plant=slower), 1).plant["tau_measured"]
    np.testing.assert_array_equal(held, normals(1)[np.arange(101) // 2, 0])


def test_noise_is_that_of_the_paper_by_default_and_not_scaled_by_the_gain() -> None:
    run = run_awas(
        1e-3, np.zeros((100, 3)), {"sensor.gain": 1.03}, ["tau_measured", "tau_e_measured"]
    )
    expected = normals(1)[:100] * np.sqrt([1e-5, 1e-3])  # (32), (33)
    np.testing.assert_array_equal(run["tau_measured"], expected[:, 0])
    np.testing.assert_array_equal(run["tau_e_measured"], expected[:, 1])
