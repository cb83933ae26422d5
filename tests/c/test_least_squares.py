"""The recursion in UD factors, against the recursion as printed and the sum that it minimises."""

import math
from typing import Any

import numpy as np
import pytest

import oracle
from c_library import Array, Library, compile_library, covariance, diagonal
from oracle import CONSTANT_FACTOR, ENHANCED, STANDARD
from reference_joints import table1_recording

KINDS = {  # kind: factor and P_0; for ENHANCED those of the paper
    ENHANCED: (1e-20, 1e20),
    STANDARD: (1.0, 1.0),
    CONSTANT_FACTOR: (0.1, 1.0),
}


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Library:
    """The library in the plain C that pair.h has for processors without pairs of doubles."""
    return compile_library(tmp_path_factory.getbasetemp(), "double", "-U__SSE2__", "-U__aarch64__")


class Recursion:
    def __init__(self, c: Library, kind: int, factor: float, P_0: float, eta_0: Array) -> None:
        self.c, self.kind, self.factor = c, kind, factor
        self.state = c.new("sh_least_squares")
        self.P = c.ffi.addressof(self.state, "P")
        self.innovation = c.new("sh_innovation")
        c.lib.sh_least_squares_start(self.state, len(eta_0), c.pointer(eta_0), P_0)

    def update(self, F: Array, y: float) -> bool:
        F = np.ascontiguousarray(F)
        taken = self.c.lib.sh_least_squares_update(
            self.state, self.kind, self.factor, self.c.pointer(F), y, self.innovation
        )
        return bool(taken)

    @property
    def eta(self) -> Array:
        return np.array(list(self.state.eta)[: self.P.size])

    @property
    def diagonal(self) -> Array:
        return diagonal(self.P)

    def bytes(self) -> bytes:
        lasting = [self.state.eta, self.state.eta_low, self.P.U, self.innovation]
        return self.diagonal.tobytes() + b"".join(bytes(self.c.ffi.buffer(a)) for a in lasting)


def error(got: Array, want: oracle.Exact) -> float:
    """Largest error of the entries, relative to the largest entry."""
    wanted = oracle.rounded(want)
    return float(np.max(np.abs(got - wanted)) / np.max(np.abs(wanted)))


def table1_data() -> tuple[Array, Array]:
    """Regressors and torque of the sensor in Table I [size: ticks x 18, ticks]."""
    theta, q, theta_c, _, sensor = table1_recording().measurements().T
    set_point = 100.0 + oracle.DEFAULTS["setPoint.scale"] * theta_c
    F, _ = oracle.basis(6, 3, oracle.exact(set_point), oracle.exact(q - theta))
    return oracle.rounded(F), sensor


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("size", [1, 2, 3, 5, 8, 18, 40])
def test_every_sample_against_the_recursion_as_printed(c: Library, kind: int, size: int) -> None:
    factor, P_0 = KINDS[kind]
    rng = np.random.default_rng(100 * kind + size)
    F, y, eta_0 = rng.normal(size=(60, size)), rng.normal(size=60), rng.normal(size=size)
    want = oracle.least_squares(kind, factor, P_0, eta_0, oracle.exact(F), oracle.exact(y)[:, None])
    recursion = Recursion(c, kind, factor, P_0, eta_0)
    for k in range(60):
        assert recursion.update(F[k], y[k])
        innovation = recursion.innovation
        assert innovation.rho == pytest.approx(float(want.rho[k]), rel=1e-9)
        assert innovation.a == pytest.approx(float(want.a[k]), rel=1e-9)
        assert innovation.epsilon == pytest.approx(float(want.epsilon[k, 0]), rel=1e-9, abs=1e-12)
        assert error(recursion.eta, want.eta[k, :, 0]) < 1e-9
    assert error(covariance(recursion.P), want.P) < 1e-9


@pytest.mark.slow("the oracle computes in many digits")
@pytest.mark.parametrize("kind", [STANDARD, CONSTANT_FACTOR])
def test_P_stays_positive_definite_with_a_large_P_0(c: Library, kind: int) -> None:
    """With P_0 = 1e20 the recursion as printed fails in doubles."""
    F, y = (samples[:5000] for samples in table1_data())
    recursion = Recursion(c, kind, 0.1, 1e20, np.zeros(18))
    weight = np.empty(len(y))
    for k in range(len(y)):
        assert recursion.update(F[k], y[k])
        a, rho = recursion.innovation.a, recursion.innovation.rho
        weight[k] = a / (1 + (1 - a) * rho)
    D, P = recursion.diagonal, covariance(recursion.P)
    assert np.all(np.isfinite(P))
    assert np.all(D > 0)
    assert np.all(D <= 1e20)
    exact_F = oracle.exact(F)
    information = exact_F.T @ (oracle.exact(weight)[:, None] * exact_F)
    information += np.eye(18, dtype=int) / oracle.exact(1e20)
    want = oracle.rounded(oracle.solve(information, oracle.exact(np.eye(18))))
    assert np.diag(P) == pytest.approx(np.diag(want), rel=1e-6)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("bad", [math.inf, -math.inf, math.nan, 1e300, -1e300])
@pytest.mark.parametrize("where", [0, 2, "y"])
def test_a_bad_sample_changes_nothing(c: Library, kind: int, bad: float, where: Any) -> None:
    factor, P_0 = KINDS[kind]
    recursion = Recursion(c, kind, factor, P_0, np.zeros(3))
    recursion.update(np.array([1.0, 2.0, 3.0]), 4.0)
    before = recursion.bytes()
    F, y = np.array([0.5, -1.0, 2.0]), 1.0
    if where == "y":
        y = bad
    else:
        F[where] = bad
    assert not recursion.update(F, y)
    assert recursion.bytes() == before


def test_rounding_errors_of_many_small_moves_do_not_add_up(c: Library) -> None:
    recursion = Recursion(c, STANDARD, 1.0, 1.0, np.array([1e8]))
    v = np.array([1.0])
    for _ in range(100_000):
        c.lib.sh_least_squares_move(recursion.state, 1e-10, c.pointer(v))
    left = recursion.state.eta[0] - 1e8 + recursion.state.eta_low[0]
    assert left == pytest.approx(1e-5, rel=1e-6)


@pytest.mark.parametrize("size", [1, 2, 3])
def test_the_prediction_uses_the_rounding_error_of_the_estimate(c: Library, size: int) -> None:
    recursion = Recursion(c, STANDARD, 1.0, 1.0, np.full(size, 1e8))  # the last digit is 1.5e-8
    c.lib.sh_least_squares_move(recursion.state, 5e-9, c.pointer(np.ones(size)))
    for i in range(size):
        assert recursion.eta[i] == 1e8
        probe = Recursion(c, STANDARD, 1.0, 1.0, np.zeros(size))
        c.ffi.memmove(probe.state, recursion.state, c.ffi.sizeof("sh_least_squares"))
        assert probe.update(np.eye(size)[i], 1e8)
        assert probe.innovation.epsilon == pytest.approx(-5e-9, rel=1e-9)


@pytest.mark.parametrize("size", [1, 2, 3, 4, 5, 7, 8, 9, 18, 40])
def test_pairs_and_plain_c_give_the_same_digits(c: Library, plain: Library, size: int) -> None:
    random = np.random.default_rng(size)
    recursions = [Recursion(each, STANDARD, 1.0, 1e3, np.zeros(size)) for each in (c, plain)]
    for F, y in zip(random.standard_normal((100, size)), random.standard_normal(100), strict=True):
        assert all(each.update(F, y) for each in recursions)
    assert recursions[0].bytes() == recursions[1].bytes()


def test_a_parameter_whose_variance_underflows_leaves_the_others_alone(c: Library) -> None:
    """GIVEN samples that determine the second of two parameters beyond the smallest number."""
    rng = np.random.default_rng(3)
    rls = Recursion(c, STANDARD, 1.0, 1.0, np.zeros(2))
    assert rls.update(np.array([1.0, 1.0]), 5.0)
    for size in (1e60, 1e120, 1e150, 1e160, 1e170):
        assert rls.update(np.array([0.0, size]), 0.0)
    assert rls.diagonal[1] == 0.0
    F = rng.normal(size=2000)
    for f in F:
        assert rls.update(np.array([f, rng.normal()]), 5.0 * f)
    assert rls.eta == pytest.approx([5.0, 0.0], abs=1e-2)
    assert covariance(rls.P)[0, 0] == pytest.approx(1 / (2 + F @ F), rel=1e-9)
    assert rls.P.U[0] == 0.0  # its column is cleared, so that no rounding errors add up there
