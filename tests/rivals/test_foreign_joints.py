"""The joints in MuJoCo are what their parameters say, and their logs what they do.

The seeds of the comparison stay unused here: these are others.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from importlib.util import find_spec
from typing import Any

import numpy as np
import pytest

from rivals.joints import catalogue
from rivals.joints.logs import log
from rivals.joints.parameters import Arm, Tendons, VariableStiffness
from rivals.joints.simulation import SAMPLE_PERIOD, STEP, Run, count
from rivals.joints.simulation import run as simulate
from rivals.records import Array

SECONDS = 4.0  # of a run here
SEED = 1
HARDENING = 2  # a seed of springs that harden
TOUCHING = 3  # a seed of an arm that touches the floor soon


@pytest.fixture(scope="module", autouse=True)
def engine() -> None:
    """Skips where MuJoCo is missing. It is too large for every run of the tests."""
    if find_spec("mujoco") is None:
        pytest.skip("MuJoCo is not installed; to install it: cmake --workflow --preset rivals")


def shortened(kind: str, seed: int = SEED) -> Any:
    """A joint, and the first seconds of what its drives do."""
    joint, samples = catalogue.drawn(kind, seed), round(SECONDS / SAMPLE_PERIOD)
    drives = [
        replace(each, feed_forward=each.feed_forward[:samples], reference=each.reference[:samples])
        for each in joint.drives
    ]
    return replace(joint, drives=tuple(drives))


@pytest.fixture(scope="module", params=catalogue.KINDS)
def joint(request: pytest.FixtureRequest) -> Any:
    return shortened(request.param)


@pytest.fixture(scope="module")
def run(joint: Any) -> Run:
    return simulate(joint)


def fitted(columns: Mapping[str, Array], y: Array) -> dict[str, float]:
    """Least squares."""
    matrix = np.column_stack([*columns.values()])
    scale = np.abs(matrix).max(axis=0)
    solution = np.linalg.lstsq(matrix / scale, y, rcond=None)[0] / scale
    return dict(zip(columns, map(float, solution), strict=True))


def rms(x: Array) -> float:
    return float(np.sqrt(np.mean(x**2)))


def test_the_motor_obeys_its_equation(joint: Any, run: Run) -> None:
    """B g^2 theta'' + D g^2 theta' = g tau + friction + tau_e + damper, all on the motor."""
    motor, x = joint.motors[joint.observed], run.signals
    left = motor.inertia * x["theta_ddot"] + motor.D * motor.gear**2 * x["theta_dot"]
    right = motor.gear * run.torque + x["friction"] + x["tau_e"] + x["damper"]
    # The flange of an elbow moves with the arm.
    assert rms(left - right) < 2e-3 * rms(right - x["tau_e"])


def test_least_squares_finds_inertia_damping_and_stiffness(joint: Any, run: Run) -> None:
    """The torque of the spring enters by phi only, the rest by signals that a log would have."""
    motor, x = joint.motors[joint.observed], run.signals
    y = motor.gear * run.torque + x["friction"] + x["damper"]
    columns = {"inertia": x["theta_ddot"], "damping": x["theta_dot"]}
    if isinstance(joint, VariableStiffness):  # no formula for them: their torque is taken as it is
        found = fitted({**columns, "tau_e": -x["tau_e"]}, y)
        assert found["tau_e"] == pytest.approx(1, rel=2e-3)
    else:
        spring = joint.springs[joint.observed]
        columns["phi"] = -x["phi"]
        if spring.k_3:
            columns["phi^3"] = -(x["phi"] ** 3)
        found = fitted(columns, y)
        assert found["phi"] == pytest.approx(spring.stiffness, rel=5e-3)
    assert found["inertia"] == pytest.approx(motor.inertia, rel=5e-3)
    assert found["damping"] == pytest.approx(motor.D * motor.gear**2, rel=1e-2)


def test_the_acceleration_is_that_of_the_positions(run: Run) -> None:
    """The derivative of the engine agrees with differences over a sample, but for its jerks."""
    theta = run.signals["theta"]
    smooth = np.convolve(run.signals["theta_ddot"], [0.25, 0.5, 0.25], mode="valid")
    error = (theta[2:] - 2 * theta[1:-1] + theta[:-2]) / SAMPLE_PERIOD**2 - smooth
    assert np.median(np.abs(error)) < 0.02 * rms(smooth)


def test_the_true_stiffness_is_the_slope_of_the_torque(run: Run) -> None:
    """Along the run: d tau_e = stiffness d phi; a stiffness motor turns slowly."""
    x = run.signals
    d_phi, d_tau = np.diff(x["phi"]), np.diff(x["tau_e"])
    error = d_tau - (x["stiffness"][1:] + x["stiffness"][:-1]) / 2 * d_phi
    assert rms(error) < 2e-2 * rms(d_tau)
    assert (x["stiffness"] > 0).all()


@pytest.mark.slow("three times as many steps")
def test_smaller_steps_give_the_same_motion(joint: Any, run: Run) -> None:
    """Of the first order: a half as large step leaves a half as large error. Without the floor:
    when a tip touches it is a matter of chance."""
    if isinstance(joint, Arm):
        joint = replace(joint, floor=-10.0)
        run = simulate(joint)
    half = simulate(joint, STEP / 2)
    for name, limit in (("theta", 2e-3), ("phi", 2e-2)):
        change = run.signals[name] - half.signals[name]
        assert rms(change) < limit * rms(half.signals[name])


def pulled(tendons: Tendons, phi: Array, theta_c: Array) -> Array:
    """Torque of two tendons on the motor, in closed form."""
    x = tendons.travel * theta_c
    a, r = tendons.lever, tendons.eyelet
    torque = np.zeros_like(phi)
    for side in (-1, 1):
        alpha = phi + side * tendons.spread
        d = np.sqrt(a**2 + r**2 - 2 * a * r * np.cos(alpha))
        longer = d - tendons.length(tendons.spread) + x
        force = np.maximum(tendons.tension + tendons.stiffness * longer, 0)
        torque += force * a * r * np.sin(alpha) / d
    return torque


def test_the_tendons_pull_as_their_geometry_says() -> None:
    joint = shortened("variable_stiffness")
    x = simulate(joint).signals
    step = 1e-5
    torques = [pulled(joint.tendons, x["phi"] + shift, x["theta_c"]) for shift in (-step, 0, step)]
    np.testing.assert_allclose(x["tau_e"], torques[1], atol=1e-6 * np.abs(torques[1]).max())
    np.testing.assert_allclose(x["stiffness"], (torques[2] - torques[0]) / 2 / step, rtol=1e-5)
    assert np.ptp(x["theta_c"]) > 0.1 * joint.tendons.range_theta_c
    assert np.ptp(x["stiffness"]) > 0.05 * x["stiffness"].mean()


def test_the_tip_touches_the_floor() -> None:
    """The torque of a joint in contact is another one than without the floor."""
    joint = shortened("arm", TOUCHING)
    touching = simulate(joint).signals["tau_e"]
    free = simulate(replace(joint, floor=-10.0)).signals["tau_e"]
    assert rms(touching - free) > 0.02 * rms(free)


@pytest.mark.parametrize("kind", ["series_elastic", "arm"])
def test_a_spring_of_mujoco_hardens(kind: str) -> None:
    """Linear and cubic, as its polynomial says."""
    joint = shortened(kind, HARDENING)
    spring = joint.springs[joint.observed]
    x = simulate(joint).signals
    assert spring.k_3 > 0
    np.testing.assert_allclose(
        x["tau_e"], [spring.torque(phi) for phi in x["phi"]], rtol=1e-9, atol=1e-9
    )
    np.testing.assert_allclose(x["stiffness"], [spring.slope(phi) for phi in x["phi"]], rtol=1e-6)


def test_a_log_is_what_the_instruments_make_of_the_run(joint: Any, run: Run) -> None:
    motor, tools = joint.motors[joint.observed], joint.instruments[joint.observed]
    x, made = run.signals, log("a kind", SEED, run, joint, np.random.default_rng(SEED))
    known = made.known
    for read, true, counts in (
        (made.theta, x["theta"], known.counts_theta),
        (made.q, x["theta"] + x["phi"], known.counts_q),
    ):
        assert np.abs(read - true).max() <= count(counts) / 2 * (1 + 1e-9)
        np.testing.assert_allclose(read / count(counts), np.round(read / count(counts)), atol=1e-6)
    noise = made.tau - tools.gain * (run.command if tools.commanded else run.late)
    assert np.std(noise) == pytest.approx(known.noise_tau, rel=0.06)
    assert known.range_phi >= np.abs(x["phi"]).max()
    assert known.range_tau_e >= np.abs(made.tau_e).max()
    assert abs(known.B / motor.B - 1) < 5 * known.relative_std_B
    assert abs(known.D_theta / motor.D - 1) < 5 * known.relative_std_D_theta


def test_the_torque_in_the_log_is_early_or_late(joint: Any, run: Run) -> None:
    """A command comes before its torque, a measurement after it, by at most 3 ms."""
    tools = joint.instruments[joint.observed]
    seen = run.command if tools.commanded else run.late
    late = tools.delay + tools.lag if tools.commanded else -tools.delay
    shifted = run.torque[10:-10]
    errors = [rms(seen[10 + k : len(seen) - 10 + k] - shifted) for k in range(-10, 11)]
    assert abs(int(np.argmin(errors)) - 10 + late / SAMPLE_PERIOD) <= 1.5


def test_make_gives_the_same_log_every_time() -> None:
    one, other = (catalogue.make("series_elastic", SEED) for _ in range(2))
    assert (one.kind, one.seed) == ("series_elastic", SEED)
    assert one.sample_period == 1e-3
    for name in ("theta", "q", "tau", "theta_c", "tau_e", "stiffness"):
        assert getattr(one, name).shape == (20000,)
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert one.known == other.known
