"""The polynomial basis, (18)-(23), against the oracle and against its properties."""

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
