"""The friction models M1 to M6, and what is drawn."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any

import pytest

from rivals.joints import catalogue
from rivals.joints.friction import Friction

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
