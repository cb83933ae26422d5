"""FlexibleJointPlant.fmu against the paper's equations solved by scipy, and against physics."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache

import numpy as np
import pytest

import reference_joints
from plant_runs import Array, between, relative_error, run_plant, slope, times

INPUTS = ("tau", "tau_ext")
STATES = ("q", "theta", "q_dot", "theta_dot")
AT_REST = np.zeros(4)


def run(
    h: float, torques: Array, start: Mapping[str, float], record: Iterable[str] = STATES
) -> dict[str, Array]:
    return run_plant("FlexibleJointPlant", INPUTS, h, torques, start, record)


@cache
def scenario(k_3: float) -> tuple[Array, Array]:
    """Torques and states every 10 ms under tau = 0.3 sin(2 pi 0.5 t), 15 s."""
    t = times(1e-2, 15.0)
    torques = np.column_stack([0.3 * np.sin(2 * np.pi * 0.5 * t), np.zeros_like(t)])
    equations = reference_joints.single({"spring.k_3": k_3})
    return torques, reference_joints.solve(equations, 1e-2, torques, AT_REST)


@pytest.mark.parametrize("steps", [1, 10, 100])
@pytest.mark.parametrize("k_3", [0.0, 3000.0])
@pytest.mark.slow("a Radau solution with tight tolerances")
def test_scenario_is_the_solution_of_the_equations(k_3: float, steps: int) -> None:
    torques, reference = scenario(k_3)
    states = run(1e-2 / steps, between(torques, steps), {"spring.k_3": k_3})
    assert relative_error(states, reference, steps).max() < 1e-9


@pytest.mark.slow("a Radau solution with tight tolerances for each step")
@pytest.mark.parametrize("h", [1e-3, 1e-2])
def test_friction_gravity_and_external_torque_enter_as_in_the_equations(h: float) -> None:
    start = {
        "link.M": 0.08,
        "link.D_q": 0.1,
        "link.mgl": 1.0,
        "link.tau_coulomb": 0.05,
        "motor.B": 3e-5,
        "motor.D_theta": 2e-3,
        "motor.gamma": 40.0,
        "motor.tau_coulomb": 0.02,
        "spring.k_1": 120.0,
        "spring.k_3": 5e4,
    }
    t = times(h, 1.0)
    torques = np.column_stack([0.3 * np.sin(2 * np.pi * 2 * t), np.sin(2 * np.pi * 1.1 * t)])
    reference = reference_joints.solve(reference_joints.single(start), h, torques, AT_REST)
    assert relative_error(run(h, torques, start), reference).max() < 1e-8


def test_energy_is_conserved_without_friction_and_torques() -> None:
    start = {
        "link.D_q": 0.0,
        "link.mgl": 1.0,
        "motor.D_theta": 0.0,
        "spring.k_3": 1e5,
        "initial.q": 0.35,
        "initial.theta": 0.3,
        "initial.q_dot": -3.0,
        "initial.theta_dot": 1.0,
    }
    q, theta, q_dot, theta_dot = run(1e-3, np.zeros((3001, 2)), start).values()
    phi = q - theta
    spring = 150.0 * phi**2 / 2 + 1e5 * phi**4 / 4
    energy = (0.1 * q_dot**2 + 2.3e-5 * 50.0**2 * theta_dot**2) / 2 + spring + 1 - np.cos(q)
    assert np.ptp(spring) > 0.1 * energy[0]  # it does go to and fro
    np.testing.assert_allclose(energy, energy[0], rtol=1e-7)


@pytest.mark.parametrize("k_3", [0.0, 3000.0, -1000.0])
def test_torque_and_stiffness_are_those_of_the_spring(k_3: float) -> None:
    start = {"spring.k_3": k_3, "initial.q": 0.1}
    t = times(1e-3, 0.5)
    torques = np.column_stack([np.sin(9 * t), np.cos(5 * t)])
    out = run(1e-3, torques, start, [*STATES, "phi", "tau_e", "sigma"])
    phi = out["q"] - out["theta"]
    np.testing.assert_allclose(out["phi"], phi, rtol=0, atol=1e-15)
    np.testing.assert_allclose(out["tau_e"], 150 * phi + k_3 * phi**3, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(out["sigma"], 150 + 3 * k_3 * phi**2, rtol=1e-12)


@pytest.mark.parametrize("phi", [-0.2, 0.0, 0.05])
def test_stiffness_is_the_derivative_of_the_torque(phi: float) -> None:
    stiffness, difference = slope("FlexibleJointPlant", {"spring.k_3": 3000.0}, phi)
    assert stiffness == pytest.approx(difference, rel=1e-6)


def test_link_comes_to_rest_where_spring_and_gravity_balance_the_torque() -> None:
    # The motor carries 50 * 0.01 N.m and no more: mgl sin q = 0.5 N.m.
    torques = np.tile([0.01, 0.0], (10001, 1))
    out = run(1e-2, torques, {"link.mgl": 1.0}, [*STATES, "tau_e"])
    assert out["tau_e"][-1] == pytest.approx(-0.5, rel=1e-6)
    assert out["q"][-1] == pytest.approx(np.pi / 6, rel=1e-6)
    assert out["theta"][-1] == pytest.approx(np.pi / 6 + 0.5 / 150.0, rel=1e-6)
