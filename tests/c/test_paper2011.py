"""The Kalman filter of Paper2011, (9)-(11), against closed forms and physics.

test_stiffness_estimator.py compares velocity, residual and basis with those of the oracle.
"""

import math
from typing import Any

import numpy as np
import pytest

from c_library import Array, Library

T = 1e-3
COUNTS = 40000.0
COUNT = 2 * math.pi / COUNTS  # rad
W_S = COUNT / T  # rad/s
PAPER = {"kind": 1, "weighting": 1, "V_max": 10.0, "V_min": 0.1, "alpha": 6.0, "R": 10.0}
SETTINGS: dict[str, Any] = {**PAPER, "V_a": 3e9, "P_0": 1.0}


def position(kalman: Any) -> float:
    x: float = kalman.z + kalman.lag
    return x


def run(c: Library, z: Array, **settings: Any) -> Array:
    """Position and velocity at every sample [size: samples x 2]."""
    p = c.new("sh_filter_parameters", **{**SETTINGS, **settings})
    kalman = c.new("sh_kinematic_kalman")
    c.lib.sh_kinematic_kalman_start(kalman, p, z[0])
    track = [(position(kalman), kalman.x_dot)]
    for z_k in z[1:]:
        c.lib.sh_kinematic_kalman_step(kalman, p, z_k, T, W_S)
        track.append((position(kalman), kalman.x_dot))
    return np.array(track)


def test_starts_at_the_measurement_at_rest(c: Library) -> None:
    p = c.new("sh_filter_parameters", **{**SETTINGS, "P_0": 7.0})
    kalman = c.new("sh_kinematic_kalman", lag=1.0, x_dot=2.0, dx=4.0, dx_dot=5.0, P12=3.0)
    c.lib.sh_kinematic_kalman_start(kalman, p, -0.25)
    assert (kalman.dx, kalman.dx_dot) == (0.0, 0.0)
    assert (position(kalman), kalman.x_dot) == (-0.25, 0.0)
    assert (kalman.P11, kalman.P12, kalman.P22) == (7.0, 0.0, 7.0)


def test_at_rest_the_velocity_becomes_zero_and_never_denormal(c: Library) -> None:
    z = np.concatenate([0.1 * np.arange(100), np.full(5000, 9.9)])
    track = run(c, z)
    assert track[-1].tolist() == [9.9, 0.0]
    velocities = np.abs(track[:, 1])
    assert np.all((velocities == 0.0) | (velocities > 1e-100))


def test_missing_samples_do_not_disturb_the_filter(c: Library) -> None:
    """GIVEN a lost sample on a ramp, THEN the next step uses the time since the last sample."""
    p = c.new("sh_filter_parameters", **SETTINGS)
    kalman = c.new("sh_kinematic_kalman")
    c.lib.sh_kinematic_kalman_start(kalman, p, 0.0)
    for k in range(1, 1001):
        c.lib.sh_kinematic_kalman_step(kalman, p, 5.0 * T * k, T, W_S)
    c.lib.sh_kinematic_kalman_step(kalman, p, 5.0 * T * 1011, 11 * T, W_S)
    assert position(kalman) == pytest.approx(5.0 * T * 1011, rel=1e-12)
    assert kalman.x_dot == pytest.approx(5.0, rel=1e-9)


@pytest.mark.parametrize("kind", [1, 2])
def test_the_velocity_is_as_precise_at_a_large_position(c: Library, kind: int) -> None:
    """The same motion near zero and 2^22 rad away, both with the rounding of the far one."""
    near = COUNT * np.floor(np.linspace(0, 500, 1500) ** 1.1)
    far = near + 2.0**22
    velocity = [run(c, z, kind=kind)[:, 1] for z in (far - 2.0**22, far)]
    assert velocity[1] == pytest.approx(velocity[0], rel=1e-12, abs=1e-12)
