"""What the plants share: large torques are taken, extremes refused; sines move their motors."""

import math
import time

import numpy as np
import pytest

import sigmahat
from fmi_instance import ERROR, OK, Instance
from fmi_runs import PLANTS
from plant_runs import QUIET, run_plant, times


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


# The sines that plants add to the torques of their motors, so that they move without a source


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
    with Instance(sigmahat.fmu("AwasPlant")) as early, Instance(sigmahat.fmu("AwasPlant")) as late:
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
    """A communication point may differ a little from the end of the last step."""
    late, h, k = 0.9e-6, 1e-3, 2
    with Instance(sigmahat.fmu("AwasPlant")) as fmu:
        values = {"signal.tau.amplitude": 1.0, "signal.tau.frequency": 100.0}
        fmu.initialise({**values, "noise.tau_variance": 0.0})
        for i in range(k):
            assert fmu.step(i * h, h) == OK
        assert fmu.step(k * h + late, h) == OK
        expected = math.sin(2 * math.pi * 100.0 * ((k + 1) * h + late))
        assert fmu.get("tau_measured") == pytest.approx(expected, abs=1e-9)
