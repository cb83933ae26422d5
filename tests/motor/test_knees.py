"""Tests of the knees of a spring, which are deformations where its stiffness changes abruptly."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from recorded_logs import Array
from sigmahat.motor.equation import Form
from sigmahat.motor.motor_fit import fit_motor
from sigmahat.motor.signals import Signals
from sigmahat.motor.spring import knees

T, GAMMA, K = 1e-3, 50.0, 400.0
FORM = Form(20.0, 50.0, n=4, symmetric=False)
LARGEST, ZERO = 0.03, 0.004  # largest deformation and offset of the deformation [rad]


Spring = Callable[[Array], Array]
FOUND = 0.03 * LARGEST
"""Tolerance for the position of a knee [rad]."""


def knee(*places: float, ratio: float = 2.0) -> Spring:
    """A spring whose stiffness K increases by (ratio - 1) K at each of the given deformations."""
    return lambda phi: K * (phi + (ratio - 1) * sum(phi - np.clip(phi, -k, k) for k in places))


def piece(spring: Spring, blow: float = 0.0) -> Signals:
    """Signals that satisfy equation (3) without inertia; the torque has noise of 1 %.

    blow  additional deformation for a short time at the start, as after a blow [rad]
    """
    t = T * np.arange(20_000)
    theta = 0.3 * np.sin(2.1 * t) + 0.2 * np.sin(5.3 * t)
    velocity = 0.63 * np.cos(2.1 * t) + 1.06 * np.cos(5.3 * t)
    phi = 0.7 * LARGEST * np.sin(3.7 * t) + 0.3 * LARGEST * np.sin(1.3 * t)
    phi += blow * np.exp(-(((t - 0.05) / 0.01) ** 2))
    tau = 5e-4 * GAMMA * velocity + 0.01 * np.tanh(velocity / 0.02) - spring(phi) / GAMMA
    tau += 0.01 * np.std(tau) * np.random.default_rng(1).standard_normal(len(t))
    return Signals(theta, phi + ZERO, np.ones(len(t)), tau, None)


@pytest.mark.parametrize(
    ("shares", "ratio"),
    [*(((k,), ratio) for k in (0.2, 0.43, 0.7) for ratio in (1.5, 0.5)), ((0.25, 0.6), 1.5)],
)
def test_the_knees_of_a_spring_are_found(shares: Sequence[float], ratio: float) -> None:
    """A harmonic drive has two knees between the stiffnesses K_1, K_2 and K_3 of its data sheet."""
    places = [share * LARGEST for share in shares]
    found = knees([piece(knee(*places, ratio=ratio))], T, GAMMA, FORM, ZERO)
    assert found == pytest.approx(places, abs=FOUND)


def test_a_torque_sensor_does_not_hide_the_knee() -> None:
    """GIVEN a torque sensor, whose torque replaces the polynomial when K_t is identified."""
    spring = knee(0.4 * LARGEST)
    plain = piece(spring)
    measured = replace(plain, tau_e=spring(plain.phi - ZERO))
    (found,) = knees([measured], T, GAMMA, FORM, ZERO)
    assert found == pytest.approx(0.4 * LARGEST, abs=FOUND)


def test_a_blow_moves_neither_the_knee_nor_the_scale_of_the_torque() -> None:
    k, blow = 0.3 * LARGEST, 4 * LARGEST
    spring = knee(k)
    blown = [piece(spring, blow)]
    (found,) = knees(blown, T, GAMMA, FORM, ZERO)
    assert found == pytest.approx(k, abs=FOUND)
    largest = fit_motor(blown, T, GAMMA, False, 20.0, None).spring
    assert largest == pytest.approx(float(spring(np.array(blow))), rel=0.3)


@pytest.mark.parametrize("spring", [knee(), lambda phi: K * (phi + 0.5 * phi**3 / LARGEST**2)])
def test_a_spring_without_a_knee_has_none(spring: Spring) -> None:
    """GIVEN a spring whose torque is a polynomial that the estimator can represent."""
    assert knees([piece(spring)], T, GAMMA, FORM, ZERO) == ()
