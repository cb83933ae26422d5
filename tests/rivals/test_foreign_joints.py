"""The joints in MuJoCo and in Drake are what their parameters say, and their logs what they do.

The seeds of the comparison stay unused here: these are others.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from importlib.util import find_spec
from typing import Any

import numpy as np
import pytest

from gate import missing
from rivals.joints import catalogue
from rivals.joints.encoders import count
from rivals.joints.excitation import Drive
from rivals.joints.parameters import Arm, Motor
from rivals.joints.simulation import SAMPLE_PERIOD, STEP, Run
from rivals.records import Array

SECONDS = 4.0  # of a run here
SEED = 1
BUILDS = [*catalogue.BUILDS]


def need(engine: str) -> None:
    """Skips where the engine is missing."""
    if find_spec({"mujoco": "mujoco", "drake": "pydrake"}[engine]) is None:
        missing(engine, "cmake --build build --target packages_rivals")


def shortened(joint: Any) -> Any:
    """The first seconds of what its drives do."""
    samples = round(SECONDS / SAMPLE_PERIOD)

    def cut(drive: Drive) -> Drive:
        return replace(
            drive,
            feed_forward=drive.feed_forward[:samples],
            reference=drive.reference[:samples],
        )

    if isinstance(joint, Arm):
        shoulder, elbow = joint.drives
        return replace(joint, drives=(cut(shoulder), cut(elbow)))
    return replace(joint, drive=cut(joint.drive))


def observed(joint: Any) -> Motor:
    return joint.motors[joint.observed] if isinstance(joint, Arm) else joint.motor


@pytest.fixture(scope="module", params=BUILDS, ids="-".join)
def build_of(request: pytest.FixtureRequest) -> tuple[str, str]:
    kind, engine = request.param
    need(engine)
    return kind, engine


@pytest.fixture(scope="module")
def joint(build_of: tuple[str, str]) -> Any:
    return shortened(catalogue.drawn(*build_of, SEED))


@pytest.fixture(scope="module")
def run(build_of: tuple[str, str], joint: Any) -> Run:
    return catalogue.simulate(*build_of, joint)


def fitted(columns: Mapping[str, Array], y: Array) -> dict[str, float]:
    """Least squares."""
    matrix = np.column_stack([*columns.values()])
    scale = np.abs(matrix).max(axis=0)
    solution = np.linalg.lstsq(matrix / scale, y, rcond=None)[0] / scale
    return dict(zip(columns, map(float, solution), strict=True))


def differenced(x: Array) -> Array:
    """Acceleration from positions alone, as a log would give it, where both sides are there."""
    second: Array = (x[2:] - 2 * x[1:-1] + x[:-2]) / SAMPLE_PERIOD**2
    return second


def sharp(motor: Motor) -> Motor:
    """With dry friction that stops it soon, as in Drake."""
    return replace(motor, stiction_time=5 * STEP)


def rms(x: Array) -> float:
    return float(np.sqrt(np.mean(x**2)))


def test_the_motor_obeys_its_equation(joint: Any, run: Run) -> None:
    """B g^2 theta'' + D g^2 theta' = g tau + friction + tau_e + damper, all on the motor."""
    motor, x = observed(joint), run.signals
    left = motor.inertia * x["theta_ddot"] + motor.D * motor.gear**2 * x["theta_dot"]
    right = motor.gear * run.torque + x["friction"] + x["tau_e"] + x["damper"]
    # Drake takes the damping at the end of a step; and an elbow's flange moves with the arm.
    assert rms(left - right) < 2e-3 * rms(right - x["tau_e"])


def test_least_squares_finds_inertia_damping_and_stiffness(joint: Any, run: Run) -> None:
    """The torque of the spring enters by phi only, the rest by signals that a log would have."""
    motor, x = observed(joint), run.signals
    y = motor.gear * run.torque + x["friction"] + x["damper"]
    columns = {"inertia": x["theta_ddot"], "damping": x["theta_dot"]}
    if "tendons" in dir(joint):  # no formula for them: their torque is taken as it is
        found = fitted({**columns, "tau_e": -x["tau_e"]}, y)
        assert found["tau_e"] == pytest.approx(1, rel=2e-3)
    else:
        spring = joint.springs[joint.observed] if isinstance(joint, Arm) else joint.spring
        columns["phi"] = -x["phi"]
        if spring.k_3:
            columns["phi^3"] = -(x["phi"] ** 3)
        found = fitted(columns, y)
        assert found["phi"] == pytest.approx(spring.stiffness, rel=5e-3)
    assert found["inertia"] == pytest.approx(motor.inertia, rel=5e-3)
    assert found["damping"] == pytest.approx(motor.D * motor.gear**2, rel=1e-2)


def test_the_acceleration_is_that_of_the_positions(run: Run) -> None:
    """The derivative of the engine agrees with differences over a sample, but for its jerks."""
    x = run.signals
    smooth = np.convolve(x["theta_ddot"], [0.25, 0.5, 0.25], mode="valid")
    error = differenced(x["theta"]) - smooth
    assert np.median(np.abs(error)) < 0.02 * rms(smooth)


def test_the_true_stiffness_is_the_slope_of_the_torque(run: Run) -> None:
    """Along the run: d tau_e = stiffness d phi, while nothing else changes the torque."""
    x = run.signals
    d_phi, d_tau = np.diff(x["phi"]), np.diff(x["tau_e"])
    between = (x["stiffness"][1:] + x["stiffness"][:-1]) / 2
    error = d_tau - between * d_phi
    if np.ptp(x["theta_c"]):  # the tendons change by themselves, slowly
        error -= fitted({"d_theta_c": np.diff(x["theta_c"]) * x["phi"][1:]}, error)["d_theta_c"] * (
            np.diff(x["theta_c"]) * x["phi"][1:]
        )
    assert rms(error) < 2e-2 * rms(d_tau)
    assert (x["stiffness"] > 0).all()


def test_smaller_steps_give_the_same_motion(
    build_of: tuple[str, str], joint: Any, run: Run
) -> None:
    """Of the first order: a half as large step leaves a half as large error. Without the floor:
    when a tip touches it is a matter of chance."""
    if isinstance(joint, Arm):
        joint = replace(joint, floor=-10.0)
        run = catalogue.simulate(*build_of, joint)
    half = catalogue.simulate(*build_of, joint, STEP / 2)
    for name, limit in (("theta", 2e-3), ("phi", 2e-2)):
        change = run.signals[name] - half.signals[name]
        assert rms(change) < limit * rms(half.signals[name])


@pytest.mark.parametrize("kind", ["series_elastic", "arm"])
def test_both_engines_move_alike(kind: str) -> None:
    """The same parameters; but for the floor, and for the time in which MuJoCo's friction stops."""
    need("mujoco")
    need("drake")
    joint = shortened(catalogue.drawn(kind, "drake", SEED))
    if isinstance(joint, Arm):
        shoulder, elbow = (sharp(motor) for motor in joint.motors)
        joint = replace(joint, motors=(shoulder, elbow), floor=-10.0)
    else:
        joint = replace(joint, motor=sharp(joint.motor))
    one, other = (catalogue.simulate(kind, engine, joint).signals for engine in catalogue.ENGINES)
    for name in ("theta", "phi", "tau_e"):
        assert rms(one[name] - other[name]) < 5e-3 * rms(one[name])


def test_the_tendons_are_as_stiff_as_their_geometry_says() -> None:
    need("mujoco")
    joint = shortened(catalogue.drawn("variable_stiffness", "mujoco", SEED))
    x = catalogue.simulate("variable_stiffness", "mujoco", joint).signals
    middle = np.abs(x["phi"]) < 0.05 * np.abs(x["phi"]).max()
    expected = [joint.tendons.joint_stiffness(theta_c) for theta_c in x["theta_c"][middle]]
    assert len(expected) > 20
    np.testing.assert_allclose(x["stiffness"][middle], expected, rtol=1e-2)


def test_the_tip_touches_the_floor() -> None:
    """The torque of a joint in contact is another one than without the floor."""
    need("mujoco")
    joint = catalogue.drawn("arm", "mujoco", SEED)
    touching = catalogue.simulate("arm", "mujoco", joint).signals["tau_e"]
    free = catalogue.simulate("arm", "mujoco", replace(joint, floor=-10.0)).signals["tau_e"]
    assert rms(touching - free) > 0.02 * rms(free)


def test_a_log_is_what_the_instruments_make_of_the_run() -> None:
    need("mujoco")
    log = catalogue.make("series_elastic", "mujoco", SEED)
    joint = catalogue.drawn("series_elastic", "mujoco", SEED)
    x = catalogue.simulate("series_elastic", "mujoco", joint)
    tools, known = joint.instruments, log.known
    for read, true, counts in (
        (log.theta, x.signals["theta"], known.counts_theta),
        (log.q, x.signals["theta"] + x.signals["phi"], known.counts_q),
    ):
        assert np.abs(read - true).max() <= count(counts) / 2 * (1 + 1e-9)
        np.testing.assert_allclose(read / count(counts), np.round(read / count(counts)), atol=1e-6)
    torque = x.command if tools.commanded else x.late
    noise = log.tau - tools.gain * torque
    assert np.std(noise) == pytest.approx(known.noise_tau, rel=0.03)
    assert known.range_phi >= np.abs(x.signals["phi"]).max()
    assert known.range_tau_e >= np.abs(log.tau_e).max()
    np.testing.assert_array_equal(log.tau, catalogue.make("series_elastic", "mujoco", SEED).tau)
