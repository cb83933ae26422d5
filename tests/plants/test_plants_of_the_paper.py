"""AwAS and antagonistic device, against the paper's equations solved by scipy, and physics."""

import math

import numpy as np
import pytest

from plant_runs import QUIET, STATES, relative_error, run_awas, run_plant, sinusoids, times
from reference_joints import (
    SCREW,
    awas,
    flexibility_torque,
    lever_arm,
    pair,
    paper_tau,
    paper_tau_c,
    round_to_counts,
    solution,
    solve,
    stiffness,
)

RETRACTED = 0.030 / SCREW  # theta_c for a lever arm of 70 mm
AT_REST = np.array([0.0, 0.0, RETRACTED, 0.0, 0.0, 0.0])


def test_table1_is_the_solution_of_the_equations() -> None:
    h = 1e-3
    # A sinusoid interpolated linearly is smaller by (w h)^2 / 12, but for a ripple of mean zero.
    share = 1 - (0.2 * math.pi * h) ** 2 / 12
    states = solution(
        awas({}), lambda t: (share * paper_tau(t), share * paper_tau_c(t), 0.0), AT_REST, 15.0
    )
    t = times(h, 15.0)
    torques = sinusoids(t, (0.3, 0.1), (8.0, 0.1), (0.0, 0.0))
    run = run_awas(h, torques, record=STATES)
    assert relative_error(run, states(t).T).max() < 1e-7


def test_friction_gravity_and_external_torque_enter_as_in_the_equations() -> None:
    h = 1e-2
    start = {"link.mgl": 1.0, "link.tau_coulomb": 0.05, "motor.tau_coulomb": 0.02}
    torques = sinusoids(times(h, 0.4), (0.3, 2.0), (8.0, 3.0), (5.0, 1.1))
    reference = solve(awas(start), h, torques, AT_REST)
    assert relative_error(run_awas(h, torques, start, STATES), reference).max() < 1e-7


def test_held_torques_are_held() -> None:
    h = 1e-2
    torques = sinusoids(times(h, 0.5), (0.3, 1.0), (8.0, 1.0), (1.0, 2.0))
    run = run_awas(h, torques, QUIET, [*STATES, "tau_measured"], held=True)
    reference = [AT_REST]
    for held in torques[:-1]:
        piece = solve(awas({}), h, np.array([held, held]), reference[-1])
        reference.append(piece[1])
    assert relative_error(run, np.array(reference)).max() < 1e-8
    np.testing.assert_array_equal(run["tau_measured"][1:], torques[:-1, 0])


def test_outputs_are_those_of_the_state() -> None:
    torques = sinusoids(times(1e-3, 0.5), (0.5, 3.0), (8.0, 1.0), (2.0, 5.0))
    outputs = ["phi", "r", "tau_e", "sigma", "tau_e_measured", "tau_measured"]
    run = run_awas(1e-3, torques, QUIET, [*STATES, *outputs])
    phi, r = run["q"] - run["theta"], lever_arm(run["theta_c"])
    tau_e = flexibility_torque(r, phi)
    expected = (phi, r, tau_e, stiffness(r, phi), tau_e, torques[:, 0])
    for name, value in zip(outputs, expected, strict=True):
        np.testing.assert_allclose(run[name], value, rtol=1e-12, atol=1e-14, err_msg=name)


@pytest.mark.parametrize("counts", [40000.0, 7.0])
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


# The antagonistic device

OF_PAIR = ("tau_1", "tau_2", "tau_ext")
PAIR = ("q", "theta_1", "theta_2", "q_dot", "theta_dot_1", "theta_dot_2")
# Two different motors, so that a mix-up shows.
UNEQUAL = {
    **{"link.M": 0.03, "link.D_q": 0.04, "link.mgl": 0.3},
    **{"motor_1.B": 2e-5, "motor_1.D_theta": 1e-3, "motor_1.gamma": 50.0},
    **{"motor_2.B": 3e-5, "motor_2.D_theta": 2e-3, "motor_2.gamma": 60.0},
    **{"spring_1.k": 0.003, "spring_1.a": 8.0, "spring_2.k": 0.002, "spring_2.a": 10.0},
}


def test_of_the_pair_friction_gravity_and_external_torque_enter_as_in_the_equations() -> None:
    h, coulomb = 1e-2, {"link": 0.05, "motor_1": 0.02, "motor_2": 0.01}
    start = {**UNEQUAL, **{f"{of}.tau_coulomb": value for of, value in coulomb.items()}}
    initial = np.array([0.1, -0.5, 0.6, 0.5, -0.2, 0.3])
    t = times(h, 1.0)
    tau_1, tau_2 = 0.1 * np.sin(2 * np.pi * 2 * t) - 0.05, 0.05 * np.cos(2 * np.pi * t)
    torques = np.column_stack([tau_1, tau_2, 0.3 * np.sin(2 * np.pi * 1.1 * t)])
    reference = solve(pair(start), h, torques, initial)
    at = {f"initial.{name}": value for name, value in zip(PAIR, initial, strict=True)}
    run = run_plant("AntagonisticVsaPlant", OF_PAIR, h, torques, {**start, **at}, PAIR)
    assert relative_error(run, reference).max() < 1e-8


def test_outputs_of_the_pair_are_those_of_its_sides() -> None:
    angles, counts = ("q", "theta_1", "theta_2"), (700.0, 300.0, 500.0)
    encoders = {f"encoder.{name}": n for name, n in zip(angles, counts, strict=True)}
    measured = ["q_measured", "theta_measured_1", "theta_measured_2"]
    of_side = ("phi", "tau_e", "sigma", "tau_measured", "tau_e_measured")
    t = times(1e-3, 1.0)
    torques = np.column_stack([0.1 * np.sin(9 * t), -0.1 * np.sin(5 * t), np.cos(5 * t)])
    start = {**UNEQUAL, "initial.theta_1": -0.5, "initial.theta_2": 0.6}
    start |= {**QUIET, **encoders, "sensor.gain": 1.03}
    record = [*PAIR, *measured, *(f"{name}_{i}" for i in (1, 2) for name in of_side), "sigma"]
    out = run_plant("AntagonisticVsaPlant", OF_PAIR, 1e-3, torques, start, record)
    for i in (1, 2):
        k, a = UNEQUAL[f"spring_{i}.k"], UNEQUAL[f"spring_{i}.a"]
        phi = out["q"] - out[f"theta_{i}"]
        assert np.ptp(phi) > 0.1
        np.testing.assert_allclose(out[f"phi_{i}"], phi, rtol=0, atol=1e-15)
        np.testing.assert_allclose(out[f"tau_e_{i}"], k * np.sinh(a * phi), rtol=1e-11, atol=1e-14)
        np.testing.assert_allclose(out[f"sigma_{i}"], k * a * np.cosh(a * phi), rtol=1e-11)
        np.testing.assert_allclose(out[f"tau_measured_{i}"], torques[:, i - 1], rtol=0, atol=1e-15)
        np.testing.assert_array_equal(out[f"tau_e_measured_{i}"], 1.03 * out[f"tau_e_{i}"])
    np.testing.assert_array_equal(out["sigma"], out["sigma_1"] + out["sigma_2"])
    for name, reading, n in zip(angles, measured, counts, strict=True):
        expected = round_to_counts(out[name], n)
        np.testing.assert_allclose(out[reading], expected, rtol=1e-14, err_msg=reading)
        assert len(np.unique(expected)) > 10
