"""The method FilteredRegression: wrong motor data, drift, unknown errors, start and gaps."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from c_library import Estimator, Library
from c_regression import covariance
from oracle import MODEL, RESIDUAL, SENSOR
from reference_joints import table1_recording
from regression_joint import GAMMA, SETTINGS, STIFFNESS, Joint, MisfitJoint, T, at_rest

PAPER2011, FILTERED_REGRESSION = 1, 2
REGRESSION = {"method": FILTERED_REGRESSION, "rls.n": 3}
ALL = {**REGRESSION, "prior.B": 0.1}


def error(found: np.ndarray[Any, Any], joint: Joint, after: float) -> float:
    """Root mean square of the relative error after a time [s]."""
    k = round(after / T)
    return float(np.sqrt(np.mean((found["sigma"][k:] / joint.sigma[k:] - 1) ** 2)))


def test_before_the_first_tick_the_estimate_is_the_prior(c: Library) -> None:
    e = Estimator(c, {**ALL, "setPoint.offset": 70.0}).estimate
    # At phi = 0 only the columns phi r^j have a slope, j = 0..2, with r relative to 100 mm.
    assert (e.sigma, e.tau_e) == (0.0, 0.0)
    assert e.sigma_std == pytest.approx(45.0 / 0.3 * math.sqrt(1 + 0.7**2 + 0.7**4), rel=1e-12)
    assert (e.D_theta_hat, e.B_hat, e.tau_coulomb_hat) == (1e-3, 2.3e-5, 0.0)
    assert e.confident == 0


# Wrong motor data


NONE, FRICTION = 1, 6  # reasons of doubt


@pytest.mark.parametrize(
    ("late", "D_theta", "doubt"), [(0, 2e-4, NONE), (3, 2.6e-4, NONE), (10, 2e-4, FRICTION)]
)
def test_a_link_that_is_read_late_looks_like_friction_below_0(
    c: Library, late: int, D_theta: float, doubt: int
) -> None:
    """The friction is unknown. The friction is in doubt if it is below 0."""
    z = Joint(D_theta=D_theta).measurements()
    z[late:, 1] = z[: len(z) - late, 1]
    found = Estimator(c, {**REGRESSION, "prior.D_theta": 1000.0}).run(z)
    assert (found["D_theta_hat"][-1] < 0) == (doubt == FRICTION)
    assert np.mean(found["doubt"][9000:] == doubt) > 0.8
    assert np.all(found["confident"][9000:] == (doubt == NONE))


def test_rounding_alone_does_not_change_the_inertia(c: Library) -> None:
    """GIVEN a motor so slow that its inertia has no effect, WHEN it has turned for a long time,
    THEN B_hat has hardly changed, although theta'' consists of rounding errors."""
    joint = Joint(duration=40.0, frequency=0.02, amplitude=30.0, B=1.1 * 2.3e-5)
    estimator = Estimator(c, ALL)
    found = estimator.run(joint.measurements())
    assert found["B_hat"][-1] == pytest.approx(2.3e-5, rel=0.2)


@pytest.mark.parametrize("modality", [SENSOR, MODEL])
def test_stiffness_is_estimated_from_other_sources_of_the_torque(c: Library, modality: int) -> None:
    joint = Joint(duration=4.0)
    found = Estimator(c, {**REGRESSION, "modality": modality}).run(joint.measurements())
    assert error(found, joint, 1.0) < 0.02


def test_confident_compares_the_standard_deviation_with_the_threshold(c: Library) -> None:
    """The variance of N blocks of 50 ms counts 1 + 10/N times; the first two may be partial."""
    joint = Joint(duration=4.0)
    values = {**REGRESSION, "limit.relative_std": 0.05, "prior.torque_gain": 0.0}
    found = Estimator(c, values).run(joint.measurements())
    confident = found["confident"] == 1
    least, most = (np.maximum(joint.t / 0.05 - missing, 1) for missing in (2, 0))
    assert np.all(confident[found["sigma_std"] * np.sqrt(1 + 10 / least) < 0.05 * found["sigma"]])
    assert np.all((found["sigma_std"] * np.sqrt(1 + 10 / most) < 0.05 * found["sigma"])[confident])
    assert 0.5 < joint.t[np.argmax(confident)] < 2 and confident[-1]


@pytest.mark.parametrize("method", [PAPER2011, FILTERED_REGRESSION])
def test_a_stiffness_of_zero_is_not_confident(c: Library, method: int) -> None:
    """If the basis has no slope, the standard deviation is also 0."""
    values = {"method": method, "rls.n": 1, "rls.symmetric": 0}
    estimator = Estimator(c, values)
    assert (estimator.estimate.sigma, estimator.estimate.sigma_std) == (0.0, 0.0)
    assert not estimator.estimate.confident
    assert not np.any(estimator.run(Joint(duration=1.0).measurements())["confident"])


# Start


@pytest.mark.parametrize("counts", [1024.0, 4096.0, 65536.0])
def test_a_log_may_begin_in_motion(c: Library, counts: float) -> None:
    """GIVEN ten logs that begin anywhere in a motion, THEN the model fits them, and the estimate is
    not confident and three standard deviations off."""
    values = {**SETTINGS, "encoder.theta": counts, "encoder.q": counts}
    for seed in range(10):
        joint = MisfitJoint(duration=5.0, seed=seed, counts=counts)
        part = slice(1758, 4758)
        found = Estimator(c, values).run(joint.measurements()[part])
        wrong = np.abs(found["sigma"] - STIFFNESS) > 3 * found["sigma_std"]
        assert np.max(found["misfit"]) < 2
        assert np.mean(wrong & (found["confident"] == 1)) < 0.01


@pytest.mark.parametrize("counts", [1024.0, 4096.0, 65536.0])
def test_a_motor_that_starts_at_rest_is_used_from_the_first_sample_on(
    c: Library, counts: float
) -> None:
    values = {**SETTINGS, "encoder.theta": counts, "encoder.q": counts}
    for seed in range(10):
        joint = MisfitJoint(duration=1.0, seed=seed, counts=counts)
        assert np.all(Estimator(c, values).run(joint.measurements())["a"] == 1)


# Drift


def test_the_estimate_follows_a_spring_that_ages_and_does_not_change_at_rest(c: Library) -> None:
    joint = Joint(duration=30.0, stiffness=lambda t: 1 - 0.3 * np.clip((t - 10) / 10, 0, 1))
    estimator = Estimator(c, {**REGRESSION, "regression.drift": 1e-3})
    z = joint.measurements()
    found = estimator.run(z)
    assert error(found, joint, 20.0) < 0.05
    # without drift the change is noticed instead, section 12, which depends on the noise
    joints = [replace(joint, seed=seed) for seed in range(1, 5)]
    noticed = [error(Estimator(c, REGRESSION).run(j.measurements()), j, 20.0) for j in joints]
    assert np.sqrt(np.mean(np.square(noticed))) < 0.1
    # without memory it is not
    fixed = {**REGRESSION, "regression.memory": 0.0}
    assert error(Estimator(c, fixed).run(z), joint, 20.0) > 0.2

    rest = at_rest(z)
    estimator.repeat(rest, 1000)
    before = estimator.estimate.sigma
    estimator.repeat(rest, 300_000)
    assert estimator.estimate.sigma == pytest.approx(before, rel=0.01)
    P = covariance(estimator)
    assert np.all(np.diag(P) <= 1 + 1e-9)
    assert np.all(np.linalg.eigvalsh(P) > 0)


# Errors that do not average out


def test_a_long_rest_does_not_make_the_estimate_more_certain_than_its_rounding(c: Library) -> None:
    """The joint is held at a deformation of 0.6 counts, which the encoders show as one count."""
    # A constant torque may also be a bias, or the eccentricity of an encoder that does not turn.
    constant = {"prior.bias": 0.0, "prior.eccentric": 0.0}
    count, sigma = 2 * np.pi / 40000, 140.0
    z = np.zeros((1000, 5))
    z[:, 1] = count
    z[:, 3] = -sigma * 0.6 * count / GAMMA
    values = {**REGRESSION, **constant, "prior.D_theta": 0.0, "prior.tau_coulomb": 0.0}
    estimator = Estimator(c, values)
    estimator.repeat(z, 1_000_000)
    assert estimator.estimate.sigma == pytest.approx(0.6 * sigma, rel=0.2)
    assert abs(estimator.estimate.sigma - sigma) < 2.5 * estimator.estimate.sigma_std


@pytest.mark.parametrize("modality", [RESIDUAL, SENSOR])
def test_the_last_digit_of_a_position_does_not_matter(c: Library, modality: int) -> None:
    """q - theta changes only by rounding, as if both encoders had moved by the same count."""
    z = table1_recording().measurements()[:2000]
    other = z.copy()
    other[:, 1] += 1e-13 * np.random.default_rng(4).normal(size=len(z))
    values = {**REGRESSION, "modality": modality}
    one, two = (Estimator(c, values).run(samples)["sigma"][1000:] for samples in (z, other))
    np.testing.assert_allclose(one, two, rtol=1e-7)
