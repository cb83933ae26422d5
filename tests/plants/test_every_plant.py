"""What the plants share: large torques are taken, and extremes are refused."""

import time

import pytest

import sigmahat
from fmi_instance import ERROR, OK, Instance


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
