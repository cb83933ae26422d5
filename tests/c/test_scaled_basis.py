"""The basis that is scaled with its ranges, against the basis of the paper."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from c_library import Array, Library, load

GUARD = 123.0


@pytest.fixture(scope="module")
def c(build: Path) -> Library:
    return load(build)


@pytest.mark.parametrize("symmetric", [1, 0])
@pytest.mark.parametrize("n,m", [(1, 1), (1, 5), (3, 2), (8, 1), (8, 5)])
@pytest.mark.parametrize("phi", [0.0, 0.13, -0.4])
def test_the_basis_of_the_paper_times_the_units_is_the_scaled_basis(
    c: Library, symmetric: int, n: int, m: int, phi: float
) -> None:
    """So the same coefficients, converted with these units, give the same torque and stiffness."""
    arrays: list[Array] = [np.full(n * m + 1, GUARD) for _ in range(5)]
    F, dF, units, want_F, want_dF = arrays
    scale = c.new("sh_range_parameters", phi=0.3, setPoint=70.0)
    size, set_point = (symmetric, n, m), 45.0
    c.lib.sh_scaled_basis(scale, *size, set_point, phi, c.pointer(F), c.pointer(dF))
    for i in range(n * m):
        units[i] = c.lib.sh_scaled_basis_unit(scale, symmetric, i % n, i // n)
    c.lib.sh_torque_basis(*size, set_point, phi, c.pointer(want_F), c.pointer(want_dF))
    assert all(array[-1] == GUARD for array in arrays)
    assert F[:-1] == pytest.approx(want_F[:-1] * units[:-1], rel=1e-13, abs=0.0)
    assert dF[:-1] == pytest.approx(want_dF[:-1] * units[:-1], rel=1e-13, abs=0.0)


def test_at_the_ends_of_both_ranges_all_slopes_are_equal(c: Library) -> None:
    F, dF = np.zeros(6), np.zeros(6)
    scale = c.new("sh_range_parameters", phi=0.3, setPoint=70.0)
    c.lib.sh_scaled_basis(scale, 1, 3, 2, 70.0, 0.3, c.pointer(F), c.pointer(dF))
    assert pytest.approx([1, 1 / 3, 1 / 5] * 2) == F
    assert dF == pytest.approx(np.full(6, 1 / 0.3))
