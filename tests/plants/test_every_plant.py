"""What the plants share: friction of the link, the torque sensor, names, refusal of extremes."""

from __future__ import annotations

import math
import time

import fmpy
import numpy as np
import pytest

import reference_joints
import sigmahat
from fmi_instance import ERROR, OK, Instance
from plant_runs import QUIET, STATES, relative_error, run_awas, sinusoids, times
from reference_joints import COULOMB_VELOCITY
from reference_plant import SCREW, Awas

PLANTS = ["AwasPlant", "FlexibleJointPlant", "AntagonisticVsaPlant", "RealJointPlant"]


@pytest.mark.parametrize("h", [1e-3, 1e-2])
def test_coulomb_friction_of_the_awas_link_enters_as_in_the_equations(h: float) -> None:
    plant = Awas(link_mgl=1.0, link_tau_coulomb=0.05, motor_tau_coulomb=0.02)
    start = {"link.mgl": 1.0, "link.tau_coulomb": 0.05, "motor.tau_coulomb": 0.02}
    torques = sinusoids(times(h, 0.4), (0.3, 2.0), (8.0, 3.0), (5.0, 1.1))
    at_rest = np.array([0.0, 0.0, 0.030 / SCREW, 0.0, 0.0, 0.0])
    reference = reference_joints.solve(plant.derivative, h, torques, at_rest)
    assert relative_error(run_awas(h, torques, start), reference).max() < 1e-7


@pytest.mark.parametrize("tau_ext", [0.03, 0.2])
def test_coulomb_friction_holds_the_link_until_the_torque_exceeds_it(tau_ext: float) -> None:
    start = {"link.tau_coulomb": 0.05, "spring.k_s": 0.0}
    out = run_awas(1e-2, np.tile([0.0, 0.0, tau_ext], (1001, 1)), start, ["q_dot"])
    speed = out["q_dot"][-1]
    balance = 0.15 * speed + 0.05 * math.tanh(speed / COULOMB_VELOCITY)
    assert balance == pytest.approx(tau_ext, rel=1e-6)
    if tau_ext < 0.05:
        assert speed < COULOMB_VELOCITY
    else:
        assert speed == pytest.approx((tau_ext - 0.05) / 0.15, rel=1e-6)


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


def test_what_is_the_same_in_two_plants_has_the_same_name_and_unit() -> None:
    awas, single, pair, real = (
        {v.name: v for v in fmpy.read_model_description(sigmahat.fmu(name)).modelVariables}
        for name in PLANTS
    )
    assert set(single) - set(awas) == {"spring.k_1", "spring.k_3"}
    own = {"spring_1.k", "spring_1.a", "spring_2.k", "spring_2.a"}
    assert {name.replace("_1", "").replace("_2", "") for name in set(pair) - own} <= set(single)
    assert set(single) < set(real)
    for name, other in [
        *((n, awas) for n in set(single) & set(awas)),
        *((n, real) for n in single),
    ]:
        for attribute in ("causality", "variability", "unit", "start", "min", "max"):
            assert getattr(single[name], attribute) == getattr(other[name], attribute), name


@pytest.mark.parametrize("name", PLANTS)
def test_new_parameters_of_joints_are_neutral(name: str) -> None:
    variables = {v.name: v for v in fmpy.read_model_description(sigmahat.fmu(name)).modelVariables}
    for parameter, neutral in (("link.tau_coulomb", 0.0), ("sensor.gain", 1.0)):
        variable = variables[parameter]
        assert (variable.causality, variable.variability) == ("parameter", "tunable")
        assert float(variable.start) == neutral


@pytest.mark.parametrize(
    ("name", "bad"),
    [
        ("FlexibleJointPlant", {"tau": 1e300}),
        ("FlexibleJointPlant", {"tau_ext": -1e300}),
        ("FlexibleJointPlant", {"spring.k_3": 1e308}),
        ("AntagonisticVsaPlant", {"tau_1": 1e300}),
        ("AntagonisticVsaPlant", {"tau_2": -1e300}),
        ("AntagonisticVsaPlant", {"tau_ext": 1e300}),
        ("AntagonisticVsaPlant", {"spring_1.a": 1e5}),  # sinh overflows at once
    ],
)
def test_a_step_without_a_solution_is_refused_and_leaves_the_plant_as_it_was(
    name: str, bad: dict[str, float]
) -> None:
    def bend(plant: Instance) -> list[str]:
        angle = "initial.theta" if name == "FlexibleJointPlant" else "initial.theta_1"
        plant.initialise({angle: 0.1})
        assert plant.step(0.0, 1e-3) == OK
        return [n for n, v in plant.variables.items() if v.causality == "output"]

    with Instance(sigmahat.fmu(name)) as plant, Instance(sigmahat.fmu(name)) as other:
        outputs = bend(plant)
        before = plant.get_all(outputs)
        good = {key: plant.get(key) for key in bad}
        plant.set_all(bad)
        assert plant.step(1e-3, 1e-3) == ERROR
        assert "no solution" in plant.messages[-1][2]
        assert plant.get_all(outputs) == before
        plant.set_all(good)
        assert plant.step(1e-3, 1e-3) == OK

        bend(other)
        assert other.step(1e-3, 1e-3) == OK
        assert plant.get_all(outputs) == other.get_all(outputs)


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
