"""The polynomial basis, (18)-(23), against the oracle and against its properties."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import oracle
from c_library import Array, Library, load


@pytest.fixture(scope="module")
def c(build: Path) -> Library:
    return load(build)


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


@pytest.mark.parametrize("symmetric", [1, 0])
@pytest.mark.parametrize("phi", [0.02, -0.3, 1.0])
def test_derivative_against_central_differences(c: Library, phi: float, symmetric: int) -> None:
    # Central differences at h and 2 h, extrapolated: the error is of order h^4
    def central(h: float) -> Array:
        above, below = (basis(c, symmetric, 6, 3, 1.3, phi + s * h)[0] for s in (1, -1))
        quotient: Array = (above - below) / (2 * h)
        return quotient

    h = 1e-3 * abs(phi)
    differences = (4 * central(h) - central(2 * h)) / 3
    assert basis(c, symmetric, 6, 3, 1.3, phi)[1] == pytest.approx(differences, rel=1e-8, abs=1e-10)


def test_symmetry_of_the_transmission(c: Library) -> None:
    # (16): without deformation there is no torque; the torque is an odd function of the
    # deformation, and the stiffness an even one
    F, dF = basis(c, 1, 8, 5, 100.0, 0.0)
    assert np.all(F == 0)
    assert dF.reshape(5, 8)[:, 0].tolist() == [1, 1e2, 1e4, 1e6, 1e8]
    assert np.all(dF.reshape(5, 8)[:, 1:] == 0)
    F, dF = basis(c, 1, 8, 5, 100.0, 0.1)
    mirrored_F, mirrored_dF = basis(c, 1, 8, 5, 100.0, -0.1)
    assert np.all(mirrored_F == -F)
    assert np.all(mirrored_dF == dF)


def test_the_general_basis_without_deformation(c: Library) -> None:
    # Only the constants give a torque, which depends on the set-point, and only phi^1 a stiffness
    F, dF = basis(c, 0, 8, 5, 100.0, 0.0)
    powers = [1, 1e2, 1e4, 1e6, 1e8]
    assert F.reshape(5, 8)[:, 0].tolist() == powers
    assert np.all(F.reshape(5, 8)[:, 1:] == 0)
    assert dF.reshape(5, 8)[:, 1].tolist() == powers
    assert np.all(np.delete(dF.reshape(5, 8), 1, axis=1) == 0)


def test_odd_powers_of_the_general_basis_are_the_symmetric_basis(c: Library) -> None:
    odd = [part.reshape(5, 4) for part in basis(c, 1, 4, 5, 7.0, -0.3)]
    general = [part.reshape(5, 8)[:, 1::2] for part in basis(c, 0, 8, 5, 7.0, -0.3)]
    assert general == [pytest.approx(part, rel=1e-15, abs=0.0) for part in odd]
