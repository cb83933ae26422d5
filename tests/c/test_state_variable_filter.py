"""The state-variable filter, against scipy's solution of the same differential equation."""

from typing import Any

import numpy as np
import pytest
from scipy import signal

from c_library import Array, Library
from dense_signals import through

T = 1e-3


def design(c: Library, w: float) -> Any:
    return c.ffi.new("sh_filter_design *", c.lib.sh_state_variable_filter_design(w, T))


def random_walk(seed: int) -> Array:
    return np.cumsum(np.random.default_rng(seed).normal(size=300))


@pytest.mark.parametrize("w", [1.0, 200.0, 3000.0])
def test_signals_that_are_linear_between_samples_are_filtered_exactly(c: Library, w: float) -> None:
    x = random_walk(1)
    lib, d, f = c.lib, design(c, w), c.new("sh_state_variable_filter")
    lib.sh_state_variable_filter_start(f, x[0], 0.0)
    got = [(0.0, 0.0)]
    first = [lib.sh_state_variable_filter_first(f, d)]
    for value in x[1:]:
        lib.sh_state_variable_filter_step(f, d, value)
        output = lib.sh_state_variable_filter_output(f)
        got.append((output, lib.sh_state_variable_filter_second(f, d)))
        first.append(lib.sh_state_variable_filter_first(f, d))
    for order, values in ((0, [g[0] for g in got]), (1, first), (2, [g[1] for g in got])):
        system = [w**3] + [0.0] * order, np.poly([-w] * 3)  # s^order w^3 / (s + w)^3
        _, want, _ = signal.lsim(system, x, T * np.arange(len(x)), interp=True)
        assert np.max(np.abs(np.array(values) - want)) < 1e-9 * np.max(np.abs(want))


def test_a_start_at_a_constant_signal_has_no_transient(c: Library) -> None:
    lib, d, f = c.lib, design(c, 200.0), c.new("sh_state_variable_filter")
    lib.sh_state_variable_filter_start(f, 7.0, 7.0)
    lib.sh_state_variable_filter_step(f, d, 7.0)
    assert lib.sh_state_variable_filter_output(f) == 7.0
    assert lib.sh_state_variable_filter_first(f, d) == 0.0
    assert lib.sh_state_variable_filter_second(f, d) == 0.0


def test_derivatives_are_the_same_far_from_zero(c: Library) -> None:
    """GIVEN a signal of integers, WHEN 2^40 is added, which is exact in doubles, THEN every
    derivative is the same to the last bit."""
    lib, d = c.lib, design(c, 200.0)
    near, far = (c.new("sh_state_variable_filter") for _ in range(2))
    lib.sh_state_variable_filter_start(near, 0.0, 0.0)
    lib.sh_state_variable_filter_start(far, 2.0**40, 2.0**40)
    for value in np.round(10 * random_walk(3)):
        for f, x in ((near, value), (far, 2.0**40 + value)):
            lib.sh_state_variable_filter_step(f, d, x)
        for derivative in (lib.sh_state_variable_filter_first, lib.sh_state_variable_filter_second):
            assert derivative(far, d) == derivative(near, d)


def test_at_rest_the_state_becomes_zero_and_never_denormal(c: Library) -> None:
    lib, d, f = c.lib, design(c, 200.0), c.new("sh_state_variable_filter")
    lib.sh_state_variable_filter_start(f, 1.0, 0.0)
    for _ in range(1000):
        lib.sh_state_variable_filter_step(f, d, 1.0)
        assert all(behind == 0.0 or abs(behind) > 1e-300 for behind in f.behind)
    assert list(f.behind) == [0.0] * 3


@pytest.mark.parametrize("samples", [1, 5])
@pytest.mark.parametrize("w", [50.0, 350.0, 1500.0])
def test_noise_gain_is_the_sum_over_the_response_to_a_sample(
    c: Library, w: float, samples: int
) -> None:
    """By Parseval's theorem the integral over all frequencies."""
    pulse = np.concatenate([[0.0], np.full(samples, 1 / samples), np.zeros(20_000)])
    found = [c.ffi.new("sh_real *") for _ in range(2)]
    c.lib.sh_state_variable_filter_noise(design(c, w), 1.0, samples, *found)
    for gain, order in zip(found, (0, 2), strict=True):
        want = np.sum(through(pulse, order, w, T) ** 2)
        assert gain[0] / samples == pytest.approx(want, rel=1e-6)
