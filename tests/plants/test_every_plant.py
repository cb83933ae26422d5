"""What the plants share: friction of the link, the torque sensor, names, refusal of extremes."""

from __future__ import annotations

import time

import numpy as np
import pytest

import sigmahat
from fmi_instance import ERROR, OK, Instance
from plant_runs import QUIET, STATES, run_awas, sinusoids, times


def test_gain_of_the_sensor_scales_the_torque_and_not_its_noise() -> None:
    torques = sinusoids(times(1e-3, 0.2), (0.3, 2.0), (8.0, 3.0), (0.0, 0.0))
    record = [*STATES, "tau_e", "tau_e_measured", "tau_measured"]
    exact, wrong = (run_awas(1e-3, torques, {"sensor.gain": gain}, record) for gain in (1.0, 1.03))
    added = wrong["tau_e_measured"] - exact["tau_e_measured"]
    np.testing.assert_allclose(added, 0.03 * exact["tau_e"], rtol=0, atol=1e-14)
    assert np.ptp(added) > 0.01
    for name in (*STATES, "tau_e", "tau_measured"):
        np.testing.assert_array_equal(wrong[name], exact[name])
    quiet = run_awas(1e-3, torques, {**QUIET, "sensor.gain": 1.03}, record)
    np.testing.assert_array_equal(quiet["tau_e_measured"], 1.03 * quiet["tau_e"])


@pytest.mark.parametrize(
    ("name", "torque"), [("AwasPlant", "tau"), ("AntagonisticVsaPlant", "tau_1")]
)
def test_an_absurd_torque_is_refused_soon_and_named(name: str, torque: str) -> None:
    with Instance(sigmahat.fmu(name)) as fmu:
        fmu.initialise({})
        fmu.set_all({torque: -1e9})
        begin = time.process_time()
        assert fmu.step(0.0, 1e-3) == ERROR
        assert time.process_time() - begin < 0.5  # it took 2 s and more; 10 ms are usual
        message = fmu.messages[-1][2]
        assert "more than 11000 internal steps" in message
        assert f"the largest input is {torque} = -1e+09" in message
        fmu.set_all({torque: 0.0})
        assert fmu.step(0.0, 1e-3) == OK


@pytest.mark.parametrize("name", ["FlexibleJointPlant", "RealJointPlant"])
def test_the_torques_of_a_large_robot_are_accepted(name: str) -> None:
    """Jumps of 1e5 N.m on the link and of 1e3 N.m on the axis of the motor."""
    joint = {"link.M": 1e3, "motor.B": 0.02, "motor.gamma": 200.0, "spring.k_1": 1e6}
    with Instance(sigmahat.fmu(name)) as fmu:
        fmu.initialise({**joint, "link.tau_coulomb": 100.0, "motor.tau_coulomb": 1.0})
        for k in range(500):
            jump = 1.0 if k // 50 % 2 else -1.0
            fmu.set_all({"tau": 1e3 * jump, "tau_ext": 1e5 * jump})
            assert fmu.step(k * 1e-3, 1e-3) == OK, fmu.messages
