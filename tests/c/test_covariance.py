"""Estimates with their covariance, against dense matrices and against the outputs."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from c_library import Array, Estimator, Library
from dense_regression import START, Oracle
from regression_joint import Joint

SHORT = Joint(duration=1.5, tau_coulomb=0.02)
PHI = (-0.02, 0.0, 0.03)
SET_POINT = 75.0
NAMES = ("B", "D_theta", "tau_coulomb", "load_friction", "hysteresis", "lost_torque")


def covariance(estimator: Estimator) -> tuple[int, Array, Array, Array]:
    """Status, values, change per gain, and covariance of the stiffness at PHI and of NAMES."""
    library = estimator.library
    size = len(PHI) + len(NAMES)
    found = [np.full(n, np.nan) for n in (size, size, size * size)]
    points = [np.array(PHI), np.full(len(PHI), SET_POINT)]
    pointers = [library.pointer(each) for each in (*points, *found)]
    of_joint = estimator.state, estimator.parameters, len(PHI)
    status = library.lib.sh_estimator_covariance(*of_joint, *pointers)
    return status, found[0], found[1], found[2].reshape(size, size)


def test_it_is_the_covariance_of_dense_matrices(c: Library) -> None:
    p = {**START, "rls.n": 2, "rls.m": 1, "motor.B": 2.5e-5}
    z = replace(SHORT, counts=p["encoder.theta"]).measurements()
    estimator, oracle = Estimator(c, p), Oracle(c, p, z, np.full(len(z), p["modality"]))
    estimator.run(z)
    oracle.run()
    _, values, per_gain, found = covariance(estimator)
    beta, P = oracle.live.weighted()
    chosen = oracle.live.chosen
    columns = [oracle.columns[i] for i in chosen]
    factors = {"INERTIA": p["motor.B"], "VISCOUS": p["motor.D_theta"], "COULOMB": 1.0}
    gradients = []
    for kind, factor in factors.items():
        own = [factor * prior if each == kind else 0.0 for each, _, prior in columns]
        gradients.append(np.array(own, np.longdouble))
    J = np.array(gradients)
    expected = np.array(J @ P @ J.T, np.float64)
    first = len(PHI)
    of_motor = found[first : first + 3, first : first + 3]
    stds = np.sqrt(np.diag(expected))
    np.testing.assert_allclose(of_motor / np.outer(stds, stds), expected / np.outer(stds, stds),
                               atol=1e-6)  # fmt: skip
    offsets = np.array([p["motor.B"], p["motor.D_theta"], 0.0])
    motor = slice(first, first + 3)
    np.testing.assert_allclose(values[motor], offsets + np.array(J @ beta[:, 1], float), rtol=1e-6)
    np.testing.assert_allclose(per_gain[motor], np.array(J @ beta[:, 0], float), rtol=1e-5)


def test_values_and_variances_are_those_of_the_outputs(c: Library) -> None:
    """Without the gain and the errors of the deformation, sigma_std has nothing else."""
    values: dict[str, Any] = {"method": 2, "rls.n": 3, "prior.torque_gain": 0.0}
    values |= {"prior.eccentric": 0.0, "encoder.theta": 0.0, "encoder.q": 0.0, "prior.power": 0.0}
    values |= {"regression.decimation": 1, "prior.tau_coulomb": 0.02}
    estimator = Estimator(c, values)
    estimator.run(Joint(duration=2.0).measurements())
    status, found, _, P = covariance(estimator)
    assert status == 0
    for i, phi in enumerate(PHI):
        point = c.new("sh_point")
        c.lib.sh_estimator_evaluate(estimator.state, estimator.parameters, phi, SET_POINT, point)
        assert found[i] == pytest.approx(point.sigma, rel=1e-12)
        assert np.sqrt(P[i, i]) == pytest.approx(point.sigma_std, rel=1e-9)
    e = estimator.estimate
    for name, value in zip(NAMES[:5], found[len(PHI) :], strict=False):
        assert value == pytest.approx(getattr(e, f"{name}_hat"), rel=1e-9, abs=1e-12)
    np.testing.assert_array_equal(P, P.T)
    used = np.diag(P) > 0
    correlations = P[np.ix_(used, used)] / np.sqrt(np.outer(np.diag(P)[used], np.diag(P)[used]))
    assert np.min(np.linalg.eigvalsh(correlations)) > -1e-6


def test_the_whole_estimate_is_in_proportion_to_the_gain(c: Library) -> None:
    """With wide priors, nothing but the torque has the unit of a torque."""
    wide = {"prior.B": 1e3, "prior.D_theta": 1e3, "prior.tau_coulomb": 10.0, "prior.tau_e": 1e4}
    estimator = Estimator(c, {"method": 2, "rls.n": 1, "rls.m": 1, **wide})
    estimator.run(replace(SHORT, duration=4.0).measurements())
    _, values, per_gain, _ = covariance(estimator)
    motor = [0, 1, 2, 3, 4, 5]
    np.testing.assert_allclose(per_gain[motor] / values[motor], 1.0, rtol=0.02)


def test_paper2011_claims_nothing(c: Library) -> None:
    estimator = Estimator(c, {"method": 1})
    estimator.run(SHORT.measurements())
    status, *found = covariance(estimator)
    assert status == 1 and all(np.all(np.isnan(each)) for each in found)
