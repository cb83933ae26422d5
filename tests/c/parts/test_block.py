"""block.c: the mean row of rows that follow each other without a gap."""

from typing import Any

import pytest

from c_library import Library
from c_parts import RESIDUAL, SENSOR

# The window 16 x^2 (1 - x)^2 at the four rows of a block, x = 1/8, 3/8, 5/8, 7/8:
WINDOW = (49 / 256, 225 / 256, 225 / 256, 49 / 256)
SUM = sum(WINDOW)
SQUARES = sum(h**2 for h in WINDOW)


def block_of_four(c: Library) -> Any:
    """White noise before the filter stays as it is; the second derivative triples its variance."""
    return c.new("sh_block", length=4.0, duration=0.2, energy=1.0, energy_second=3.0)


def take(c: Library, block: Any, *rows: Any, K: int = 1, modality: int = SENSOR) -> tuple[Any, int]:
    """The `sh_block_mean *` after the rows, and how many of them completed a block."""
    mean, signals = c.new("sh_block_mean"), c.new("sh_signals", decimation=K)
    p = c.parameters({"modality": modality, "motor.gamma": 2.0, "motor.B": 0.25})
    full = [c.lib.sh_block_take(block, row, signals, 1, p, mean) for row in rows]
    return mean, sum(full)


def row(c: Library, *x: float, w: float = 1.0, lasting: float = 1.0, rough: float = 0.0) -> Any:
    return c.new("sh_row", x=list(x), w=w, lasting=lasting, rough=rough)


@pytest.mark.parametrize(
    ("T", "K", "length", "duration"), [(1e-3, 5, 10.0, 0.05), (1e-2, 2, 4.0, 0.08)]
)
def test_a_block_takes_fifty_milliseconds(
    c: Library, T: float, K: int, length: float, duration: float
) -> None:
    """50 ms are 10 rows of 5 samples of 1 ms; but a block has at least 4 rows."""
    design = c.lib.sh_state_variable_filter_design(100.0, T)
    block, signals = c.new("sh_block"), c.new("sh_signals", design=design, decimation=K)
    c.lib.sh_block_start(block, signals)
    assert (block.length, block.duration) == pytest.approx((length, duration))


def test_the_mean_of_equal_rows_is_this_row(c: Library) -> None:
    """With weights 2 and the window h, the variance is sum h^2 / (2 (sum h)^2)."""
    block = block_of_four(c)
    mean, full = take(c, block, *[row(c, 1.5, -2.0, 7.0, w=2.0)] * 4)
    assert full == 1
    assert list(mean.x[0:3]) == pytest.approx([1.5, -2.0, 7.0])
    assert mean.w == pytest.approx(2 * SUM**2 / SQUARES)
    assert (mean.count, mean.duration) == pytest.approx((1.0, 0.2))
    assert (block.rows, block.weight, block.sum[0]) == (0.0, 0.0, 0.0)


def test_rows_count_by_weight_and_window(c: Library) -> None:
    """49 of weight 3 * 49 + 225 + 225 + 49 are of the row 1."""
    mean, _ = take(c, block_of_four(c), row(c, 1.0, w=3.0), *[row(c, 0.0)] * 3)
    assert mean.x[0] == pytest.approx(3 * 49 / (3 * 49 + 225 + 225 + 49))


def test_a_gap_drops_the_rows_before_it(c: Library) -> None:
    block = block_of_four(c)
    assert take(c, block, *[row(c, 100.0)] * 3)[1] == 0
    c.lib.sh_block_empty(block)
    mean, full = take(c, block, *[row(c, 1.0)] * 4)
    assert full == 1
    assert mean.x[0] == pytest.approx(1.0)


def test_errors_that_last_make_a_block_count_as_a_part_of_one(c: Library) -> None:
    mean, _ = take(c, block_of_four(c), *[row(c, 1.0, lasting=4.0)] * 4)
    assert (mean.count, mean.duration) == pytest.approx((0.25, 0.05))


def test_rounding_of_theta_adds_to_the_variance(c: Library) -> None:
    """gamma^2 B = 1: (1 + 2 * 3 / K) times the variance of white noise, for K = 2 samples. A torque
    that is measured does not contain the motor."""
    rows = [row(c, 1.0, rough=2.0)] * 4
    for modality, factor in ((RESIDUAL, 4.0), (SENSOR, 1.0)):
        mean, _ = take(c, block_of_four(c), *rows, K=2, modality=modality)
        assert mean.w == pytest.approx(SUM**2 / SQUARES / factor)


def test_a_mean_row_of_too_large_numbers_counts_for_nothing(c: Library) -> None:
    mean, full = take(c, block_of_four(c), *[row(c, 1e80)] * 4)
    assert (full, mean.w) == (0, 0.0)
