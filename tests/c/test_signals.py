"""How FilteredRegression prepares signals: the direction of motion from counts, and the filters."""

from typing import Any

import numpy as np
import pytest
from scipy import signal

from c_library import Array, Library
from dense_signals import direction
from reference_joints import round_to_counts

COUNTS = 40000.0
COUNT = 2 * np.pi / COUNTS
T = 1e-3
SLOW = 0.05  # [rad/s]


# The direction of motion


def run(
    c: Library, positions: Array, count: float = COUNT, slow: float = SLOW * T
) -> tuple[Array, Array]:
    """For every sample except the first: mean sign; and 0 if the sign is known, else 1 or more."""
    signs, unknown = direction(c, positions, count, slow)
    return signs[1:], unknown[1:]


@pytest.mark.parametrize("velocity", [0.06, 0.3, -2.0, 40.0])
def test_the_sign_of_steady_motion_is_known_between_counts(c: Library, velocity: float) -> None:
    signs, unknown = run(c, round_to_counts(velocity * T * np.arange(400.0), COUNTS))
    assert np.all(signs[20:] == np.sign(velocity))
    assert np.all(unknown[20:] == 0)


def test_the_sign_is_unknown_at_rest(c: Library) -> None:
    """The sign is unknown after the time that one count takes at the velocity `slow`."""
    x = 0.5 * T * np.minimum(np.arange(200.0), 100)
    signs, unknown = run(c, round_to_counts(x, COUNTS))
    waiting = int(np.ceil(COUNT / (SLOW * T))) + 2
    assert np.all(unknown[100 + waiting :] == 1)
    assert np.all(signs[100 + waiting :] == 0)


def test_the_sign_is_unknown_while_the_motor_creeps(c: Library) -> None:
    _, unknown = run(c, round_to_counts(0.02 * T * np.arange(500.0), COUNTS))
    assert np.all(unknown == 1)


@pytest.mark.parametrize("acceleration", [50.0, 100.0, 400.0, 3000.0])
@pytest.mark.parametrize("seed", range(5))
def test_the_sum_of_the_signs_over_a_reversal_is_right(
    c: Library, acceleration: float, seed: int
) -> None:
    """The sum differs from the sum of the true signs by less than one sample."""
    turn = 0.1 + np.random.default_rng(seed).uniform(0, T)
    t = T * np.arange(201.0)
    offset = np.random.default_rng(seed + 100).uniform(0, COUNT)
    signs, _ = run(c, round_to_counts(acceleration / 2 * (t - turn) ** 2 + offset, COUNTS))
    true = 2 * np.clip((t[1:] - turn) / T, 0, 1) - 1
    assert abs(np.sum(signs[50:] - true[50:])) < 1.0


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_without_rounding_the_time_of_a_reversal_is_right_to_a_sample(
    c: Library, way: float
) -> None:
    turn = 0.0503
    t = T * np.arange(101.0)
    signs, _ = run(c, way * 50.0 * (t - turn) ** 2, count=0.0)
    true = way * (2 * np.clip((t[1:] - turn) / T, 0, 1) - 1)
    assert abs(np.sum(signs[1:] - true[1:])) < 1.0


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_the_sign_is_known_after_a_fast_reversal(c: Library, way: float) -> None:
    signs, unknown = run(c, way * np.array([0.0, 5.0, 10.0, 15.0, 11.0, 7.0]), 1.0, 0.1)
    assert unknown[3] == 0.0
    assert signs[4] == -way


def test_the_sign_is_known_at_the_velocity_slow_itself(c: Library) -> None:
    """The motor moves once, by one count; `slow` is half a count per sample."""
    _, unknown = run(c, np.array([0.0, 1.0, 1.0, 1.0, 1.0]), 1.0, 0.5)
    assert unknown.tolist() == [1.0, 0.0, 0.0, 1.0]


def test_a_reversal_subtracts_the_wrong_signs_and_counts_them_as_unknown(c: Library) -> None:
    """Those are the signs since the last count; the motor reverses between two edges."""
    signs, unknown = run(c, COUNT * np.array([0, 1, 1, 2, 2, 3, 3, 3, 2, 2.0]))
    assert signs[4:].tolist() == [1, 1, 1, -1 - 2, -1]
    assert unknown[4:].tolist() == [0, 0, 0, 1 + 2, 0]


def test_the_sign_is_unknown_before_the_first_step(c: Library) -> None:
    """A second start deletes all effects of the earlier motion."""
    motion = c.new("sh_motion_sign")
    for _ in range(2):
        c.lib.sh_motion_sign_start(motion, 3.0)
        assert (motion.sign, motion.unknown, motion.waiting, motion.position) == (0, 1, 0, 3)
        for position in (3.0, 4.0, 6.0, 6.0):
            c.lib.sh_motion_sign_step(motion, position, 1.0, 0.1)


# The filter, against scipy's solution of the same differential equation


def design(c: Library, w: float) -> Any:
    return c.ffi.new("sh_filter_design *", c.lib.sh_state_variable_filter_design(w, T))


class Filters:
    """The first filters, each of a signal that has been the first sample, or 0, and is x now."""

    def __init__(self, c: Library, w: float, x: Array, before: Array) -> None:
        self.c, self.design, self.filters = c, design(c, w), c.new("sh_filters")
        for i, (value, value_before) in enumerate(zip(x, before, strict=True)):
            c.lib.sh_filters_start(self.filters, i, value, value_before)

    def step(self, x: Array) -> None:
        pointer = self.c.pointer(np.ascontiguousarray(x))
        self.c.lib.sh_filters_step(self.filters, self.design, 0, pointer, len(x))

    @property
    def outputs(self) -> Array:
        """The signals behind the filters, and two derivatives [size: 3 x SH_FILTERS]."""
        filtered = self.c.new("sh_filtered")
        self.c.lib.sh_filters_read(self.filters, self.design, filtered)
        return np.array([list(filtered.output), list(filtered.first), list(filtered.second)])


def random_walk(seed: int) -> Array:
    return np.cumsum(np.random.default_rng(seed).normal(size=300))


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("w", [1.0, 200.0, 3000.0])
def test_signals_are_filtered_exactly(c: Library, w: float, held: bool) -> None:
    """Input of each filter: a signal that is linear between samples, or held before each sample."""
    walk, sizes = random_walk(1), np.arange(1.0, 1 + c.lib.SH_FILTERS)
    filters = Filters(c, w, walk[0] * sizes, 0 * sizes)
    got = [filters.outputs]
    for value in walk[1:]:
        for i, size in enumerate(sizes if held else []):
            c.lib.sh_filters_hold(filters.filters, i, value * size)
        filters.step(value * sizes)
        got.append(filters.outputs)
    u = np.append(walk[1:], 0.0) if held else walk
    for order, found in enumerate(np.swapaxes(got, 0, 1)):
        system = [w**3] + [0.0] * order, np.poly([-w] * 3)  # s^order w^3 / (s + w)^3
        _, want, _ = signal.lsim(system, u, T * np.arange(len(u)), interp=not held)
        assert np.max(np.abs(found / sizes - want[:, None])) < 1e-9 * np.max(np.abs(want))


def test_a_start_at_a_constant_signal_has_no_transient(c: Library) -> None:
    filters = Filters(c, 200.0, np.array([7.0]), np.array([7.0]))
    filters.step(np.array([7.0]))
    assert filters.outputs[:, 0].tolist() == [7.0, 0.0, 0.0]


def test_derivatives_are_the_same_far_from_zero(c: Library) -> None:
    """To the last bit: the signal has integers, to which 2^40 is added exactly."""
    far = np.array([0.0, 2.0**40])
    filters = Filters(c, 200.0, far, far)
    for value in np.round(10 * random_walk(3)):
        filters.step(far + value)
        assert np.array_equal(*filters.outputs[1:, :2].T)


def test_at_rest_the_state_becomes_zero_and_never_denormal(c: Library) -> None:
    filters = Filters(c, 200.0, np.ones(1), np.zeros(1))
    for _ in range(1000):
        filters.step(np.ones(1))
        c.lib.sh_filters_rest(filters.filters, 1)
        behind = [stage[0] for stage in filters.filters.behind]
        assert all(value == 0.0 or abs(value) > 1e-300 for value in behind)
    assert behind == [0.0] * 3
