"""`sigmahat identify` of a spring with a torque sensor, and the zero of a spring that hardens."""

from pathlib import Path

import numpy as np
import pytest
import tomlkit

from checked_logs import KNEE, joint_log
from recorded_logs import Columns, configured, in_memory
from sigmahat.checks.check import check
from sigmahat.checks.findings import Severity
from sigmahat.motor.identify import identify
from sigmahat.motor.write import update
from sigmahat.recording.configuration import checked_configuration
from sigmahat.recording.log import LogInMemory
from sigmahat.result.curve import stiffness_in_the_middle
from sigmahat.result.estimate import estimate

STIFFNESS = 14000.0  # [N.m/rad]
SENSOR = configured(
    *('modality = "Sensor"', "samplePeriod = 0.002", "rls.m = 1"),
    *("encoder.theta = 0", "encoder.q = 1048576"),
    ports=("theta", "q", "tau_e_sensor"),
)


def stiff_joint() -> Columns:
    """A stiff joint with a torque sensor, in closed form."""
    t = 2e-3 * np.arange(4000.0)
    noise = 0.03 * np.random.default_rng(1).standard_normal(len(t))
    phi = 8e-4 * np.sin(2 * np.pi * 0.7 * t) + 4e-4 * np.sin(2 * np.pi * 2.3 * t + 1.0)
    theta = 0.5 * np.sin(2 * np.pi * 0.4 * t)
    step = 2 * np.pi / 1048576
    q = step * np.round((theta + phi) / step)
    return {"t": t, "theta": theta, "q": q, "tau_e_sensor": STIFFNESS * phi + noise}


def test_a_stiff_joint_with_a_torque_sensor_needs_no_motor() -> None:
    log = LogInMemory(Path("log"), stiff_joint())
    document = tomlkit.parse(SENSOR)
    written = update(document, identify(log, in_memory(SENSOR)))
    assert {"parameters.range.phi", "parameters.noise.tau_e"} <= set(written)
    assert not any("motor" in key or key.endswith("noise.tau") for key in written)
    configuration = checked_configuration(document, Path("log.toml"))
    assert float(configuration.parameters["range.phi"]) == pytest.approx(1.44e-3, rel=0.05)
    found = estimate(log, configuration)
    _, _, interval = stiffness_in_the_middle(found.curve.branches[0])
    assert interval is not None
    low, high = interval
    assert low < STIFFNESS < high < 1.2 * low
    assert found.headline.endswith("confident")


def test_a_spring_on_a_test_bench_needs_no_position_of_a_motor() -> None:
    """GIVEN a fixed motor, and a configuration as `init` writes it: without a port of theta."""
    joint = stiff_joint()
    log = {**joint, "q": np.asarray(joint["q"]) - 0.5 * np.sin(2 * np.pi * 0.4 * joint["t"])}
    text = "\n".join(line for line in SENSOR.splitlines() if "theta" not in line)
    found = identify(LogInMemory(Path("log"), log), in_memory(text))
    assert found.phi == pytest.approx(1.2e-3, rel=0.05)
    assert found.tau_variance**0.5 == pytest.approx(0.03, rel=0.3)


def test_the_zero_of_a_spring_that_hardens_is_within_its_interval() -> None:
    """GIVEN a zero at 3 mrad of a spring that is several times stiffer at its ends."""
    plant = {**KNEE, "spring.k_1": 400.0, "spring.k_3": 2e6, "encoder.q_offset": 0.003}
    names = ("motor.B", "motor.gamma", "encoder.theta", "encoder.q")
    text = configured("samplePeriod = 0.001", *(f"{name} = {plant[name]}" for name in names))
    zero = identify(LogInMemory(Path("log"), joint_log(plant, 1e-3)), in_memory(text))
    found = zero.quantities["zero"]
    low, high = found.interval
    assert found.determined
    assert low < 0.003 < high


def test_an_early_torque_accuses_no_key() -> None:
    """GIVEN a damped spring, which looks like a torque that is measured too early."""
    plant = {**KNEE, "spring.damping": 0.01}
    names = ("motor.B", "motor.gamma", "encoder.theta", "encoder.q")
    text = configured(
        "samplePeriod = 0.001", "prior.B = 0.1", *(f"{name} = {plant[name]}" for name in names)
    )
    checked = check(LogInMemory(Path("log"), joint_log(plant, 1e-3)), in_memory(text))
    assert not checked.of(Severity.WRONG)
