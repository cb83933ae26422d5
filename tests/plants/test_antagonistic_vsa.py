"""AntagonisticVsaPlant.fmu against the paper's equations solved by scipy, and against physics."""

from collections.abc import Iterable, Mapping

import numpy as np

import reference_joints
from plant_runs import QUIET, Array, relative_error, run_plant, times
from reference_joints import round_to_counts

INPUTS = ("tau_1", "tau_2", "tau_ext")
STATES = ("q", "theta_1", "theta_2", "q_dot", "theta_dot_1", "theta_dot_2")
# Two different motors, so that a mix-up shows.
UNEQUAL = {
    **{"link.M": 0.03, "link.D_q": 0.04, "link.mgl": 0.3},
    **{"motor_1.B": 2e-5, "motor_1.D_theta": 1e-3, "motor_1.gamma": 50.0},
    **{"motor_2.B": 3e-5, "motor_2.D_theta": 2e-3, "motor_2.gamma": 60.0},
    **{"spring_1.k": 0.003, "spring_1.a": 8.0, "spring_2.k": 0.002, "spring_2.a": 10.0},
}


def run(
    h: float, torques: Array, start: Mapping[str, float], record: Iterable[str] = STATES
) -> dict[str, Array]:
    return run_plant("AntagonisticVsaPlant", INPUTS, h, torques, start, record)


def test_friction_gravity_and_external_torque_enter_as_in_the_equations() -> None:
    h, coulomb = 1e-2, {"link": 0.05, "motor_1": 0.02, "motor_2": 0.01}
    start = {**UNEQUAL, **{f"{of}.tau_coulomb": value for of, value in coulomb.items()}}
    initial = np.array([0.1, -0.5, 0.6, 0.5, -0.2, 0.3])
    t = times(h, 1.0)
    tau_1, tau_2 = 0.1 * np.sin(2 * np.pi * 2 * t) - 0.05, 0.05 * np.cos(2 * np.pi * t)
    torques = np.column_stack([tau_1, tau_2, 0.3 * np.sin(2 * np.pi * 1.1 * t)])
    reference = reference_joints.solve(reference_joints.pair(start), h, torques, initial)
    at = {f"initial.{name}": value for name, value in zip(STATES, initial, strict=True)}
    assert relative_error(run(h, torques, {**start, **at}), reference).max() < 1e-8


def test_torque_and_stiffness_are_those_of_the_transmissions() -> None:
    t = times(1e-3, 0.5)
    torques = np.column_stack([0.1 * np.sin(9 * t), -0.1 * np.sin(5 * t), np.cos(5 * t)])
    names = [f"{name}_{i}" for i in (1, 2) for name in ("phi", "tau_e", "sigma")]
    start = {**UNEQUAL, "initial.theta_1": -0.5, "initial.theta_2": 0.6}
    out = run(1e-3, torques, start, [*STATES, *names, "sigma"])
    for i in (1, 2):
        k, a = UNEQUAL[f"spring_{i}.k"], UNEQUAL[f"spring_{i}.a"]
        phi = out["q"] - out[f"theta_{i}"]
        assert np.ptp(phi) > 0.1
        np.testing.assert_allclose(out[f"phi_{i}"], phi, rtol=0, atol=1e-15)
        np.testing.assert_allclose(out[f"tau_e_{i}"], k * np.sinh(a * phi), rtol=1e-11, atol=1e-14)
        np.testing.assert_allclose(out[f"sigma_{i}"], k * a * np.cosh(a * phi), rtol=1e-11)
    np.testing.assert_array_equal(out["sigma"], out["sigma_1"] + out["sigma_2"])


def test_encoders_and_sensors_are_those_of_their_side() -> None:
    angles, counts = ("q", "theta_1", "theta_2"), (700.0, 300.0, 500.0)
    encoders = {f"encoder.{name}": n for name, n in zip(angles, counts, strict=True)}
    measured = ["q_measured", "theta_measured_1", "theta_measured_2"]
    sensors = [f"{n}_{i}" for i in (1, 2) for n in ("tau_e", "tau_measured", "tau_e_measured")]
    t = times(1e-2, 1.0)
    torques = np.column_stack([0.1 * np.sin(9 * t), -0.1 * np.sin(5 * t), np.cos(5 * t)])
    start = {**QUIET, **encoders, "sensor.gain": 1.03}
    out = run(1e-2, torques, start, [*angles, *measured, *sensors])
    for name, reading, n in zip(angles, measured, counts, strict=True):
        expected = round_to_counts(out[name], n)
        np.testing.assert_allclose(out[reading], expected, rtol=1e-14, err_msg=reading)
        assert len(np.unique(expected)) > 10
    for i in (1, 2):
        np.testing.assert_allclose(out[f"tau_measured_{i}"], torques[:, i - 1], rtol=0, atol=1e-15)
        np.testing.assert_array_equal(out[f"tau_e_measured_{i}"], 1.03 * out[f"tau_e_{i}"])
