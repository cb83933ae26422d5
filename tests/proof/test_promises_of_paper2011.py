"""Numerical promises of the blocks of Paper2011: docs/proof/promises.md."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from c_library import Array, Estimator, Library, covariance, diagonal
from edges import EPSILON, LARGEST, SMALLEST, c, magnitudes, often, reals

__all__ = ["c"]  # a fixture


def update(c: Library, rls: Any, kind: int, factor: float, F: Array, y: float) -> Any:
    """Takes a sample. Returns the innovation, None if the sample was refused."""
    innovation, row = c.new("sh_innovation"), reals(c, F)
    done = c.lib.sh_least_squares_update(rls, kind, factor, c.pointer(row), y, innovation)
    return innovation if done else None


# The recursion of Paper2011


@often
@given(data=st.data())
def test_no_entry_of_D_grows_or_gets_negative(c: Library, data: st.DataObject) -> None:
    size, kind = data.draw(st.sampled_from([1, 2, 3, 18, 40])), data.draw(st.integers(1, 3))
    P_0, rng = data.draw(magnitudes(1e-30, 1e20)), np.random.default_rng(data.draw(st.integers(0)))
    factor = data.draw(magnitudes(1e-30, LARGEST)) if kind == 1 else data.draw(magnitudes(1e-15, 1))
    scale = data.draw(magnitudes(1e-12, LARGEST))
    rls = c.new("sh_least_squares")
    c.lib.sh_least_squares_start(rls, size, c.ffi.NULL, P_0)
    D = diagonal(rls.P)
    for _ in range(30):
        F = scale * rng.normal(size=size) * 10.0 ** rng.uniform(-6, 6, size)
        innovation = update(c, rls, kind, factor, F, scale * rng.normal())
        after = diagonal(rls.P)
        assert np.all((after >= 0) & (after <= D))
        if innovation is None:
            assert np.all(after == D)
        else:
            assert innovation.rho >= 0
            assert 0 < innovation.a <= max(1.0, np.float32(factor) * (1 + 1e-6))
        D = after


@often
@given(data=st.data())
def test_no_direction_gets_less_certain(c: Library, data: st.DataObject) -> None:
    """P <= P_0, and P of a tick <= P of the tick before, but for rounding. P is formed in double,
    from scaled factors, and each sample moves it by at most n roundoffs of P_0."""
    size, rng = (
        data.draw(st.sampled_from([1, 3, 12])),
        np.random.default_rng(data.draw(st.integers(0))),
    )
    scale = data.draw(magnitudes(1e-6, 1e6))
    rls = c.new("sh_least_squares")
    c.lib.sh_least_squares_start(rls, size, c.ffi.NULL, 1.0)
    before, ticks = np.eye(size), 20
    tolerance = 8 * ticks * size * EPSILON[c.real]
    for _ in range(ticks):
        update(c, rls, 2, 1.0, scale * rng.normal(size=size), 1.0)
        P = covariance(rls.P)
        assert np.linalg.eigvalsh(before - P)[0] >= -tolerance
        before = P


@pytest.mark.parametrize("phi", [1e3, 1e11])
@pytest.mark.parametrize("set_point", [-99.9, 7.3])
def test_columns_that_cannot_be_told_apart_do_not_overflow(
    c: Library, phi: float, set_point: float
) -> None:
    """GIVEN a constant set-point: the columns of its powers are proportional, and D underflows for
    them. WHEN hundreds of samples are taken, THEN no entry of U is larger than the square root of
    P_0 over the smallest D > 0, and usual samples are taken."""
    P_0, rng = 1e20, np.random.default_rng(1)
    rls = c.new("sh_least_squares")
    c.lib.sh_least_squares_start(rls, 10, c.ffi.NULL, P_0)
    for _ in range(400):
        x = phi * rng.normal()
        update(c, rls, 2, 1.0, np.outer(set_point ** np.arange(5), [x, x**3]).ravel(), rng.normal())
    assert np.max(np.abs(list(rls.P.U))) < math.sqrt(P_0) / math.sqrt(SMALLEST[c.real])
    assert all(update(c, rls, 2, 1.0, 1e-3 * rng.normal(size=10), 0.0) for _ in range(10))


# Kalman filter and residual of Paper2011


@often
@given(data=st.data())
def test_the_covariance_of_the_kalman_filter_is_bounded_by_its_last_two_samples(
    c: Library, data: st.DataObject
) -> None:
    """P11 <= R, and P22 is at most the variance of the difference quotient of the last two samples
    with the acceleration between them."""
    R, V_a = data.draw(magnitudes(1e-30, 1e12)), data.draw(magnitudes(0, 1e12))
    P_0, T = data.draw(magnitudes(1e-30, 1e12)), data.draw(magnitudes(1e-9, 1e3))
    rng = np.random.default_rng(data.draw(st.integers(0)))
    settings_of = c.new("sh_filter_parameters", kind=2, V_a=V_a, R=R, P_0=P_0)
    kalman, u = c.new("sh_kinematic_kalman"), EPSILON[c.real]
    c.lib.sh_kinematic_kalman_start(kalman, settings_of, rng.normal())
    for k in range(40):
        dt = T * float(rng.choice([1, 1, 1, 2, 100]))
        predicted = kalman.P22 + V_a * dt**2
        predicted_P11 = kalman.P11 + dt * (2 * kalman.P12 + dt * predicted)
        c.lib.sh_kinematic_kalman_step(kalman, settings_of, rng.normal(), dt, 0.0)
        assert 0 <= kalman.P11 <= R * (1 + 4 * u) + predicted_P11 * SMALLEST[c.real]
        assert kalman.P12 >= 0
        bound = 2 * R / dt**2 + V_a * dt**2 / 4
        assert 0 <= kalman.P22 <= predicted * (1 + 4 * u)
        if k > 0:
            assert bound * (1 + 1e-4) + 64 * u * predicted >= kalman.P22


@often
@given(data=st.data())
def test_the_residual_is_at_most_what_a_constant_motion_would_give(
    c: Library, data: st.DataObject
) -> None:
    B, D = data.draw(magnitudes(1e-15, 1e6)), data.draw(magnitudes(0, 1e6))
    gamma, T = data.draw(magnitudes(1e-3, 1e3)), data.draw(magnitudes(1e-6, 1))
    K_I = data.draw(st.sampled_from([1e-3, 0.3, 1.0, 1.99])) / T
    limits = [data.draw(magnitudes(1e-6, 1e6)) for _ in range(3)]
    motor = c.new("sh_motor_parameters", B=B, D_theta=D, gamma=gamma)
    residual = c.new("sh_torque_residual")
    c.lib.sh_torque_residual_start(residual, 0.0)
    bound = (gamma * (B * limits[1] + D * limits[0]) / T + limits[2]) * (1 + 1e-4)
    rng = np.random.default_rng(data.draw(st.integers(0)))
    for _ in range(200):
        dx, dv, tau = np.array(limits) * rng.choice([-1.0, 1.0], 3)
        c.lib.sh_torque_residual_step(residual, motor, dx, dv, tau, K_I, T)
        assert abs(residual.r_e) <= bound


# What overflowed


def test_a_set_point_that_overflows_is_skipped(c: Library) -> None:
    largest = 1.7e308 if c.real == "double" else 3.4e38
    estimator = Estimator(c, {"setPoint.scale": largest, "rls.m": 1})
    assert estimator.tick([0.0, 0.1, 0.0, 0.0, 0.0])
    assert not estimator.tick([0.0, 0.1, 1e12, 0.0, 0.0])
    assert math.isfinite(estimator.estimate.setPoint)
