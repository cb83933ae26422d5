"""Signals of FilteredRegression: start, bandwidth, rest, unknown sign of friction."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from c_library import Estimator, Library, load
from c_regression import covariance
from regression_joint import Joint, T

VALUES = {"method": 2, "rls.n": 2, "rls.m": 1, "prior.B": 0.1, "prior.tau_coulomb": 0.02}
SENSOR = 2


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
    assert estimator.state.method.regression.history.unsure == 0.0
    estimator.run(z[1000:])
    count, slow = 2 * np.pi / 40000, 0.05 * T
    known = int(count / slow)  # one count in this number of samples is not slower than `slow`
    unsure = estimator.state.method.regression.history.unsure
    assert unsure == pytest.approx(200 - known, abs=1)


def test_the_largest_basis_has_all_columns(c: Library) -> None:
    eta_0 = np.arange(1.0, 41.0).reshape(8, 5)
    values = {**VALUES, "rls.n": 8, "rls.m": 5, "rls.eta_0": eta_0.tolist()}
    estimator = Estimator(c, {**values, "regression.drift": 1e-3, "prior.nominal": 0.1})
    estimator.run(Joint(duration=0.05).measurements())
    # 40 of the basis, 1 of the nominal curve, 10 always, 8 if the data ask for them, 3 of the
    # motor, but no more powers
    assert estimator.state.method.regression.size == 40 + 1 + 10 + 8 + 3 - 1
    assert np.all(np.isfinite(covariance(estimator)))


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


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"noise.tau": 1e-4},
        {"noise.tau": 1e-4, "motor.gamma": -50.0},
        {"noise.tau": 1e-4, "encoder.theta": 0.0},
        {"noise.tau": 1e-4, "modality": SENSOR},
    ],
    ids=str,
)
def test_the_bandwidth_is_limited_where_rounding_exceeds_the_noise_of_the_torque(
    c: Library, values: dict[str, float]
) -> None:
    p = c.parameters({**VALUES, **values})
    counts = p.encoder.theta
    want = 350.0
    if counts > 0 and p.modality != SENSOR:
        rounding = 2.3e-5 * 50.0 * 2 * np.pi / counts / np.sqrt(12)
        want = min(want, 1.42 * np.sqrt(p.noise.tau / rounding))
    assert c.lib.sh_regression_bandwidth(p) == pytest.approx(want, rel=1e-12)
    assert (want < 350.0) == (
        "noise.tau" in values and len(values) == 1 + ("motor.gamma" in values)
    )


def test_the_roughness_is_the_variance_of_white_noise(c: Library) -> None:
    """GIVEN a smooth motion with white noise, THEN the mean of the roughness is its variance."""
    z = np.zeros((5000, 5))
    t = T * np.arange(len(z))
    z[:, 0] = np.sin(2 * np.pi * t) + 1e-4 * np.random.default_rng(1).normal(size=len(z))
    estimator = Estimator(c, VALUES)
    regression = c.ffi.addressof(estimator.state.method, "regression")
    found = []
    for sample in z:
        estimator.tick(sample)
        found.append(c.lib.sh_signals_roughness(regression))
    assert np.mean(found[10:]) == pytest.approx(1e-8, rel=0.1)


def test_the_plays_are_elastic_up_to_their_widths(c: Library) -> None:
    rng = np.random.default_rng(2)
    phi = 0.3 * np.cumsum(0.02 * rng.normal(size=2000))
    estimator = Estimator(c, {**VALUES, "range.phi": 0.3})
    z = np.zeros((len(phi), 5))
    z[:, 1] = phi
    want = np.zeros(3)
    widths = 0.3 * np.array([0.005, 0.02, 0.08])
    for k, sample in enumerate(z):
        estimator.tick(sample)
        want = np.clip(want + (phi[k] - phi[k - 1] if k else 0.0), -widths, widths)
        found = list(estimator.state.method.regression.history.play)
        assert found == pytest.approx(want.tolist(), abs=1e-12)
    history = estimator.state.method.regression.history
    assert (history.phi_min, history.phi_max) == (phi.min(), phi.max())


def test_a_gap_does_not_end_what_is_known_of_the_deformation(c: Library) -> None:
    """GIVEN plays that are displaced, WHEN samples are lost or refused, THEN the plays and the
    range of the deformation are as before."""
    z = Joint(duration=1.0).measurements()
    states = []
    for bad in (np.nan, 1e11):
        estimator = Estimator(c, {**VALUES, "rls.n": 8, "range.phi": 1e-6})
        estimator.run(z[:500])
        history = c.ffi.new("sh_history *", estimator.state.method.regression.history)
        before = bytes(c.ffi.buffer(history))
        broken = z[500].copy()
        broken[1] = bad
        assert not estimator.tick(broken)
        after = c.ffi.new("sh_history *", estimator.state.method.regression.history)
        assert bytes(c.ffi.buffer(after)) == before
        assert estimator.tick(z[501])
        assert estimator.state.method.regression.history.phi_max == np.max(z[:502, 1] - z[:502, 0])
        states.append(estimator.lasting())
    assert states[0] == states[1]
