"""What is forgotten, and what may change: time constants and random walks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from c_library import Array, Estimator, Library, load
from c_regression import PLAIN, coefficients, dense
from regression_joint import Joint

VALUES = {"method": 2, "rls.n": 2, "rls.m": 1, "prior.B": 0.1, **PLAIN, "prior.gap": 0.02}
MEMORY, TIME = 20.0, 0.1


@pytest.fixture(scope="module")
def c(build: Path) -> Library:
    return load(build)


class State:
    """The state of an estimator that has learned."""

    def __init__(self, c: Library, **values: float) -> None:
        self.c = c
        self.estimator = Estimator(c, {**VALUES, "regression.memory": MEMORY, **values})
        joint = Joint(duration=2.0)
        z = joint.measurements()
        z[:, 2] = 0.0
        z[:, 3] += (joint.tau_e - 140 * joint.motion[3]) / 50
        self.estimator.run(z)
        self.regression: Any = c.ffi.addressof(self.estimator.state.method, "regression")
        self.row: Array = np.random.default_rng(2).normal(size=self.regression.size)

    def information(self) -> dict[str, Array]:
        blocks = self.regression.blocks
        parts = {"data": self.regression.data, "all": blocks.all}
        parts |= {"walking": blocks.walking, "recent": blocks.recent}
        return {name: dense(part)[0] for name, part in parts.items()}

    def forget(self, gained: float = TIME, time: float = TIME) -> None:
        self.regression.blocks.gained = gained
        row = self.c.pointer(self.row)
        self.c.lib.sh_forgetting_step(self.regression, self.estimator.parameters, row, time)


def test_data_that_agree_are_not_forgotten(c: Library) -> None:
    state = State(c)
    before, count = state.information(), state.regression.blocks.count
    state.regression.variance_factor = 1.5
    state.forget()
    after = state.information()
    for name in ("data", "all", "walking"):
        assert np.array_equal(after[name], before[name])
    assert state.regression.blocks.count == count


@pytest.mark.parametrize("recent_agree", [False, True])
def test_data_that_contradict_fade_with_the_memory(c: Library, recent_agree: bool) -> None:
    """Five times as fast, if the recent data agree by themselves."""
    state = State(c)
    before, count = state.information(), state.regression.blocks.count
    surplus, spread = state.regression.surplus, state.regression.spread
    state.regression.variance_factor = 1.6
    state.regression.blocks.recent_count = 30.0
    state.regression.blocks.recent.rest = 10.0 if recent_agree else 1e3
    state.forget()
    keep = np.exp(-TIME / (MEMORY / 5 if recent_agree else MEMORY))
    after = state.information()
    for name in ("data", "all", "walking"):
        largest = np.max(np.abs(before[name]))
        assert after[name] == pytest.approx(keep * before[name], abs=1e-9 * largest)
    assert state.regression.blocks.count == pytest.approx(keep * count)
    assert state.regression.surplus == pytest.approx(keep * surplus)
    assert state.regression.spread == pytest.approx(keep**2 * spread)  # a variance


def test_the_recent_blocks_fade_with_a_tenth_of_the_memory_to_the_prior(c: Library) -> None:
    state = State(c)
    count = state.regression.blocks.recent_count
    state.forget()
    assert state.regression.blocks.recent_count == pytest.approx(
        count * np.exp(-10 * TIME / MEMORY)
    )
    for _ in range(2000):
        state.forget()
    D = list(state.regression.blocks.recent.D[0 : state.regression.size])
    assert [1.0] * state.regression.size == D


def test_without_a_memory_nothing_is_forgotten(c: Library) -> None:
    state = State(c, **{"regression.memory": 0.0})
    before = state.information()
    state.forget()
    for name, matrix in state.information().items():
        assert np.array_equal(matrix, before[name])


def test_nothing_is_forgotten_while_no_block_is_gained(c: Library) -> None:
    """At rest, where all samples have the same error, the contradiction stays known."""
    state = State(c)
    before = state.information()
    state.regression.variance_factor = 100.0
    state.forget(gained=0.0, time=1e6)
    for name, matrix in state.information().items():
        assert np.array_equal(matrix, before[name])


def test_the_curve_drifts_along_the_last_sample(c: Library) -> None:
    """Only the smooth curve: not the dead zone, and not the data of the motor."""
    drift = 0.3
    state = State(c, **{"regression.drift": drift})
    before = state.information()
    v = state.row.copy()
    v[[kind != "BASIS" for kind, _ in coefficients(state.estimator)]] = 0.0
    state.forget()
    variance = drift * TIME / (v @ v + state.regression.R)
    after = state.information()
    for name in ("data", "all", "walking"):
        A = before[name]
        want = A - np.outer(A @ v, A @ v) * variance / (1 + variance * (v @ A @ v))
        assert after[name] == pytest.approx(want, abs=1e-9 * np.max(np.abs(A)))


@pytest.mark.parametrize("drifts", [0, 1])
def test_friction_walks_in_the_data_if_it_drifts(c: Library, drifts: int) -> None:
    state = State(c)
    state.regression.friction_drifts = drifts
    state.regression.blocks.count = 0.0  # too few to decide anew
    before = state.information()
    c.lib.sh_forgetting_of_friction(state.regression, TIME)
    after = state.information()
    names = [kind for kind, _ in coefficients(state.estimator)]
    for name, walks in (("walking", True), ("data", bool(drifts)), ("all", False)):
        A = before[name].copy()
        for i, kind in enumerate(names):
            if walks and kind in ("VISCOUS", "COULOMB"):
                A -= np.outer(A[i], A[i]) * 1e-3 * TIME / (1 + 1e-3 * TIME * A[i, i])
        assert after[name] == pytest.approx(A, abs=1e-9 * np.max(np.abs(A)))


@pytest.mark.parametrize(
    ("walking", "constant", "before", "after"),
    [(0.7, 2.0, 0, 1), (0.9, 2.0, 0, 0), (0.9, 2.0, 1, 1), (0.97, 2.0, 1, 0), (0.7, 1.0, 0, 0)],
)
def test_friction_drifts_if_the_blocks_contradict_each_other_clearly_less(
    c: Library, walking: float, constant: float, before: int, after: int
) -> None:
    """GIVEN the mean squares that remain with constant friction, and the ratio with friction that
    walks, THEN it is noticed below 0.8 if there is a misfit, and has ended above 0.95."""
    state = State(c)
    state.regression.friction_drifts = before
    N = 200.0
    state.regression.blocks.count = N
    state.regression.blocks.all.rest = constant * N
    state.regression.blocks.walking.rest = walking * constant * N
    c.lib.sh_forgetting_of_friction(state.regression, 0.0)
    assert state.regression.friction_drifts == after
