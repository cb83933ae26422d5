"""`sigmahat identify` says which motion to record next; a log of it then shows what was missing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from checked_logs import KNEE, Array
from plant_runs import run_plant, times
from sigmahat.identification.identify import identify
from sigmahat.identification.quantities import Identified, Motion, summary
from sigmahat.logs.configuration import read_configuration
from sigmahat.logs.log import LogInMemory

T = 1e-3
PLANT = {**KNEE, "motor.tau_coulomb": 0.01}
CONFIGURATION = """\
[ports.theta]
column = "theta"
[ports.q]
column = "q"
[ports.tau]
column = "tau"
[parameters]
motor.B = 1.1e-4
motor.gamma = 100
encoder.theta = 409600
encoder.q = 262144
"""


def identified(tau: Array, folder: Path) -> Identified:
    record = ("theta_measured", "q_measured", "tau_measured")
    torques = np.column_stack([tau, np.zeros_like(tau)])
    run = run_plant("RealJointPlant", ("tau", "tau_ext"), T, torques, PLANT, record)
    path = folder / "log.toml"
    path.write_text(CONFIGURATION)
    columns = {name.removesuffix("_measured"): run[name] for name in record}
    return identify(LogInMemory(Path("log"), columns), read_configuration(path))


def torque(motion: Motion) -> Array:
    """The torque that moves the motor so, from the equations of motor and link."""
    t = times(T, motion.duration)
    M, D_q, k = (PLANT[name] for name in ("link.M", "link.D_q", "spring.k_1"))
    B, D_theta, gamma = (PLANT[f"motor.{name}"] for name in ("B", "D_theta", "gamma"))
    tau, velocity = np.zeros_like(t), np.zeros_like(t)
    for A, f in motion.sines:
        s = 2j * np.pi * f
        load = M * s**2 + D_q * s
        tau_e = -k * load / (k + load)
        moved = A * np.exp(s * t)
        tau += np.imag((gamma * (B * s**2 + D_theta * s) - tau_e / gamma) * moved)
        velocity += np.imag(s * moved)
    return tau + PLANT["motor.tau_coulomb"] * np.tanh(velocity / 0.02)


@pytest.mark.slow("two logs of 20 s are simulated and identified")
def test_the_motion_makes_known_what_was_not(tmp_path: Path) -> None:
    # GIVEN a motion of 0.003 rad only
    first = identified(0.02 * np.sin(2 * np.pi * 3 * times(T, 20.0)), tmp_path)
    assert not first.quantities["D_theta"].determined
    (advice,) = [each for each in first.advice if each.name == "D_theta"]
    assert advice.motion is not None
    assert "D_theta is known to" in summary(first)
    # WHEN the motion is recorded that it proposes
    second = identified(torque(advice.motion), tmp_path).quantities["D_theta"]
    # THEN the value is known, about as well as was said
    assert second.determined
    assert abs(second.value - PLANT["motor.D_theta"]) <= second.half_width
    assert second.half_width / second.value == pytest.approx(advice.would_be, rel=1.0)


def test_nothing_is_proposed_where_all_is_known(tmp_path: Path) -> None:
    t = times(T, 20.0)
    tau = 0.2 * np.sin(2 * np.pi * 0.7 * t) + 0.15 * np.sin(2 * np.pi * 2.9 * t)
    assert identified(tau, tmp_path).advice == []
