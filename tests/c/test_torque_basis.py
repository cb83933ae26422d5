"""The polynomial basis, (18)-(23), against the oracle and against its properties."""

from __future__ import annotations

import numpy as np
import pytest

import oracle
from c_library import Array, Library


def basis(
    c: Library, symmetric: int, n: int, m: int, set_point: float, phi: float
) -> tuple[Array, Array]:
    """F and dF. Checks that nothing behind their end is written."""
    F, dF = np.full(n * m + 1, 123.0), np.full(n * m + 1, 123.0)
    c.lib.sh_torque_basis(symmetric, n, m, set_point, phi, c.pointer(F), c.pointer(dF))
    assert F[-1] == dF[-1] == 123.0
    return F[:-1], dF[:-1]


@pytest.mark.parametrize("symmetric", [1, 0])
@pytest.mark.parametrize("n", range(1, 9))
@pytest.mark.parametrize("m", range(1, 6))
def test_against_the_oracle(c: Library, n: int, m: int, symmetric: int) -> None:
    rng = np.random.default_rng(10 * n + m)
    for set_point, phi in [
        *((100.0, 1e-3), (-70.0, 0.3), (0.0, 0.1), (45.0, 0.0)),
        *rng.normal(size=(20, 2)),
    ]:
        F, dF = basis(c, symmetric, n, m, set_point, phi)
        point = oracle.exact([set_point]), oracle.exact([phi])
        want_F, want_dF = (
            oracle.rounded(part)[0] for part in oracle.basis(n, m, *point, symmetric)
        )
        assert pytest.approx(want_F, rel=1e-14, abs=0.0) == F
        assert pytest.approx(want_dF, rel=1e-14, abs=0.0) == dF


def test_order_of_the_coefficients(c: Library) -> None:
    # (22): powers of the deformation run fastest, F[j n + i] = l^j phi^(2i+1)
    F, dF = basis(c, 1, 3, 2, 10.0, 2.0)
    assert F.tolist() == [2, 8, 32, 20, 80, 320]
    assert dF.tolist() == [1, 12, 80, 10, 120, 800]


def test_order_of_the_coefficients_of_the_general_basis(c: Library) -> None:
    # F[j n + i] = l^j phi^i
    F, dF = basis(c, 0, 4, 2, 10.0, 2.0)
    assert F.tolist() == [1, 2, 4, 8, 10, 20, 40, 80]
    assert dF.tolist() == [0, 1, 4, 12, 0, 10, 40, 120]
