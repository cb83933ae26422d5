"""The places at which the slope of a spring changes at once, from motions in closed form."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from recorded_logs import Array
from sigmahat.identification.motor import fit_motor
from sigmahat.identification.regression import Form, Signals
from sigmahat.identification.spring import knees

T, GAMMA, K = 1e-3, 50.0, 400.0
FORM = Form(20.0, 50.0, n=4, symmetric=False)
LARGEST, ZERO = 0.03, 0.004  # largest deformation, and its zero [rad]


Spring = Callable[[Array], Array]
FOUND = 0.03 * LARGEST
"""Tolerance of a place [rad]."""


def knee(*places: float, ratio: float = 2.0) -> Spring:
    """A spring whose slope K changes at these deformations by ratio - 1 times K."""
    return lambda phi: K * (phi + (ratio - 1) * sum(phi - np.clip(phi, -k, k) for k in places))


def piece(spring: Spring, blow: float = 0.0) -> Signals:
    """Equation (3) without inertia, solved for the torque, with noise of 1 % of it.

    blow  deformation for a moment at the begin, beside that of the motion [rad]
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
    """Two of them as in harmonic drives: the slopes K_1, K_2, K_3 of their catalogues."""
    places = [share * LARGEST for share in shares]
    found = knees([piece(knee(*places, ratio=ratio))], T, GAMMA, FORM, ZERO)
    assert found == pytest.approx(places, abs=FOUND)


def test_a_torque_sensor_does_not_hide_the_knee() -> None:
    """GIVEN a sensor, whose torque takes the place of the polynomial where K_t is identified."""
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
    """GIVEN a torque that the polynomial of the estimator can make."""
    assert knees([piece(spring)], T, GAMMA, FORM, ZERO) == ()
