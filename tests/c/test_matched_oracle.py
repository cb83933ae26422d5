"""MatchedFilter, every tick, against a second implementation from docs/matched-filter.md.

It shares nothing with the C code except the direction of motion, which has its own tests. The
filter is that of scipy, the covariance is a matrix in extended precision, and each step is written
as the page describes it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import signal

from c_library import Array, Estimator, Library, load
from matched_joint import Joint
from oracle import RESIDUAL, SENSOR
from reference_plant import table1_recording

START: Mapping[str, float] = {  # start values of the page, with its rls.n for the AwAS
    "method": 2,
    "modality": RESIDUAL,
    "samplePeriod": 1e-3,
    "rls.n": 3,
    "rls.m": 3,
    "range.phi": 0.3,
    "range.setPoint": 100.0,
    "prior.tau_e": 45.0,
    "prior.nominal": 0.0,
    "prior.D_theta": 0.2,
    "prior.B": 0.0,
    "prior.tau_coulomb": 0.02,
    "noise.tau": 3.2e-3,
    "noise.tau_e": 3.2e-2,
    "encoder.theta": 40000.0,
    "encoder.q": 40000.0,
    "matched.bandwidth": 350.0,
    "matched.slow": 0.05,
    "matched.drift": 0.0,
    "motor.D_theta": 1e-3,
    "motor.B": 2.3e-5,
    "motor.gamma": 50.0,
}


@pytest.fixture(scope="module")
def c(build: Path) -> Library:
    return load(build)


def through(x: Array, order: int, w: float, T: float, held: bool = False) -> Array:
    """x filtered by s^order w^3 / (s + w)^3, from zero: x linear between samples, or held."""

    def response(u: Array, method: str) -> Array:
        system = [w**3] + [0.0] * order, np.poly([-w] * 3)
        b, a, _ = signal.cont2discrete(system, T, method=method)
        return np.asarray(signal.lfilter(b.ravel(), a, u, axis=0))

    if held:
        return response(x, "zoh")
    return response(x - x[0], "foh") + response(np.broadcast_to(x[0], x.shape), "zoh")


def resolution(counts: float) -> float:
    """Resolution of an encoder [rad]; 0 without quantisation."""
    return 2 * math.pi / counts if counts else 0.0


def direction(c: Library, theta: Array, count: float, slow: float) -> tuple[Array, Array]:
    """Mean sign over the sample that ends at each instant, and 0 if it is known, else 1 or more."""
    motion = c.new("sh_motion_sign")
    c.lib.sh_motion_sign_start(motion, theta[0])
    found = [(0.0, 0.0)]
    for x in theta[1:]:
        c.lib.sh_motion_sign_step(motion, x, count, slow)
        found.append((motion.sign, motion.unknown))
    sign, unknown = np.array(found).T
    return sign, unknown


def matched_filter(
    c: Library, p: Mapping[str, float], z: Array, eta_0: Array | None = None
) -> dict[str, Array]:
    """Outputs of all ticks. eta_0 [size: m n], powers of phi first, in scaled units [N.m]."""
    T, w, n, m = p["samplePeriod"], p["matched.bandwidth"], int(p["rls.n"]), int(p["rls.m"])
    theta, q, theta_c, tau, sensor = z.T
    size, measured = n * m, p["modality"] == SENSOR
    B, D, gamma = (p[f"motor.{name}"] for name in ("B", "D_theta", "gamma"))
    count, count_q = (resolution(p[f"encoder.{name}"]) for name in ("theta", "q"))

    # Basis in units of the ranges
    x = (q - theta) / p["range.phi"]
    r = (100 - 2.5 / (2 * math.pi) * theta_c) / p["range.setPoint"]
    e = [2 * i + 1 for i in range(n)]
    F = np.array([r**j * x**k / k for j in range(m) for k in e]).T
    dF = np.array([r**j * x ** (k - 1) / p["range.phi"] for j in range(m) for k in e]).T
    units = [[1 / k / p["range.phi"] ** k / p["range.setPoint"] ** j for j in range(m)] for k in e]

    # Regression. The motor is at rest at the first sample, at any torque
    moved = theta - theta[0]
    velocity, acceleration = through(moved, 1, w, T), through(moved, 2, w, T)
    viscous, inertial = gamma**2 * D * velocity, gamma**2 * B * acceleration
    sign, unknown = direction(c, theta, count, p["matched.slow"] * T)
    held = [np.append(s[1:], 0.0) for s in (sign, unknown)]  # sample k ends at instant k

    def beside_smooth(x: Array, held: bool = False) -> Array:
        return through(x, 0, w, T, held) + T**2 / 12 * through(x, 2, w, T, held)

    torque, friction = beside_smooth(tau), beside_smooth(held[0], held=True)
    unknown_f = through(held[1], 0, w, T, held=True)
    y = inertial + viscous - gamma * torque
    columns = np.column_stack([through(F, 0, w, T), -viscous, -inertial, -abs(gamma) * friction])
    if measured:
        y, columns[:, size:] = through(sensor, 0, w, T), 0.0

    # Prior
    motor = np.array([p["prior.D_theta"], p["prior.B"], p["prior.tau_coulomb"]])
    eta = np.zeros(size + 3, dtype=np.longdouble)
    if eta_0 is not None:
        eta[:size] = eta_0
    curve = eta.copy()
    variances = np.append(np.full(size, p["prior.tau_e"] ** 2), motor**2)
    P = np.diag(variances).astype(np.longdouble) + p["prior.nominal"] ** 2 * np.outer(curve, curve)
    P_0 = P.copy()
    b, C = size + 1, size + 2

    response = through(np.append([0.0, 1.0], np.zeros(20000)), 2, w, T)
    V = (gamma**2 * B) ** 2 * count**2 / 12 * np.sum(response**2)  # rounding in the column of b
    white = p["noise.tau_e"] ** 2 if measured else (gamma * p["noise.tau"]) ** 2
    sigma, surplus, taken, resting, unsure = 0.0, 0.0, 0.0, 0.0, 0.0
    phi = q - theta
    starting, settled = math.ceil(12 / (w * T)), 0
    out: dict[str, list[Any]] = {name: [] for name in NAMES}
    before = 0.0
    for k in range(len(z)):
        f = columns[k].astype(np.longdouble)
        # Variance of the sample
        rounding = sigma**2 * (count**2 + count_q**2) / 12
        resting = resting + 1 if abs(phi[k] - before) <= min(count, count_q) / 4 else 0.0
        unsure = unsure + 1 if unknown[k] > 0 else 0.0
        before = phi[k]
        R, stays = rounding + white, rounding * resting
        if not measured:
            creeping = gamma**2 * (eta[C] ** 2 + P[C, C]) * unknown_f[k] ** 2
            R += creeping * 16 / (3 * w * T)
            stays += creeping * unsure
        R *= (1 + stays / R) ** 2

        # Test whether the motor was at rest at the first sample
        epsilon, PF = y[k] - f @ eta, P @ f
        rho = f @ PF
        if k < starting and settled == 0 and not measured:
            expected = 3 / 16 * w * T * white + V + creeping + rho
            settled = k + starting if epsilon**2 > 25 * expected else 0
        if k < settled:
            epsilon = 0.0
        else:
            eta = eta + PF * epsilon / (R + rho)
            P = P - np.outer(PF, PF) / (R + rho)

            # Rounding in the inertia column
            if motor[1] > 0 and not measured:
                surplus += V / R * (k > 0 and theta[k] != theta[k - 1])
                back = min(surplus, 1 / P[b, b] - 1 / motor[1] ** 2)
                if back > 0:
                    gain = back / (1 - back * P[b, b])
                    P_b = P[:, b].copy()
                    eta = eta + gain * (1 + eta[b]) * P_b
                    P = P + gain * np.outer(P_b, P_b)
                    surplus, taken = surplus - back, taken + back

            # Drift
            if p["matched.drift"] > 0:
                G = np.append(f[:size], [0, 0, 0])
                v = np.append((P_0 @ G)[:size], [0, 0, 0])
                power = G @ v
                if power > 0:
                    P = P + p["matched.drift"] * T / (power + R) * np.outer(v, v)
                    s = np.sqrt(np.minimum(1, np.diag(P_0) / np.maximum(np.diag(P), 1e-300)))
                    P = P * np.outer(s, s)

        # Weight of the data about b after the bias compensation, and its effect on all parameters
        weighted, Q = eta, P
        if taken > 0:
            information = max(1 / P[b, b] - 1 / motor[1] ** 2, 0)
            weight = information**2 / (information + taken)
            variance = 1 / (1 / motor[1] ** 2 + weight)
            mean = eta[b] / P[b, b] * information / (information + taken) * variance
            along = P[:, b] / P[b, b]
            weighted = eta + along * (mean - eta[b])
            Q = P + np.outer(along, along) * (variance - P[b, b])
        h = np.append(dF[k], [0, 0, 0])
        sigma = float(h @ weighted)
        out["sigma"].append(sigma)
        out["sigma_std"].append(math.sqrt(h @ Q @ h))
        out["tau_e"].append(np.append(F[k], [0, 0, 0]) @ weighted)
        out["D"].append(D * (1 + weighted[size]))
        out["B"].append(B * (1 + weighted[b]))
        out["C"].append(weighted[C])
        out["y"].append(y[k])
        out["epsilon"].append(epsilon)
        out["eta"].append(weighted[:size].reshape(m, n).T * units)
    return {name: np.array(values, dtype=np.float64) for name, values in out.items()}


NAMES = {
    "sigma": "sigma",
    "sigma_std": "sigma_std",
    "tau_e": "tau_e",
    "D": "D_theta_hat",
    "B": "B_hat",
    "C": "tau_coulomb_hat",
    "y": "tau_e_residual",
    "epsilon": "epsilon",
    "eta": "eta",
}
TABLE1 = "table1"
CREEPS = Joint(duration=5.0, frequency=0.2, amplitude=0.5, tau_coulomb=0.02)
FAST = Joint(duration=3.0, frequency=8.0, amplitude=0.05, tau_coulomb=0.02)
ALL = {"prior.B": 0.1, "motor.D_theta": 1.1e-3, "motor.B": 2.5e-5}
EXACT = {"encoder.theta": 0.0, "encoder.q": 0.0}
OTHER = {"matched.bandwidth": 200.0, "matched.slow": 0.2, "range.phi": 0.1, "range.setPoint": 70.0}
CASES: Mapping[str, tuple[Joint | str, Mapping[str, float]]] = {
    "viscous friction": (TABLE1, {"motor.D_theta": 1.1e-3, "prior.tau_coulomb": 0.0}),
    "friction": (TABLE1, {"motor.D_theta": 1.1e-3}),
    "all": (TABLE1, ALL),
    "drift": (TABLE1, {**ALL, "matched.drift": 1e-2}),
    "sensor": (TABLE1, {"modality": SENSOR}),
    "creeping": (CREEPS, ALL),
    "fast": (FAST, ALL),
    "drift to the bound": (FAST, {**ALL, "matched.drift": 1e3}),
    "turned round": (FAST, {**ALL, "motor.gamma": -50.0}),
    "other parameters": (FAST, {**ALL, **OTHER, "noise.tau": 0.01}),
    "other encoder of the link": (FAST, {**ALL, "encoder.q": 10000.0}),
    "encoders that do not round": (replace(FAST, counts=0.0), {**ALL, **EXACT}),
    "large basis": (FAST, {**ALL, "rls.n": 6, "rls.m": 2}),
    "small basis": (FAST, {**ALL, "rls.n": 1, "rls.m": 1}),
}


def compare(found: NDArray[np.void], expected: Mapping[str, Array]) -> None:
    """Checks every output at every tick, to 1e-7 of its largest value."""
    for name, want in expected.items():
        got = found[NAMES[name]]
        if name == "eta":  # each coefficient relative to its own largest value
            n, m = want.shape[1:]
            assert not np.any(got[:, n:]) and not np.any(got[:, :, m:])
            got = got[:, :n, :m]
        largest = np.max(np.abs(want), axis=0)
        assert np.all(np.max(np.abs(got - want), axis=0) <= 1e-7 * largest), name


@pytest.mark.parametrize("case", CASES)
def test_every_tick(c: Library, case: str) -> None:
    joint, values = CASES[case]
    z = table1_recording().measurements()[:8000] if isinstance(joint, str) else joint.measurements()
    p = {**START, **values}
    z[:, 3] *= np.sign(p["motor.gamma"])
    compare(Estimator(c, p).run(z), matched_filter(c, p, z))


@pytest.mark.parametrize("modality", [RESIDUAL, SENSOR])
def test_every_tick_of_a_joint_that_already_moves(c: Library, modality: int) -> None:
    z = FAST.measurements()[5:500]  # 0.6 rad/s
    p = {**START, **ALL, "modality": modality}
    expected = matched_filter(c, p, z)
    assert np.all(expected["epsilon"][1:30] == 0) == (modality == RESIDUAL)
    compare(Estimator(c, p).run(z), expected)


def test_every_tick_with_a_nominal_curve(c: Library) -> None:
    z = table1_recording().measurements()[:3000]
    p = {**START, "prior.nominal": 0.3, "prior.tau_e": 1.0, "matched.drift": 1e-2}
    estimator = Estimator(c, p)
    estimator.parameters.rls.eta_0[0][2] = 0.037  # 2 k_s 1e-6, 30 % too high
    estimator.parameters.rls.eta_0[1][2] = -0.025
    c.lib.sh_estimator_start(estimator.state, estimator.parameters, estimator.estimate)
    eta_0 = np.zeros(9)
    eta_0[6] = 0.037 * 100**2 * 0.3
    eta_0[7] = -0.025 * 100**2 * 0.3**3 * 3
    compare(estimator.run(z), matched_filter(c, p, z, eta_0))
