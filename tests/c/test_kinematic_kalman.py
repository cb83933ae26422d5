"""The kinematic Kalman filter, (9)-(11), against closed forms and physics."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

import oracle
from c_library import Array, Library
from reference_plant import table1_recording

T = 1e-3
COUNTS = 40000.0
COUNT = 2 * math.pi / COUNTS  # rad
W_S = COUNT / T  # rad/s
PAPER = {"kind": 1, "weighting": 1, "V_max": 10.0, "V_min": 0.1, "alpha": 6.0, "R": 10.0}
SETTINGS: dict[str, Any] = {**PAPER, "V_a": 3e9, "P_0": 1.0}


def variance(c: Library, x_dot: float, w_s: float = W_S, **settings: Any) -> float:
    p = c.new("sh_filter_parameters", **{**SETTINGS, **settings})
    R: float = c.lib.sh_measurement_variance(p, x_dot, w_s)
    return R


def position(kalman: Any) -> float:
    x: float = kalman.z + kalman.lag
    return x


def run(c: Library, z: Array, w_s: float = W_S, dt: float = T, **settings: Any) -> Array:
    """Position and velocity at every sample [size: samples x 2]."""
    p = c.new("sh_filter_parameters", **{**SETTINGS, **settings})
    kalman = c.new("sh_kinematic_kalman")
    c.lib.sh_kinematic_kalman_start(kalman, p, z[0])
    track = [(position(kalman), kalman.x_dot)]
    for z_k in z[1:]:
        c.lib.sh_kinematic_kalman_step(kalman, p, z_k, dt, w_s)
        track.append((position(kalman), kalman.x_dot))
    return np.array(track)


def test_starts_at_the_measurement_at_rest(c: Library) -> None:
    p = c.new("sh_filter_parameters", **{**SETTINGS, "P_0": 7.0})
    kalman = c.new("sh_kinematic_kalman", lag=1.0, x_dot=2.0, dx=4.0, dx_dot=5.0, P12=3.0)
    c.lib.sh_kinematic_kalman_start(kalman, p, -0.25)
    assert (kalman.dx, kalman.dx_dot) == (0.0, 0.0)
    assert (position(kalman), kalman.x_dot) == (-0.25, 0.0)
    assert (kalman.P11, kalman.P12, kalman.P22) == (7.0, 0.0, 7.0)


@pytest.mark.parametrize("kind", [1, 2, 3])
def test_a_motor_at_rest_has_no_velocity(c: Library, kind: int) -> None:
    # GIVEN a motor at rest WHEN it is filtered THEN it stays where it is, without velocity
    track = run(c, np.full(200, 18.0), kind=kind)
    assert np.all(track == [18.0, 0.0])


def test_at_rest_the_velocity_becomes_zero_and_never_denormal(c: Library) -> None:
    z = np.concatenate([0.1 * np.arange(100), np.full(5000, 9.9)])
    track = run(c, z)
    assert track[-1].tolist() == [9.9, 0.0]
    velocities = np.abs(track[:, 1])
    assert np.all((velocities == 0.0) | (velocities > 1e-100))


@pytest.mark.parametrize("kind", [1, 2, 3])
@pytest.mark.parametrize("slope", [-4.0, 0.05, 12.0])
def test_a_ramp_is_followed_without_error(c: Library, kind: int, slope: float) -> None:
    # GIVEN a constant velocity, which (9) models exactly WHEN the filter has settled
    # THEN the errors of position and velocity are zero
    z = 3.0 + slope * T * np.arange(2000, dtype=np.float64)
    track = run(c, z, kind=kind)
    assert track[-1, 0] == pytest.approx(z[-1], rel=1e-12)
    assert track[-1, 1] == pytest.approx(slope, rel=1e-9)


def test_variance_falls_from_rest_to_fast_motion(c: Library) -> None:
    at_rest = 9.9 / (1 + math.exp(-6)) + 0.1
    assert variance(c, 0.0) == pytest.approx(at_rest, rel=1e-14)
    speeds = np.linspace(0, 4 * W_S, 50)
    values = [variance(c, speed) for speed in speeds]
    assert np.all(np.diff(values) < 0)
    assert variance(c, 1e6) == 0.1
    assert variance(c, 1e300) == 0.1  # here the exponential overflows


@pytest.mark.parametrize("weighting", [1, 2])
def test_without_quantisation_the_variance_is_the_smallest(c: Library, weighting: int) -> None:
    assert variance(c, 0.0, w_s=0.0, weighting=weighting) == 0.1


def test_covariance_settles_at_the_riccati_solution(c: Library) -> None:
    # GIVEN constant R WHEN the filter has settled THEN P solves the algebraic Riccati equation
    V_a, R = 3e9, 10.0
    A = np.array([[1, T], [0, 1]])
    C = np.array([[1.0, 0.0]])
    Gamma = np.array([[T * T / 2], [T]])
    predicted = solve_discrete_are(A.T, C.T, V_a * Gamma @ Gamma.T, np.array([[R]]))
    K = predicted @ C.T / (C @ predicted @ C.T + R)
    settled = predicted - K @ C @ predicted

    p = c.new("sh_filter_parameters", **{**SETTINGS, "kind": 2, "V_a": V_a, "R": R})
    kalman = c.new("sh_kinematic_kalman")
    c.lib.sh_kinematic_kalman_start(kalman, p, 0.0)
    for _ in range(2000):
        c.lib.sh_kinematic_kalman_step(kalman, p, 0.0, T, W_S)
    P = [kalman.P11, kalman.P12, kalman.P22]
    assert pytest.approx([settled[0, 0], settled[0, 1], settled[1, 1]], rel=1e-8) == P


def test_missing_samples_do_not_disturb_the_filter(c: Library) -> None:
    # GIVEN a settled filter on a ramp WHEN ten samples are missing and the next step gets the time
    # since the last sample THEN position and velocity have no error
    p = c.new("sh_filter_parameters", **SETTINGS)
    kalman = c.new("sh_kinematic_kalman")
    c.lib.sh_kinematic_kalman_start(kalman, p, 0.0)
    for k in range(1, 1001):
        c.lib.sh_kinematic_kalman_step(kalman, p, 5.0 * T * k, T, W_S)
    c.lib.sh_kinematic_kalman_step(kalman, p, 5.0 * T * 1011, 11 * T, W_S)
    assert position(kalman) == pytest.approx(5.0 * T * 1011, rel=1e-12)
    assert kalman.x_dot == pytest.approx(5.0, rel=1e-9)


@pytest.mark.parametrize("kind", [1, 2, 3])
def test_dx_and_dx_dot_are_the_changes_of_position_and_velocity(c: Library, kind: int) -> None:
    p = c.new("sh_filter_parameters", **{**SETTINGS, "kind": kind})
    kalman = c.new("sh_kinematic_kalman")
    c.lib.sh_kinematic_kalman_start(kalman, p, 1.0)
    for z in (1.001, 1.003, 1.002, 1.004):
        before = position(kalman), kalman.x_dot
        c.lib.sh_kinematic_kalman_step(kalman, p, z, T, W_S)
        changes = position(kalman) - before[0], kalman.x_dot - before[1]
        assert (kalman.dx, kalman.dx_dot) == pytest.approx(changes, rel=1e-9)


@pytest.mark.parametrize("kind", [1, 2])
def test_the_velocity_is_as_precise_at_a_large_position(c: Library, kind: int) -> None:
    # GIVEN the same motion near zero and 2^22 rad away, both with the rounding of the far one
    # WHEN both are filtered THEN the velocity is the same
    near = COUNT * np.floor(np.linspace(0, 500, 1500) ** 1.1)
    far = near + 2.0**22
    velocity = [run(c, z, kind=kind)[:, 1] for z in (far - 2.0**22, far)]
    assert velocity[1] == pytest.approx(velocity[0], rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("weighting", [1, 2])
@pytest.mark.parametrize("counts", [40000.0, 0.0])
@pytest.mark.parametrize("kind", [1, 2, 3])
def test_against_the_oracle(c: Library, kind: int, weighting: int, counts: float) -> None:
    z = table1_recording().theta[:2000]
    values = {
        **oracle.DEFAULTS,
        **{f"filter.{name}": value for name, value in SETTINGS.items()},
        "filter.kind": kind,
        "filter.weighting": weighting,
    }
    want = [oracle.rounded(signal) for signal in oracle.velocity_filter(values, z, counts)]
    got = run(c, z, w_s=W_S if counts else 0.0, kind=kind, weighting=weighting)
    assert oracle.relative_error(got[:, 0], want[0]) < 1e-9
    assert oracle.relative_error(got[:, 1], want[1]) < 1e-9
