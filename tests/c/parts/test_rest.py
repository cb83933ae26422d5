"""rest.c: whether the motor was at rest at the first sample, judged after 2, 4 and 8 periods."""

import math
from collections.abc import Callable

import pytest

from c_library import Library

COUNT = 0.5


def told_after(
    c: Library, position: Callable[[float], float], count: float = 0.0, rough: float = 0.0
) -> list[int]:
    """Numbers of periods after which the positions show that the motor was moving."""
    rest, design = c.new("sh_rest"), c.new("sh_filter_design", w=1.0, T=1.0)  # 12 / (w T) = 12
    c.lib.sh_rest_start(rest, design)
    return [k for k in range(40) if c.lib.sh_rest_take(rest, position(k), count, rough)]


@pytest.mark.parametrize("position", [lambda k: 7.0, lambda k: -3 * k**2, lambda k: k**3])
def test_a_motor_that_starts_from_rest(c: Library, position: Callable[[float], float]) -> None:
    """No motion; a quarter of the way in half of the time by a step of the torque; an eighth by a
    torque that begins at zero."""
    assert told_after(c, position) == []


def test_a_motor_that_moves(c: Library) -> None:
    """Half of the way in half of the time. It is told once."""
    assert told_after(c, lambda k: 7 - 3 * k) == [2]


def test_a_motor_that_stops(c: Library) -> None:
    """Ways 2.3, 8 and 16 after 1, 2 and 4 periods: 2.3 is less than a count from 0.3 * 8, and
    8 > 0.3 * 16 + 0.5."""
    assert told_after(c, lambda k: 16 * math.sin(math.pi * k / 8) ** 2, COUNT) == [4]


def test_what_a_motor_does_later_does_not_matter(c: Library) -> None:
    """Ways 1, 4, 16 are those of a motor at rest; then it stays at 16, as no motor at rest does."""
    assert told_after(c, lambda k: min(k, 4) ** 2) == []


def test_the_resolution_hides_a_slow_motion(c: Library) -> None:
    """After 8 periods 4 v - 0.3 * 8 v = 1.6 v exceeds a count of 0.5 from v = 0.3125 on."""
    assert told_after(c, lambda k: 0.31 * k, COUNT) == []
    assert told_after(c, lambda k: 0.32 * k, COUNT) == [8]


def test_noise_hides_a_slow_motion_as_well(c: Library) -> None:
    """Five standard deviations of 0.1 are a resolution of 0.5."""
    assert told_after(c, lambda k: 0.31 * k, rough=0.01) == []
    assert told_after(c, lambda k: 0.32 * k, rough=0.01) == [8]


@pytest.mark.parametrize("offset", [0.0, 0.3, 0.49, 0.51, 0.7])
def test_rounding_is_no_motion(c: Library, offset: float) -> None:
    """GIVEN a motor that starts from rest, and any place of it between two counts."""
    for acceleration in (0.01, 0.03, 0.1, 0.3):
        rounded = lambda k: COUNT * round(acceleration * k**2 / 2 / COUNT + offset)  # noqa: E731, B023
        assert told_after(c, rounded, COUNT) == []
