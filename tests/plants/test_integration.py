"""Tests of the encoders of the plants, and of their integrator in comparison with scipy.

The tests in tests/modelica compare the equations of all plants with the Modelica models.
"""

import math

import numpy as np
import pytest

from plant_runs import QUIET, STATES, Array, relative_error, run_awas, run_plant, sinusoids, times
from reference_joints import (
    SCREW,
    awas,
    paper_tau,
    paper_tau_c,
    round_to_counts,
    solution,
    solve,
)

RETRACTED = 0.030 / SCREW  # theta_c for a lever arm of 70 mm
AT_REST = np.array([0.0, 0.0, RETRACTED, 0.0, 0.0, 0.0])


def test_table1_is_the_solution_of_the_equations() -> None:
    h = 1e-3
    # Linear interpolation of a sine reduces its amplitude by (w h)^2 / 12, apart from ripple.
    share = 1 - (0.2 * math.pi * h) ** 2 / 12
    states = solution(
        awas, lambda t: (share * paper_tau(t), share * paper_tau_c(t), 0.0), AT_REST, 15.0
    )
    t = times(h, 15.0)
    torques = sinusoids(t, (0.3, 0.1), (8.0, 0.1), (0.0, 0.0))
    run = run_awas(h, torques, record=STATES)
    assert relative_error(run, states(t).T).max() < 1e-7


def test_held_torques_are_held() -> None:
    h = 1e-2
    torques = sinusoids(times(h, 0.5), (0.3, 1.0), (8.0, 1.0), (1.0, 2.0))
    run = run_awas(h, torques, QUIET, [*STATES, "tau_measured"], held=True)
    reference = [AT_REST]
    for held in torques[:-1]:
        piece = solve(awas, h, np.array([held, held]), reference[-1])
        reference.append(piece[1])
    assert relative_error(run, np.array(reference)).max() < 1e-8
    np.testing.assert_array_equal(run["tau_measured"][1:], torques[:-1, 0])


@pytest.mark.parametrize("counts", [40000.0, 7.0, 0.0])
def test_encoders_round_to_the_nearest_count(counts: float) -> None:
    names = ("q", "theta", "theta_c")
    torques = sinusoids(times(1e-3, 1.0), (0.5, 1.0), (8.0, 0.5), (0.0, 0.0))
    measured = [f"{name}_measured" for name in names]
    encoders = {f"encoder.{name}": counts for name in names}
    run = run_awas(1e-3, torques, encoders, [*names, *measured])
    for name in names:
        expected = round_to_counts(run[name], counts)
        np.testing.assert_allclose(run[f"{name}_measured"], expected, rtol=1e-14, err_msg=name)
        assert len(np.unique(expected)) > 1


def test_a_jump_of_the_torque_is_stepped_over() -> None:
    """GIVEN a spring with a dead zone, at whose edge the torque jumps because of damping."""
    h, steps, gap, damping, k = 1e-3, 20, 1e-3, 0.1, 150.0
    M, D_q, B, D, gamma = 0.1, 0.15, 2.3e-5, 1e-3, 50.0

    def engaged(state: Array) -> Array:
        q, theta, q_dot, theta_dot = state
        tau_e = k * (q - theta - gap + damping * (q_dot - theta_dot))
        motor = (tau_e / gamma - D * gamma * theta_dot) / (B * gamma)
        return np.array([q_dot, theta_dot, -(tau_e + D_q * q_dot) / M, motor])

    start = {"spring.k_1": k, "spring.gap": gap, "spring.damping": damping, "initial.q_dot": 1.0}
    names = ("q", "theta", "q_dot", "theta_dot")
    found = run_plant(
        "RealJointPlant", ("tau", "tau_ext"), h, np.zeros((steps + 1, 2)), start, names
    )
    # The link moves freely with viscous friction until it has crossed the dead zone.
    at_edge = np.array([gap, 0.0, 1.0 - D_q / M * gap, 0.0])
    t_edge = -M / D_q * math.log(at_edge[2])
    states = solution(engaged, lambda _: (), at_edge, h * steps - t_edge)
    t = times(h, h * steps)[2:]  # rows after the edge
    reference = states(t - t_edge).T
    assert (reference[:, 0] - reference[:, 1] > gap).all()
    behind = {name: column[2:] for name, column in found.items()}
    assert relative_error(behind, reference).max() < 1e-7
