"""The friction models M1 to M6, the current loop, the encoders, and what is drawn."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from rivals.joints import catalogue, draw
from rivals.joints.friction import Friction
from rivals.joints.simulation import CurrentLoop, Delay, count, rounded

SEEDS = range(1, 41)
V, M, E = 0.3, 2.0, -3.0  # velocity, torque of the motor, torque from outside
S = math.exp(-((0.3 / 0.5) ** 1.5))
FULL = Friction(6, 0.1, 0.2, 0.5, 1.5, 0.05, 0.03, 0.04, 0.02, 0.006, 0.007)

# Each written out on its own from the publication, with the numbers in FULL.
PUBLISHED = {
    1: 0.1,
    2: 0.1 + S * 0.2,
    3: 0.1 + 0.05 * 5,
    4: 0.1 + 0.05 * 5 + S * (0.2 + 0.04 * 5),
    5: 0.1 + 0.19 + S * (0.2 + 0.14),
    6: 0.1 + 0.19 + S * (0.2 + 0.14 + 0.006 * 4),
}


@pytest.mark.parametrize("model", PUBLISHED)
def test_friction_is_as_published(model: int) -> None:
    friction = replace(FULL, model=model)
    if model in (3, 4):
        friction = replace(friction, K_e=friction.K_m, K_es=friction.K_ms)
    assert friction.budget(V, M, E) == pytest.approx(PUBLISHED[model])
    assert friction.budget(-V, -M, -E) == pytest.approx(PUBLISHED[model])


def test_the_quadratic_part_depends_on_who_drives() -> None:
    linear = replace(FULL, model=5)
    assert FULL.budget(V, 3, -2) - linear.budget(V, 3, -2) == pytest.approx(S * 0.007 * 4)


def test_the_current_loop_is_late_by_dead_time_and_lag() -> None:
    step = 1e-4
    loop = CurrentLoop(delay=2e-3, lag=5e-4, step=step)
    torque = [loop(1.0) for _ in range(100)]
    assert torque[:20] == [0.0] * 20
    t = step * np.arange(1, 81)
    np.testing.assert_allclose(torque[20:], 1 - np.exp(-t / 5e-4), rtol=1e-12)
    assert [Delay(0.0, step)(value) for value in (1.0, 2.0)] == [1.0, 2.0]


def test_encoders_round_and_count_on() -> None:
    angle = np.array([0.0, 0.6, 1.4, -0.6, 1e6 + 0.3]) * count(4096)
    np.testing.assert_allclose(rounded(angle, 4096) / count(4096), [0, 1, 1, -1, 1e6])


@cache
def drawn(kind: str) -> list[Any]:
    return [catalogue.drawn(kind, seed) for seed in SEEDS]


def test_every_friction_model_and_both_logs_of_torque_are_drawn() -> None:
    joints = drawn("series_elastic")
    assert {joint.motors[0].friction.model for joint in joints} == {1, 2, 3, 4, 5, 6}
    assert {joint.instruments[0].commanded for joint in joints} == {False, True}
    assert {joint.springs[0].k_3 > 0 for joint in joints} == {False, True}
    assert len({joint.springs[0].stiffness for joint in joints}) == len(SEEDS)
    assert {joint.observed for joint in drawn("arm")} == {0, 1}


def test_a_motor_holds_its_arm() -> None:
    quarter, straight = np.full(1, math.pi / 2), np.zeros(1)
    for arm in drawn("arm"):
        torques = draw.gravity_torques(arm.links, quarter, straight)
        for motor, torque in zip(arm.motors, torques, strict=True):
            assert motor.gear * motor.peak >= draw.HOLDS * torque[0]
