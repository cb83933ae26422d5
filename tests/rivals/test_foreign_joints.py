"""The joints in MuJoCo are what their parameters say, and their logs what they do.

The seeds of the comparison stay unused here: these are others.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from rivals.draw import SAMPLE_PERIOD, drawn
from rivals.joint import Friction, Joint
from rivals.records import Array
from rivals.simulation import Run, log
from rivals.simulation import run as simulate

SECONDS = 4.0  # of a run here
SEED = 2  # its spring hardens
V, M, E = 0.3, 2.0, -3.0  # velocity, torque of the motor, torque from outside
S = math.exp(-((0.3 / 0.5) ** 1.5))
# Each written out on its own from the publication.
PUBLISHED = {
    "M1": (Friction(0.1), 0.1),
    "M2": (Friction(0.1, 0.2, 0.5, 1.5), 0.1 + S * 0.2),
    "M3": (Friction(0.1, 0, 0.5, 1.5, 0.05, 0.05), 0.1 + 0.05 * 5),
    "M4": (
        Friction(0.1, 0.2, 0.5, 1.5, 0.05, 0.05, 0.04, 0.04),
        0.1 + 0.05 * 5 + S * (0.2 + 0.04 * 5),
    ),
    "M5": (
        Friction(0.1, 0.2, 0.5, 1.5, 0.05, 0.03, 0.04, 0.02),
        0.1 + 0.19 + S * (0.2 + 0.14),
    ),
    "M6": (
        Friction(0.1, 0.2, 0.5, 1.5, 0.05, 0.03, 0.04, 0.02, 0.006, 0.007),
        0.1 + 0.19 + S * (0.2 + 0.14 + 0.006 * 4),
    ),
}


@pytest.mark.parametrize("model", PUBLISHED)
def test_friction_is_as_published(model: str) -> None:
    friction, expected = PUBLISHED[model]
    assert friction.budget(V, M, E) == pytest.approx(expected)
    assert friction.budget(-V, -M, -E) == pytest.approx(expected)


@cache
def ran() -> tuple[Joint, Run]:
    """A joint, and the first seconds of its run."""
    # MuJoCo is too large for every run of the tests.
    pytest.importorskip("mujoco", reason="to install MuJoCo: cmake --workflow --preset rivals")
    joint, samples = drawn(SEED), round(SECONDS / SAMPLE_PERIOD)
    drive = joint.drive
    drive = replace(
        drive, feed_forward=drive.feed_forward[:samples], reference=drive.reference[:samples]
    )
    joint = replace(joint, drive=drive)
    return joint, simulate(joint)


def rms(x: Array) -> float:
    return float(np.sqrt(np.mean(x**2)))


@pytest.mark.slow("a joint is simulated")
def test_the_motor_obeys_its_equation() -> None:
    """B g^2 theta'' + D g^2 theta' = g tau + friction + tau_e + damper, all on the motor."""
    joint, x = ran()
    motor = joint.motor
    left = motor.inertia * x["theta_ddot"] + motor.D * motor.gear**2 * x["theta_dot"]
    right = motor.gear * x["torque"] + x["friction"] + x["tau_e"] + x["damper"]
    assert rms(left - right) < 2e-3 * rms(right - x["tau_e"])


def test_the_true_stiffness_is_the_slope_of_the_torque() -> None:
    """The engine has the torque of a hardening spring, and the stiffness is its slope."""
    joint, x = ran()
    spring, step = joint.spring, 1e-5
    assert spring.k_3 > 0
    low, torque, high = (
        spring.stiffness * phi + spring.k_3 * phi**3
        for phi in (x["phi"] - step, x["phi"], x["phi"] + step)
    )
    np.testing.assert_allclose(x["tau_e"], torque, atol=1e-6 * np.abs(torque).max())
    np.testing.assert_allclose(x["stiffness"], (high - low) / 2 / step, rtol=1e-5)


def test_a_log_is_what_the_instruments_make_of_the_run() -> None:
    joint, x = ran()
    motor, tools = joint.motor, joint.instruments
    made = log(x, joint, np.random.default_rng(SEED))
    known = made.known
    for read, true, counts in (
        (made.theta, x["theta"], known.counts_theta),
        (made.q, x["theta"] + x["phi"], known.counts_q),
    ):
        count = 2 * math.pi / counts
        assert np.abs(read - true).max() <= count / 2 * (1 + 1e-9)
        np.testing.assert_allclose(read / count, np.round(read / count), atol=1e-6)
    noise = made.tau - tools.gain * x["command" if tools.commanded else "late"]
    assert np.std(noise) == pytest.approx(known.noise_tau, rel=0.06)
    assert known.range_phi >= np.abs(x["phi"]).max()
    assert known.range_tau_e >= np.abs(x["tau_e"]).max()
    assert abs(known.B / motor.B - 1) < 5 * known.relative_std_B
    assert abs(known.D_theta / motor.D - 1) < 5 * known.relative_std_D_theta
