"""misfit.c: how far N blocks contradict the model."""

import math
from typing import Any

import pytest

from c_library import Library


def judged(
    c: Library, N: int, error: float, parameters: int = 18, memory: float = 10.0
) -> tuple[float, float]:
    """q and kappa^2 of N blocks y = 1 + error of weight 1, of which the coefficient 1 explains 1.

    The matrix of the blocks also contains the prior, which does not count.
    """
    blocks, misfit = c.new("sh_information"), c.new("sh_misfit")
    c.lib.sh_information_start(blocks, 1, 1.0)
    for _ in range(N):
        c.lib.sh_information_take(blocks, [1.0, 0.0, 1.0 + error], 1.0)
    c.lib.sh_misfit_start(misfit)
    p = c.parameters({"regression.memory": memory})
    c.lib.sh_misfit_judge(misfit, blocks, 1.0, float(N), [1.0], parameters, p)
    return misfit.square, misfit.variance_factor


def test_the_misfit_is_the_mean_square_of_the_errors(c: Library) -> None:
    """4 blocks with the error 3: q = 9. The variance factor is not below q, as 1 + (q - t) is."""
    assert judged(c, 4, 3.0) == pytest.approx((9.0, 9.0))


def test_a_misfit_does_not_average_out(c: Library) -> None:
    """18 blocks, error 3: t = 1 + 3 sqrt(2/18) = 2, and kappa^2 = 1 + (9 - 2) 18/5."""
    assert judged(c, 18, 3.0) == pytest.approx((9.0, 26.2))


def test_many_blocks_lose_half_a_block_for_each_parameter(c: Library) -> None:
    """50 blocks, error 3, 10 parameters: q = 50 * 9 / 45 = 10, t = 1.6, kappa^2 = 1 + 8.4 * 10."""
    assert judged(c, 50, 3.0, parameters=10) == pytest.approx((10.0, 85.0))


def test_chance_is_no_misfit(c: Library) -> None:
    """18 blocks, error 1.4: q = 1.96 is less than t = 2. An error below 1 counts as 1."""
    assert judged(c, 18, 1.4) == pytest.approx((1.96, 1.96))
    assert judged(c, 18, 0.5) == (1.0, 1.0)


def test_without_memory_a_misfit_has_no_effect(c: Library) -> None:
    assert judged(c, 18, 3.0, memory=0.0) == pytest.approx((9.0, 1.0))


def misfit(c: Library, **values: float) -> Any:
    return c.new("sh_misfit", **{"square": 1.0, "usual": 1.0, "variance_factor": 1.0, **values})


def test_the_usual_misfit_is_a_mean(c: Library) -> None:
    """The second of two blocks: 2 + (3 - 2) / 2. At most 1.7 usual misfits: 2 + (3.4 - 2) / 2. Each
    block may be a change."""
    for square, want in ((9.0, 2.5), (100.0, 2.7)):
        found = misfit(c, square=square, usual=2.0, judged=1.0)
        c.lib.sh_misfit_learn(found, 0.05)
        assert (found.usual, found.judged, found.duration) == pytest.approx((want, 2.0, 0.05))


def test_a_sudden_misfit_is_beyond_the_usual_one(c: Library) -> None:
    """1.7 usual misfits, once these are known from 300 blocks."""

    def is_sudden(square: float, judged: float) -> bool:
        found = misfit(c, square=square, usual=2.0, judged=judged)
        return bool(c.lib.sh_misfit_is_sudden(found))

    assert is_sudden(3.41**2, 300.0)
    assert not is_sudden(3.39**2, 300.0)
    assert not is_sudden(3.41**2, 299.0)


@pytest.mark.parametrize(
    ("factor", "N", "parameters", "want"),
    [(1.51, 20.0, 9, math.exp(-1 / 10)), (1.49, 20.0, 9, 1.0), (1.51, 20.0, 20, 1.0)],
)
def test_data_are_forgotten_if_many_blocks_contradict_the_model(
    c: Library, factor: float, N: float, parameters: int, want: float
) -> None:
    """One second of blocks, a memory of 10 s."""
    found = misfit(c, variance_factor=factor, duration=1.0)
    p = c.parameters({"regression.memory": 10.0})
    assert c.lib.sh_misfit_forgetting(found, N, parameters, p) == pytest.approx(want)
    assert found.duration == 0.0
