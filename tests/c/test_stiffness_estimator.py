"""The whole estimator: parameters, bad samples, long runs, every tick against the oracle."""

import math
from collections.abc import Mapping
from functools import cache
from operator import attrgetter
from typing import Any

import numpy as np
import pytest

import oracle
from c_library import MEASUREMENTS, Array, Estimator, Library
from oracle import DEFAULTS, FILTERED, MODEL, RESIDUAL, SENSOR
from reference_joints import flexibility_torque, lever_arm, table1_recording

MODALITIES = (RESIDUAL, SENSOR, MODEL)
FILTERS = (oracle.MODIFIED_KALMAN, oracle.KALMAN, oracle.FINITE_DIFFERENCE)
RLS: dict[int, Mapping[str, float]] = {
    oracle.ENHANCED: {"rls.kind": oracle.ENHANCED},
    oracle.STANDARD: {"rls.kind": oracle.STANDARD, "rls.P_0": 1.0},
    oracle.CONSTANT_FACTOR: {"rls.kind": oracle.CONSTANT_FACTOR, "rls.P_0": 1.0},
}


REGRESSION = {"method": 2, "rls.n": 3, "prior.B": 0.1}


# Parameters


def test_defaults_are_those_of_the_paper_and_in_their_ranges(c: Library) -> None:
    p = c.parameters({})
    assert c.violation(p) is None
    for name, value in DEFAULTS.items():
        assert attrgetter(name)(p) == pytest.approx(value, rel=1e-15), name
    assert all(entry == 0 for row in p.rls.eta_0 for entry in row)


@pytest.mark.parametrize(
    ("method", "name", "inside", "outside"),
    [
        (1, "residual.K_I", math.nextafter(2000.0, 0.0), 2000.0),  # K_I T = 2
        (2, "regression.bandwidth", math.nextafter(2000.0, 0.0), 2000.0),
        (2, "regression.bandwidth", 0.1, 0.0999),
        (1, "filter.V_min", 10.0, 10.1),  # V_max
        (1, "motor.gamma", -1.0, 0.0),
        (1, "motor.gamma", 0.5, 0.0),
    ],
)
def test_limits_by_other_parameters(
    c: Library, method: int, name: str, inside: float, outside: float
) -> None:
    assert c.violation(c.parameters({"method": method, name: inside})) is None
    problem = c.violation(c.parameters({"method": method, name: outside}))
    assert problem is not None and problem[0] == name
    if name in ("residual.K_I", "regression.bandwidth"):  # the other method does not use it
        assert c.violation(c.parameters({"method": 3 - method, name: outside})) is None


def test_a_curve_of_exact_shape_needs_a_nominal_curve_and_its_uncertainty(c: Library) -> None:
    """FilteredRegression requires both if prior.tau_e = 0, which makes the shape exact."""
    exact = {"method": 2, "prior.tau_e": 0.0}
    for values in (exact, {**exact, "prior.nominal": 0.3}):
        problem = c.violation(c.parameters(values))
        assert problem is not None
        name, received, allowed = problem
        assert (name, received) == ("prior.tau_e", 0.0)
        assert "rls.eta_0" in allowed and "prior.nominal" in allowed
    for nominal, i, fine in ((0.3, 1, True), (0.0, 1, False), (0.3, 2, False)):
        p = c.parameters({**exact, "prior.nominal": nominal, "rls.n": 2})
        p.rls.eta_0[i][0] = -10.0
        assert (c.violation(p) is None) == fine
    assert c.violation(c.parameters({"method": 1, "prior.tau_e": 0.0})) is None


# First tick and structure


@pytest.mark.parametrize("method", [1, 2])
@pytest.mark.parametrize("symmetric", [1, 0])
def test_outputs_before_the_first_tick(c: Library, method: int, symmetric: int) -> None:
    # eta_0 at phi = 0 and theta_c = 0: sigma is the sum over j of offset^j times the coefficients
    # of phi; tau_e is the same sum with the constants, which only the general basis has
    eta_0 = np.zeros((8, 5))
    eta_0[:3, :3] = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [9.0, 9.0, 9.0]]
    values = {"method": method, "rls.eta_0": eta_0.tolist(), "setPoint.offset": 10.0}
    estimate = Estimator(c, {**values, "rls.symmetric": symmetric}).estimate
    assert (estimate.sigma, estimate.tau_e) == ((321.0, 0.0) if symmetric else (654.0, 321.0))
    assert (estimate.setPoint, estimate.phi) == (10.0, 0.0)
    assert [list(row) for row in estimate.eta] == eta_0.tolist()


@pytest.mark.parametrize("kind", RLS)
def test_paper2011_scales_P_with_the_noise(c: Library, kind: int) -> None:
    estimate = Estimator(c, {"rls.kind": kind, "rls.P_0": 1e20, "rls.c": 1e-18}).estimate
    noise = 50.0 * 3.2e-3  # of gamma r_e [N.m]
    weight = 1e-18 if kind == oracle.ENHANCED else 1.0
    derivative = [1.0, 100.0, 100.0**2]  # derivative of l^j phi at l = 100
    want = noise * math.sqrt(weight * 1e20 * sum(d * d for d in derivative))
    assert estimate.sigma_std == pytest.approx(want, rel=1e-12)


# The AwAS as a physical system


def test_modality_can_change_between_ticks(c: Library) -> None:
    # The regression continues with another torque
    z = table1_recording().measurements()[:600]
    estimator = Estimator(c, {"modality": MODEL})
    estimator.run(z[:300])
    c.set(estimator.parameters, "modality", SENSOR)
    second = estimator.run(z[300:])
    # The same result is obtained from a sensor that shows the model's torque until the change
    mixed = z.copy()
    theta, q, theta_c = z[:300, :3].T
    mixed[:300, 4] = flexibility_torque(lever_arm(theta_c), q - theta)
    want = Estimator(c, {"modality": SENSOR}).run(mixed)
    assert second["sigma"] == pytest.approx(want["sigma"][300:], rel=1e-9)
    alone = Estimator(c, {"modality": MODEL}).run(z)
    assert not np.allclose(second["sigma"], alone["sigma"][300:], rtol=1e-6)


@pytest.mark.parametrize("method", [1, 2])
def test_a_mirrored_motion_has_mirrored_torques(c: Library, method: int) -> None:
    """GIVEN all torques, and all positions except theta_c, with the opposite sign."""
    z = table1_recording().measurements()[:4000]
    mirror = np.array([-1.0, -1.0, 1.0, -1.0, -1.0])
    values = {**REGRESSION, "method": method}
    found, mirrored = (Estimator(c, values).run(each) for each in (z, mirror * z))
    assert np.array_equal(mirrored["sigma"], found["sigma"])
    for name in ("tau_e", "theta_dot", "phi", "epsilon"):
        assert np.array_equal(mirrored[name], -found[name]), name


@pytest.mark.parametrize("method", [1, 2])
def test_a_motor_that_turns_the_other_way_gives_the_same_estimate(c: Library, method: int) -> None:
    """Gear ratio and torque of the motor with the other sign. Its friction reverses late."""
    z = table1_recording().measurements()[:6000]
    z[50:, 3] += 0.02 * np.sign(np.gradient(z[:, 0]))[:-50]
    values, gamma = {**REGRESSION, "method": method}, DEFAULTS["motor.gamma"]
    found = Estimator(c, {**values, "motor.gamma": gamma}).run(z)
    turned = Estimator(c, {**values, "motor.gamma": -gamma}).run(z * [1.0, 1.0, 1.0, -1.0, 1.0])
    for name in found.dtype.names or ():
        assert np.array_equal(turned[name], found[name]), name


# Samples that are not finite


LARGEST = {**REGRESSION, "rls.n": 8, "rls.m": 5, "range.phi": 1e-3}


@pytest.mark.parametrize(
    ("values", "at"),
    [
        *(({"deformation": FILTERED}, at) for at in (1, 501)),
        *((REGRESSION, at) for at in (1, 501, 540)),
        *((LARGEST, at) for at in (503, 540)),
    ],
)
@pytest.mark.parametrize(
    ("name", "bad"),
    [
        *((name, bad) for name in MEASUREMENTS for bad in (math.nan, math.inf, -math.inf, 1e300)),
        *((name, bad) for name in ("theta", "q") for bad in (1e12, -1e12)),
    ],
)
def test_a_refused_sample_leaves_the_state_as_a_lost_one(
    c: Library, name: str, bad: float, values: Mapping[str, float], at: int
) -> None:
    """GIVEN a sample that is not finite, or that no joint can give, WHEN it is skipped, THEN all is
    as if it were lost, apart from the gate, which has seen the other signals. No output but `valid`
    changes, and the doubt about an outlier."""
    lost = table1_recording().measurements()[:1500]
    lost[[0, 500, at]] = math.nan
    refused = lost.copy()
    refused[at] = 0.0
    refused[at, MEASUREMENTS.index(name)] = bad
    one, other = (Estimator(c, values) for _ in range(2))
    found, want = one.run(refused), other.run(lost)
    assert np.flatnonzero(found["valid"] == 0).tolist() == sorted({0, 500, at})
    if "method" in values and abs(bad) <= 1e12:
        assert (found["doubt"][at], found["confident"][at]) == (c.lib.SH_DOUBT_OUTLIER, 0)
        want["doubt"][at], want["confident"][at] = found["doubt"][at], 0
    assert found.tobytes() == want.tobytes()
    assert np.all(np.isfinite(found["sigma_std"]))
    for each in (one, other) if "method" in values else ():
        each.state.method.regression.gate = c.new("sh_gate")[0]
    assert one.lasting() == other.lasting()
    found["valid"] = 0
    assert found[499].tobytes() == found[500].tobytes()


def test_the_estimator_starts_with_the_first_good_sample(c: Library) -> None:
    z = table1_recording().measurements()[:1000]
    late = Estimator(c, {})
    for _ in range(3):
        assert not late.tick([math.nan] * 5)
        assert (late.estimate.valid, late.estimate.sigma) == (0, 0.0)
    assert late.run(z).tobytes() == Estimator(c, {}).run(z).tobytes()


@pytest.mark.parametrize("modality", MODALITIES)
@pytest.mark.parametrize("gap", [1, 10, 1000])
def test_the_estimate_stays_accurate_after_a_gap(c: Library, gap: int, modality: int) -> None:
    """For ten time constants of the residual; without a gap, the error is below 1.5 % there."""
    recording = table1_recording()
    z = recording.measurements()
    z[2000 : 2000 + gap, 0] = math.nan
    estimates = Estimator(c, {"modality": modality}).run(z)
    assert np.all(estimates["sigma"][2000 : 2000 + gap] == estimates["sigma"][1999])
    assert np.all(estimates["valid"] == np.isfinite(z[:, 0]))
    after = slice(2000 + gap, 2000 + gap + 34)
    assert np.max(np.abs(estimates["sigma"] / recording.true_sigma - 1)[after]) < 0.05
    if modality != RESIDUAL:  # only the residual has a state that is wrong after a gap
        assert np.all(estimates["a"][after] > 0)


@pytest.mark.parametrize("lost", [0, 3])
def test_the_regression_continues_when_the_residual_has_settled(c: Library, lost: int) -> None:
    """Ten time constants 1 / K_I after the gap, even if samples are lost soon after it."""
    z = table1_recording().measurements()
    z[2000:3000, 0] = math.nan
    z[3010 : 3010 + lost, 0] = math.nan
    a = Estimator(c, {"residual.K_I": 300.0}).run(z)["a"]
    settled = 3000 + math.ceil(10 / 300 / 1e-3)
    assert np.all(a[3000:settled] == 0)
    assert np.all(a[settled : settled + 100] > 0)


def test_the_residual_does_not_integrate_over_a_gap_of_two_time_constants(c: Library) -> None:
    """GIVEN 1 / K_I of two sample periods, WHEN three samples are lost (a step of 2 / K_I), THEN
    the residual does not change; WHEN two are lost, it does."""
    T = 1.0 / 1024.0
    for lost, stays in ((2, False), (3, True)):
        estimator = Estimator(c, {"samplePeriod": T, "residual.K_I": 512.0})
        for k in range(10):
            estimator.tick([1e-3 * k, 0.0, 0.0, 0.1, 0.0])
        before = estimator.estimate.tau_e_residual
        for _ in range(lost):
            assert not estimator.tick([math.nan, 0.0, 0.0, 0.1, 0.0])
        assert estimator.tick([0.02, 0.0, 0.0, 0.3, 0.0])
        assert (estimator.estimate.tau_e_residual == before) == stays


# Every output of every tick


BEGIN = 3000  # ticks of the run of Table I that the oracle computes


@cache
def oracle_of(kind: int) -> dict[tuple[int, int], oracle.Estimate]:
    """Estimates of the oracle for the begin of the run of Table I, by modality and filter."""
    combinations = [(modality, kind) for modality in MODALITIES for kind in FILTERS]
    variants = [{"modality": modality, "filter.kind": kind} for modality, kind in combinations]
    z = table1_recording().measurements()[:BEGIN]
    estimates = oracle.estimator({**DEFAULTS, **RLS[kind]}, z, variants)
    return dict(zip(combinations, estimates, strict=True))


def compare(got: np.ndarray[Any, Any], want: oracle.Estimate, torque: Array) -> None:
    """Every output of every tick, see `oracle.relative_error`. The paper estimates no inertia.

    Two signals are less exact where they cross zero, so their errors are relative to something
    else. The error of epsilon, a difference of two torques with rounding errors, is relative to the
    range of the torque. The vector eta is compared as a whole, with entries scaled by their largest
    values.
    """
    n, m = want["eta"].shape[1:]
    scales = {"epsilon": float(np.ptp(torque))}
    errors = {
        name: oracle.relative_error(got[name], values, scales.get(name))
        for name, values in want.items()
        if name != "eta"
    }
    largest = np.max(np.abs(want["eta"]), axis=0)
    error = np.max(np.abs(got["eta"][:, :n, :m] - want["eta"]) / largest, axis=(1, 2))
    size = np.max(np.abs(want["eta"]) / largest, axis=(1, 2))
    errors["eta"] = float(np.max(error / np.maximum(size, 1e-6)))
    assert max(errors.values()) < 1e-9, errors
    assert np.all(got["misfit"] == 1) and np.all(got["B_hat"] == DEFAULTS["motor.B"])


@pytest.mark.slow("the oracle computes in many digits")
@pytest.mark.parametrize("filter_kind", FILTERS)
@pytest.mark.parametrize("modality", MODALITIES)
@pytest.mark.parametrize("rls_kind", RLS)
def test_table1_against_the_oracle(
    c: Library, rls_kind: int, modality: int, filter_kind: int
) -> None:
    recording = table1_recording()
    want = oracle_of(rls_kind)[modality, filter_kind]
    values = {"modality": modality, "filter.kind": filter_kind, **RLS[rls_kind]}
    got = Estimator(c, {**DEFAULTS, **values}).run(recording.measurements()[:BEGIN])
    torque = {
        RESIDUAL: want["tau_e_residual"],
        SENSOR: recording.measured[:BEGIN, 4],
        MODEL: recording.true_tau_e[:BEGIN],
    }[modality]
    compare(got, want, torque)


ETA_0 = np.pad(np.random.default_rng(5).normal(size=(6, 3)), ((0, 2), (0, 2)))
FILTERED_PHI = {"deformation": FILTERED, "encoder.q": 5000.0, "modality": SENSOR}


@pytest.mark.parametrize(
    "changes",
    [
        {"filter.weighting": oracle.AS_PRINTED},
        {"filter.weighting": oracle.AS_PRINTED, "encoder.theta": 0.0},
        {"encoder.theta": 0.0},
        {"rls.n": 1, "rls.m": 1},
        {"rls.n": 8, "rls.m": 5},
        {"samplePeriod": 2e-3, "residual.K_I": 100.0, "motor.gamma": -20.0},
        {"samplePeriod": 1e-4, "residual.K_I": 10.0},
        {"samplePeriod": 1e-2, "residual.K_I": 199.0},
        {"setPoint.offset": 0.0, "setPoint.scale": 0.01},
        {"rls.symmetric": 0},
        {"rls.symmetric": 0, "rls.n": 1, "rls.m": 1},
        {"rls.symmetric": 0, "rls.n": 8, "rls.m": 1},
        *({**FILTERED_PHI, "filter.kind": kind} for kind in FILTERS),
        {"rls.eta_0": ETA_0.tolist()},
    ],
    ids=lambda changes: ", ".join(changes),
)
def test_other_parameters_against_the_oracle(c: Library, changes: Mapping[str, Any]) -> None:
    z = table1_recording().measurements()[:400]
    values = {**DEFAULTS, **changes}
    eta_0 = ETA_0[:6, :3] if "rls.eta_0" in changes else None
    want = oracle.estimator(values, z, [{}], eta_0)[0]
    torque = z[:, 4] if values["modality"] == SENSOR else want["tau_e_residual"]
    compare(Estimator(c, values).run(z), want, torque)
