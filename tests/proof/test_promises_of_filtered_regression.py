"""Numerical promises of the blocks of FilteredRegression: docs/proof/promises.md."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from c_library import Array, Estimator, Library
from c_regression import factors
from edges import LARGEST, SUBNORMAL, c, magnitudes, often, reals

__all__ = ["c"]  # a fixture

signed = st.builds(
    lambda sign, x: sign * x,
    st.sampled_from([-1.0, 1.0]),
    st.one_of(st.sampled_from([0.0, *SUBNORMAL]), magnitudes(1e-12, LARGEST)),
)


def filled(c: Library, rng: np.random.Generator, size: int, scale: float) -> Any:
    """Information of samples, with one that is taken twice."""
    a = c.new("sh_information")
    c.lib.sh_information_start(a, size, 1.0)
    for _ in range(2 * size):
        take(c, a, scale * rng.normal(size=size + 2) * 10.0 ** rng.uniform(-4, 4, size + 2), 1.0)
    return a


def take(c: Library, a: Any, x: Array, w: float) -> float:
    row = reals(c, x)
    return float(c.lib.sh_information_take(a, c.pointer(row), w))


@often
@given(data=st.data())
def test_information_only_grows_with_samples(c: Library, data: st.DataObject) -> None:
    size, scale = data.draw(st.sampled_from([1, 2, 9, 64])), data.draw(magnitudes(1e-12, 1e6))
    rng, w = np.random.default_rng(data.draw(st.integers(0))), data.draw(magnitudes(1e-12, 1e6))
    a = filled(c, rng, size, scale)
    for _ in range(20):
        before = factors(a)[1]
        left = take(c, a, scale * rng.normal(size=size + 2), w)
        assert np.all(factors(a)[1] >= before)
        assert np.all(before >= 1)
        assert 0 <= left <= float(reals(c, [w])[0])


@often
@given(data=st.data())
def test_process_noise_leaves_information_above_zero(c: Library, data: st.DataObject) -> None:
    size, scale = data.draw(st.sampled_from([1, 3, 9])), data.draw(magnitudes(1e-6, 1e6))
    rng = np.random.default_rng(data.draw(st.integers(0)))
    variances = [0.0, *([1e300] if c.real == "double" else [1e38, math.inf])]
    variance = data.draw(st.one_of(magnitudes(1e-12, 1e12), st.sampled_from(variances)))
    a = filled(c, rng, size, scale)
    for _ in range(20):
        v = reals(c, scale * rng.normal(size=size))
        c.lib.sh_information_drift(a, c.pointer(v), variance)
        U, D, z = factors(a)
        assert np.all(D > 0)
        assert all(np.all(np.isfinite(each)) for each in (U, D, z, a.squares))


@often
@given(data=st.data())
def test_motion_sign(c: Library, data: st.DataObject) -> None:
    """The sign is at most 1 while the motor goes on, and at most 2 if it reverses within a sample.
    Otherwise, the sign is at most 1 more than the sum of the signs since the last count.
    """
    count, slow = data.draw(magnitudes(0, 1e12)), data.draw(magnitudes(1e-24, 1e12))
    motion = c.new("sh_motion_sign")
    c.lib.sh_motion_sign_start(motion, data.draw(signed))
    for position in data.draw(st.lists(signed, min_size=20, max_size=60)):
        waited = motion.waiting
        c.lib.sh_motion_sign_step(motion, position, count, slow)
        assert abs(motion.direction) <= 1
        assert abs(motion.sign) <= max(2, 1 + waited)
        assert abs(motion.given) <= motion.waiting
        assert 0 <= motion.unknown <= 1 + waited


@pytest.mark.parametrize("D", [2.0, 1e7, 1e9, 1e18, 1e25])
def test_the_removal_of_rounding_leaves_the_prior(c: Library, D: float) -> None:
    posterior = c.new("sh_posterior", weight=1.0)
    c.lib.sh_information_start(c.ffi.addressof(posterior, "information"), 1, D)
    c.lib.sh_posterior_count_noise(posterior, 2 * D, 0.0)
    c.lib.sh_posterior_remove(posterior, 0.1)
    assert posterior.information.D[0] == 1
    assert all(map(math.isfinite, posterior.information.U[0:2]))


@often
@given(wT=st.sampled_from([1e-4, 1.0001e-4, 0.01, 1.99]), T=magnitudes(1e-9, 1e30))
def test_the_noise_of_the_filter_is_finite_at_every_bandwidth(
    c: Library, wT: float, T: float
) -> None:
    # The number of samples of the sum is computed as an integer.
    design = c.lib.sh_state_variable_filter_design(wT / T, T)
    pointer = c.new("sh_filter_design")
    pointer[0] = design
    gains = [c.ffi.new("sh_real *") for _ in range(2)]
    c.lib.sh_state_variable_filter_noise(pointer, 1.0, 8, *gains)
    assert all(0 <= gain[0] < math.inf for gain in gains)


# Cases that overflowed, mostly in single precision


def test_a_stiff_joint_has_finite_coefficients(c: Library) -> None:
    """The coefficient of phi^15 is 1e45 N.m at a range of 1 mrad, more than a float can hold."""
    estimate = Estimator(c, {"method": 2, "range.phi": 1e-3, "rls.n": 8}).estimate
    assert np.all(np.isfinite([list(row) for row in estimate.eta]))


def test_a_weight_whose_square_overflows_leaves_the_blocks_finite(c: Library) -> None:
    estimator = Estimator(c, {"method": 2, "modality": 2, "noise.tau_e": 1e-12, "encoder.theta": 0})
    c.set(estimator.parameters, "encoder.q", 0)
    k = np.arange(2000)
    z = np.zeros((2000, 5))
    z[:, 1], z[:, 4] = 1e-4 * np.sin(0.01 * k), 1e-2 * np.sin(0.01 * k)
    estimator.run(z)
    bank = estimator.state.method.regression.bank
    assert np.all(np.isfinite(factors(bank.constant)[1]))


def test_a_stiffness_that_is_too_large_for_the_next_row_does_not_block_all_rows(c: Library) -> None:
    """GIVEN a sensor that gives 1e12 N.m, and so a stiffness of 1e15 N.m/rad in single precision,
    WHEN the motor data are used instead, THEN at most one sample is skipped. The column of the
    motor encoder is multiplied by the stiffness."""
    values = {"method": 2, "modality": 2, "rls.n": 8, "rls.m": 1, "prior.eccentric_motor": 1e6}
    estimator, k = Estimator(c, values), np.arange(200)
    z = np.zeros((200, 5))
    z[:, 1], z[:, 4] = 0.3 * np.sin(0.1 * k), 1e12 * np.sin(0.1 * k)
    estimator.run(z)
    z[0, 1] = 2.0
    estimator.run(z[:1])
    c.set(estimator.parameters, "modality", 1)
    assert estimator.repeat(z[1:], 199) >= 198


def test_the_variance_of_a_direction_that_is_well_known_does_not_overflow(c: Library) -> None:
    a = c.new("sh_information")
    first, second = reals(c, [1e20]), reals(c, [1.0])
    c.lib.sh_information_start(a, 1, 1e30)
    D = c.lib.sh_information_last(a).D
    found = c.lib.sh_information_variances(a, D, c.pointer(first), c.pointer(second))
    assert found.first == pytest.approx(1e10)


def test_an_initial_curve_that_overflows_starts_with_finite_outputs(c: Library) -> None:
    values = {"setPoint.offset": 1e12, "rls.eta_0": [[1e12] * 5] * 8, "rls.symmetric": 0}
    for method in (1, 2):
        estimate = Estimator(c, {"method": method, **values}).estimate
        assert math.isfinite(estimate.sigma)
        assert math.isfinite(estimate.tau_e)
        assert estimate.sigma_std >= 0
