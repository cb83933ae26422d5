"""The joints in MuJoCo are what their parameters say, and their logs what they do.

The seeds of the comparison stay unused here: these are others.
"""

from __future__ import annotations

from dataclasses import replace
from importlib.util import find_spec
from typing import Any

import numpy as np
import pytest

from rivals.joints import catalogue
from rivals.joints.logs import log
from rivals.joints.parameters import Tendons
from rivals.joints.simulation import SAMPLE_PERIOD, Run, count
from rivals.joints.simulation import run as simulate
from rivals.records import Array

SECONDS = 4.0  # of a run here
SEED = 1


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


def rms(x: Array) -> float:
    return float(np.sqrt(np.mean(x**2)))


def test_the_motor_obeys_its_equation(joint: Any, run: Run) -> None:
    """B g^2 theta'' + D g^2 theta' = g tau + friction + tau_e + damper, all on the motor."""
    motor, x = joint.motors[joint.observed], run.signals
    left = motor.inertia * x["theta_ddot"] + motor.D * motor.gear**2 * x["theta_dot"]
    right = motor.gear * run.torque + x["friction"] + x["tau_e"] + x["damper"]
    # The flange of an elbow moves with the arm.
    assert rms(left - right) < 2e-3 * rms(right - x["tau_e"])


def test_the_true_stiffness_is_the_slope_of_the_torque(run: Run) -> None:
    """Along the run: d tau_e = stiffness d phi; a stiffness motor turns slowly."""
    x = run.signals
    d_phi, d_tau = np.diff(x["phi"]), np.diff(x["tau_e"])
    error = d_tau - (x["stiffness"][1:] + x["stiffness"][:-1]) / 2 * d_phi
    assert rms(error) < 2e-2 * rms(d_tau)
    assert (x["stiffness"] > 0).all()


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
