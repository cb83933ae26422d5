"""The joints in MuJoCo fit their parameters, and the logs fit the joints.

These seeds differ from the seeds of the comparison.
"""

import math
from dataclasses import replace
from functools import cache
from importlib.util import find_spec

import numpy as np
import pytest

from rivals.draw import KINDS, SAMPLE_PERIOD, drawn
from rivals.joint import DrawnJoint, Friction, Tendons
from rivals.records import STD_B, STD_D, Array
from rivals.simulation import Run, log
from rivals.simulation import run as simulate

SECONDS = 4.0  # of a run here
SEED = 1
FRICTION = Friction(0.1, 0.2, 0.5, 1.5, 0.05, 0.03, 0.04, 0.02, 0.006, 0.007)


@pytest.mark.parametrize(
    ("tau_m", "tau_e", "dry", "of_load", "quadratic"),
    [(2.0, -3.0, 0.19, 0.14, 0.006 * 4), (3.0, -2.0, 0.21, 0.16, 0.007 * 4)],
    ids=["backdriven", "driven"],
)
def test_friction_is_as_published(
    tau_m: float, tau_e: float, dry: float, of_load: float, quadratic: float
) -> None:
    """Model M6, which contains the others; written out on its own from the publication."""
    expected = 0.1 + dry + math.exp(-((0.3 / 0.5) ** 1.5)) * (0.2 + of_load + quadratic)
    for sign in (1, -1):
        budget = FRICTION.budget(sign * 0.3, sign * tau_m, sign * tau_e)
        assert budget == pytest.approx(expected)


@cache
def ran(kind: str) -> tuple[DrawnJoint, Run]:
    """A joint, and the first seconds of what its drives do."""
    if find_spec("mujoco") is None:  # too large for every run of the tests
        pytest.skip("MuJoCo is not installed; to install it: cmake --workflow --preset rivals")
    joint, samples = drawn(kind, SEED), round(SECONDS / SAMPLE_PERIOD)
    drives = tuple(
        replace(each, feed_forward=each.feed_forward[:samples], reference=each.reference[:samples])
        for each in joint.drives
    )
    joint = replace(joint, drives=drives)
    return joint, simulate(joint)


def rms(x: Array) -> float:
    return float(np.sqrt(np.mean(x**2)))


@pytest.mark.slow("a joint is simulated")
@pytest.mark.parametrize("kind", KINDS)
def test_the_motor_obeys_its_equation(kind: str) -> None:
    """B g^2 theta'' + D g^2 theta' = g tau + friction + tau_e + damper, all on the motor."""
    joint, x = ran(kind)
    motor = joint.motors[joint.observed]
    left = motor.inertia * x["theta_ddot"] + motor.D * motor.gear**2 * x["theta_dot"]
    right = motor.gear * x["torque"] + x["friction"] + x["tau_e"] + x["damper"]
    # The flange of an elbow moves with the arm.
    assert rms(left - right) < 2e-3 * rms(right - x["tau_e"])


@pytest.mark.parametrize("kind", KINDS)
def test_the_true_stiffness_is_the_slope_of_the_torque(kind: str) -> None:
    """Along the run: d tau_e = stiffness d phi; a stiffness motor turns slowly."""
    _, x = ran(kind)
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
    joint, x = ran("variable_stiffness")
    assert joint.tendons
    step = 1e-5
    torques = [pulled(joint.tendons, x["phi"] + shift, x["theta_c"]) for shift in (-step, 0, step)]
    np.testing.assert_allclose(x["tau_e"], torques[1], atol=1e-6 * np.abs(torques[1]).max())
    np.testing.assert_allclose(x["stiffness"], (torques[2] - torques[0]) / 2 / step, rtol=1e-5)
    assert np.ptp(x["theta_c"]) > 0.1 * joint.tendons.range_theta_c
    assert np.ptp(x["stiffness"]) > 0.05 * x["stiffness"].mean()


@pytest.mark.parametrize("kind", KINDS)
def test_a_log_is_what_the_instruments_make_of_the_run(kind: str) -> None:
    joint, x = ran(kind)
    motor, tools = joint.motors[joint.observed], joint.instruments[joint.observed]
    made = log(kind, SEED, x, joint, np.random.default_rng(SEED))
    known = made.known
    for read, true, counts in (
        (made.theta, x["theta"], known["encoder.theta"]),
        (made.q, x["theta"] + x["phi"], known["encoder.q"]),
    ):
        count = 2 * math.pi / counts
        assert np.abs(read - true).max() <= count / 2 * (1 + 1e-9)
        np.testing.assert_allclose(read / count, np.round(read / count), atol=1e-6)
    noise = made.tau - tools.gain * x["command" if tools.commanded else "late"]
    assert np.std(noise) == pytest.approx(known["noise.tau"], rel=0.06)
    assert known["range.phi"] >= np.abs(x["phi"]).max()
    assert known["prior.tau_e"] >= np.abs(made.tau_e).max()
    assert abs(known["motor.B"] / motor.B - 1) < 5 * STD_B
    assert abs(known["motor.D_theta"] / motor.D - 1) < 5 * STD_D
