"""samples.c: the information of all samples, and the sums of the noise in it."""

from typing import Any

import numpy as np
import pytest

from c_library import Library
from c_parts import normal_equations

LEAST = 1e-9
"""Initial precision; the numbers below leave it out."""


def samples_of(c: Library, size: int, *rows: tuple[float, ...]) -> Any:
    """The samples of rows: weight, columns, y. The gain of the torque has no effect."""
    samples = c.new("sh_samples")
    c.lib.sh_samples_start(samples, size)
    for w, *x, y in rows:
        row = c.new("sh_row", x=[*x, 0.0, y], w=w)
        c.lib.sh_samples_take(samples, row, 0, c.ffi.NULL)
    return samples


def test_two_rows_are_weighted_normal_equations(c: Library) -> None:
    """2 (1, 0)'(1, 0) + 1 (1, 2)'(1, 2) = ((3, 2), (2, 4)), and 2 * 5 (1, 0) + 1 * 1 (1, 2)."""
    samples = samples_of(c, 2, (2.0, 1.0, 0.0, 5.0), (1.0, 1.0, 2.0, 1.0))
    information, right = normal_equations(samples.data)
    assert information == pytest.approx(np.array([[3.0, 2.0], [2.0, 4.0]]), abs=10 * LEAST)
    assert right[:, 1] == pytest.approx([11.0, 2.0])


def test_what_the_first_rows_leave_of_a_sample(c: Library) -> None:
    """The data know beta_0 + beta_1 = 2 with the variance 1. The sample beta_0 + 3 beta_1 = 4 of
    variance 1, less this equation, is 2 beta_1 = 2 of variance 2. The data take the sample, too."""
    samples, rest = samples_of(c, 2, (1.0, 1.0, 1.0, 2.0)), c.new("sh_sample")
    row = c.new("sh_row", x=[1.0, 3.0, 0.0, 4.0], w=1.0)
    c.lib.sh_samples_take(samples, row, 1, rest)
    assert list(rest.x[0:4]) == pytest.approx([0.0, 2.0, 0.0, 2.0], abs=10 * LEAST)
    assert rest.w == pytest.approx(0.5)
    information, right = normal_equations(samples.data)
    assert information == pytest.approx(np.array([[2.0, 4.0], [4.0, 10.0]]), abs=10 * LEAST)
    assert right[:, 1] == pytest.approx([6.0, 14.0])
    c.lib.sh_samples_take(samples, row, 2, rest)
    assert rest.w == 0.0


def test_forgetting_halves_the_weights(c: Library) -> None:
    """As if each weight were half: the sums of weights are half, and those of squares a quarter."""
    samples = samples_of(c, 1, (3.0, 2.0, 5.0))
    left = c.new("sh_column_noise", information=2.0, gain=-4.0)
    c.lib.sh_samples_count_noise(samples, left, 3.0, 8.0, 16.0)
    noise = samples.noise
    assert (samples.weights, samples.surplus, samples.spread) == (3.0, 8.0, 16.0)
    assert (noise.information, noise.gain) == (6.0, -12.0)
    c.lib.sh_samples_forget(samples, 0.5)
    information, right = normal_equations(samples.data)
    assert (information[0, 0], right[0, 1]) == pytest.approx((0.5 * 3.0 * 4.0, 0.5 * 3.0 * 10.0))
    assert (samples.weights, samples.surplus, samples.spread) == (1.5, 4.0, 4.0)
    assert (noise.information, noise.gain) == (3.0, -6.0)


def test_drift_adds_to_the_variance(c: Library) -> None:
    """The variance 1/4 becomes 1/4 + 3/4 = 1, and beta stays: a quarter of the weights is left."""
    samples = samples_of(c, 1, (4.0, 1.0, 2.0))
    samples.weights = 4.0
    c.lib.sh_samples_drift(samples, [1.0], 0.75)
    information, right = normal_equations(samples.data)
    assert (information[0, 0], right[0, 1], samples.weights) == pytest.approx((1.0, 2.0, 1.0))


def test_drift_in_two_steps(c: Library) -> None:
    """The same; and no step if there is no such column."""
    samples = samples_of(c, 1, (4.0, 1.0, 2.0))
    for column, variance in ((-1, 4.0), (0, 1.0)):
        c.lib.sh_samples_prepare_drift(samples, column, 0.75)
        c.lib.sh_samples_take_drift(samples)
        assert normal_equations(samples.data)[0][0, 0] == pytest.approx(variance)


def test_other_data_have_no_noise_of_single_samples(c: Library) -> None:
    samples = samples_of(c, 1, (4.0, 1.0, 2.0))
    c.lib.sh_samples_count_noise(samples, c.new("sh_column_noise", information=1.0), 4.0, 1.0, 1.0)
    blocks = c.new("sh_information")
    c.lib.sh_information_start(blocks, 1, 7.0)
    c.lib.sh_samples_replace(samples, blocks)
    assert normal_equations(samples.data)[0][0, 0] == 7.0
    assert (samples.weights, samples.surplus, samples.noise.information) == (0.0, 0.0, 0.0)
