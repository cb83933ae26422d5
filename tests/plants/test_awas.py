"""AwasPlant.fmu against the paper's equations solved by scipy, and against physics."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from fmi_instance import ERROR, OK, Instance
from plant_runs import QUIET, STATES, relative_error, run_awas, sinusoids, times
from reference_joints import (
    SCREW,
    awas,
    flexibility_torque,
    lever_arm,
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
    run = run_awas(h, sinusoids(t, (0.3, 0.1), (8.0, 0.1), (0.0, 0.0)))
    assert relative_error(run, states(t).T).max() < 1e-7


def test_friction_gravity_and_external_torque_enter_as_in_the_equations() -> None:
    h = 1e-2
    start = {"link.mgl": 1.0, "link.tau_coulomb": 0.05, "motor.tau_coulomb": 0.02}
    torques = sinusoids(times(h, 0.4), (0.3, 2.0), (8.0, 3.0), (5.0, 1.1))
    reference = solve(awas(start), h, torques, AT_REST)
    assert relative_error(run_awas(h, torques, start), reference).max() < 1e-7


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


@pytest.fixture
def moving(plant_fmu: Path) -> Iterator[Instance]:
    """A plant after a step under torque."""
    with Instance(plant_fmu) as plant:
        plant.initialise()
        plant.set_all({"tau": 0.3, "tau_c": 1.0})
        assert plant.step(0.0, 1e-3) == OK
        yield plant


OUTPUTS = [*STATES, "tau_e", "theta_measured", "tau_measured", "tau_e_measured"]


@pytest.mark.parametrize(
    ("name", "value", "slope", "message"),
    [
        ("tau", math.nan, 0.0, "finite input tau, received nan"),
        ("tau_c", math.inf, 0.0, "finite input tau_c, received inf"),
        ("tau_ext", -math.inf, 0.0, "finite input tau_ext, received -inf"),
        ("tau", 1.7e308, 1.7e308, "finite input tau, received 1.7e+308 at its begin and inf"),
        ("tau_ext", 1e300, 0.0, "no solution"),
        ("tau_ext", 0.0, 1e26, "no solution"),  # has one at first
    ],
)
def test_a_step_with_a_bad_input_is_refused_and_leaves_the_plant_as_it_was(
    moving: Instance, plant_fmu: Path, name: str, value: float, slope: float, message: str
) -> None:
    before = moving.get_all(OUTPUTS)
    good = moving.get(name)
    moving.set(name, value)
    assert moving.set_derivative(name, slope) == OK
    assert moving.step(1e-3, 1.0) == ERROR
    assert message in moving.messages[-1][2]
    assert moving.get_all(OUTPUTS) == before

    moving.set(name, good)
    assert moving.set_derivative(name, 0.0) == OK
    assert moving.step(1e-3, 1e-3) == OK
    with Instance(plant_fmu) as other:
        other.initialise()
        other.set_all({"tau": 0.3, "tau_c": 1.0})
        assert other.step(0.0, 1e-3) == other.step(1e-3, 1e-3) == OK
        assert moving.get_all(OUTPUTS) == other.get_all(OUTPUTS)
