"""FlexibleJointPlant.fmu against the paper's equations solved by scipy, and against physics."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache

import numpy as np
import pytest

import reference_joints
from plant_runs import Array, between, relative_error, run_plant, times

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
