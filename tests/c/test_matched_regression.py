"""The matched regression: properties that the outputs of the estimator do not show."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from c_library import Estimator, Library, load
from matched_joint import Joint, T

VALUES = {"method": 2, "rls.n": 2, "rls.m": 1, "prior.B": 0.1, "prior.tau_coulomb": 0.02}


@pytest.fixture(scope="module")
def c(build: Path) -> Library:
    return load(build)


def test_samples_with_unknown_sign_of_friction_are_counted(c: Library) -> None:
    """GIVEN a motor that turns for one second and stops, THEN samples are counted from the time on
    at which a motion at the velocity `slow` would have shown another count."""
    z = np.zeros((1200, 5))
    turning = 0.4 * T * np.arange(1000)  # a few counts in every sample
    z[:1000, 0] = z[:1000, 1] = np.round(turning / (2 * np.pi) * 40000) / 40000 * 2 * np.pi
    z[1000:, :2] = z[999, :2]
    estimator = Estimator(c, VALUES)
    estimator.run(z[:1000])
    assert estimator.state.method.matched.unsure == 0.0
    estimator.run(z[1000:])
    count, slow = 2 * np.pi / 40000, 0.05 * T
    known = int(count / slow)  # one count in this number of samples is not slower than `slow`
    assert estimator.state.method.matched.unsure == pytest.approx(200 - known, abs=1)


def test_a_step_with_a_good_sample_returns_one(c: Library) -> None:
    z = Joint(duration=0.1).measurements()
    ffi, lib = c.ffi, c.lib
    p = c.parameters({"rls.n": 1, "rls.m": 1, "noise.tau": 0.1, "prior.tau_e": 1.0})
    p.prior.D_theta = p.prior.tau_coulomb = 0.0
    matched, rls = c.new("sh_matched_regression"), c.new("sh_least_squares")
    lib.sh_matched_start(matched, rls, p, ffi.new("double[1]"))
    lib.sh_matched_resume(matched, p)
    y, innovation, F = ffi.new("double *"), c.new("sh_innovation"), ffi.new("double[1]", [0.1])
    updated = []
    for theta, _, _, tau, _ in z:
        arguments = (float(theta), float(tau), 0.02, 100.0, F, y, innovation)
        assert lib.sh_matched_step(matched, rls, p, *arguments) == 1
        updated.append(innovation.a)
    assert set(updated) == {0.0, 1.0}  # both while the filters settle and after


def test_the_prior_of_the_largest_basis_leaves_the_motor_data_at_zero(c: Library) -> None:
    """The parameters behind the coefficients of the torque are those of the motor."""
    eta_0 = np.arange(1.0, 41.0).reshape(8, 5)
    values = {**VALUES, "rls.n": 8, "rls.m": 5, "rls.eta_0": eta_0.tolist()}
    values["matched.drift"] = 1e-3
    estimator = Estimator(c, values)
    estimator.run(Joint(duration=0.05).measurements())
    assert estimator.state.rls.P.size == 43
    assert np.all(np.isfinite(estimator.covariance()))


def test_a_motor_at_rest_at_any_position_is_used_from_the_first_sample(c: Library) -> None:
    z = np.zeros((50, 5))
    z[:, 0] = z[:, 1] = 1.0
    found = Estimator(c, VALUES).run(z)
    assert np.all(found["valid"] == 1)
    assert np.all(found["a"] == 1.0)


def test_a_motor_that_moves_at_the_first_step_is_used_later(c: Library) -> None:
    z = np.zeros((50, 5))
    z[1:, 0] = z[1:, 1] = 3 * 2 * np.pi / 40000 + 0.05 * T
    found = Estimator(c, VALUES).run(z)
    settling = 12 / 350.0 / T  # number of ticks in twelve time constants of the filter
    assert np.flatnonzero(found["a"][1:])[0] == pytest.approx(settling, abs=2)


@pytest.mark.parametrize("sigma", [0.0, 1e3, -1e5])
def test_the_variance_of_a_sample_at_rest(c: Library, sigma: float) -> None:
    """GIVEN a joint at rest, THEN its k-th sample has the variance R (1 + k c / R)^2, with R of
    torque noise and rounding, and c of the rounding, whose error is the same in all samples."""
    count, count_q, noise, gamma = 1e-4, 3e-4, 2e-3, 50.0
    values = {"rls.n": 1, "rls.m": 1, "noise.tau": noise, "motor.gamma": gamma, "prior.tau_e": 3.0}
    counts = {"encoder.theta": 2 * np.pi / count, "encoder.q": 2 * np.pi / count_q}
    p = c.parameters({**values, **counts, "prior.D_theta": 0.0, "prior.tau_coulomb": 0.0})
    matched, rls = c.new("sh_matched_regression"), c.new("sh_least_squares")
    F, y, innovation = c.ffi.new("double[1]", [0.7]), c.ffi.new("double *"), c.new("sh_innovation")
    c.lib.sh_matched_start(matched, rls, p, c.ffi.new("double[1]"))
    rounding = sigma**2 * (count**2 + count_q**2) / 12
    R = rounding + (gamma * noise) ** 2
    for k in range(5):
        P = c.lib.sh_ud_factor_entry(c.ffi.addressof(rls, "P"), 0, 0)
        arguments = (0.0, 0.0, 0.2, sigma, F, y, innovation)
        assert c.lib.sh_matched_step(matched, rls, p, *arguments) == 1
        filtered = 0.7 - matched.column[0].behind[2]
        want = R * (1 + k * rounding / R) ** 2
        assert innovation.rho == pytest.approx(filtered**2 * P / want, rel=1e-9)
