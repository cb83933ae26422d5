"""A motor that moves less than a count of its encoder per sample: rounding is not independent."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sigmahat.identification.identify import _apart
from sigmahat.identification.regression import Form, Signals, equations, fit
from sigmahat.logs.log import Array

T, GAMMA, K, COUNT = 1e-3, 160.0, 2400.0, 2 * np.pi / 16384
B, D_THETA = 1.3e-4, 6e-4


def recording(seed: int, noise: float) -> Signals:
    """40 s of a joint with a linear spring; noise of the torque [N.m]."""
    rng, t = np.random.default_rng(seed), T * np.arange(40_000)
    w, amplitude = 2 * np.pi * np.array([0.35, 0.8, 1.7]), np.array([0.025, 0.015, 0.0075])
    angle = np.outer(t, w) + rng.uniform(0, 2 * np.pi, 3)
    theta = np.sin(angle) @ amplitude
    motor = B * -np.sin(angle) @ (amplitude * w**2) + D_THETA * np.cos(angle) @ (amplitude * w)
    phi = 0.01 * np.sin(2 * np.pi * 0.23 * t + 1) + 0.006 * np.sin(2 * np.pi * 1.1 * t)
    tau: Array = GAMMA * motor - K * phi / GAMMA + noise * rng.standard_normal(len(t))
    motor_angle, link_angle = (np.round(x / COUNT) * COUNT for x in (theta, theta + phi))
    return Signals(motor_angle, link_angle - motor_angle, np.zeros(len(t)), tau, None)


@pytest.mark.parametrize(("f_0", "noise"), [(20.0, 0.02), (100.0, 0.19)])
def test_the_interval_of_the_inertia_holds_it(f_0: float, noise: float) -> None:
    """GIVEN 0.3 counts per sample, THEN samples two counts apart give an interval that holds B. All
    samples give less than B, with a small interval."""
    held = {1: 0, 5: 0}
    for seed in range(12):
        piece = recording(seed, noise)
        assert _apart([piece], COUNT) == 5
        for apart in held:
            form = Form(min(f_0, 0.25 / (apart * T)), min(2.5 * f_0, 0.1 / (apart * T)))
            found = fit(equations([piece.every(apart)], apart * T, GAMMA, form))
            held[apart] += abs(found.value["B"] - B) <= found.half_width["B"]
    assert held[5] >= 9
    assert held[1] <= 2


def test_a_motor_that_moves_fast_or_rests_keeps_all_samples() -> None:
    piece = recording(1, 0.02)
    at_rest = replace(piece, theta=np.zeros(len(piece.theta)))
    for moves, count in ((piece, COUNT / 10), (at_rest, COUNT), (piece, 0.0)):
        assert _apart([moves], count) == 1
