"""The estimator in numpy, written from the paper, with which the C code is compared.

The formulas are as printed in the paper, even if the C code has another form: (8) with its integral
I_tau and r(k), (14) and (25) with K and P - a K F'P. In double precision, the formulas of the paper
would lose all digits of P. So all numbers have multiple precision (mpfr in arrays of dtype object),
with many more DIGITS than cancel in the worst case. Inputs are doubles, which are taken as exact.

Parameters are a flat mapping from the names of the FMU to values.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import gmpy2
import numpy as np
from numpy.typing import NDArray

Exact = NDArray[np.object_]  # of gmpy2.mpfr
Array = NDArray[np.float64]
Numbers = TypeVar("Numbers", NDArray[np.object_], NDArray[np.longdouble])
Value = float | int
Parameters = Mapping[str, Value]

DIGITS = 60
gmpy2.get_context().precision = math.ceil(DIGITS / math.log10(2))  # bits

MODIFIED_KALMAN, KALMAN, FINITE_DIFFERENCE = 1, 2, 3
NORMALIZED, AS_PRINTED = 1, 2
RAW, FILTERED = 1, 2
ENHANCED, STANDARD, CONSTANT_FACTOR = 1, 2, 3
RESIDUAL, SENSOR, MODEL = 1, 2, 3

# Start values of the FMU, from sections VI.A and VI.B.
DEFAULTS: Parameters = {
    **{"samplePeriod": 1e-3, "modality": RESIDUAL, "deformation": RAW, "residual.K_I": 300.0},
    **{"motor.B": 2.3e-5, "motor.D_theta": 1e-3, "motor.gamma": 50.0},
    **{"filter.kind": MODIFIED_KALMAN, "filter.weighting": NORMALIZED, "filter.V_a": 3e9},
    **{"filter.V_max": 10.0, "filter.V_min": 0.1, "filter.alpha": 6.0, "filter.R": 10.0},
    **{"filter.P_0": 1.0, "encoder.theta": 40000.0, "encoder.q": 40000.0},
    **{"encoder.theta_c": 1024.0, "setPoint.offset": 100.0},
    **{"setPoint.scale": -0.0025 / (2 * math.pi) * 1000, "rls.kind": ENHANCED},
    **{"rls.symmetric": 1, "rls.n": 6, "rls.m": 3, "rls.P_0": 1e20, "rls.c": 1e-20, "rls.a": 0.1},
    **{"noise.tau": 3.2e-3, "noise.tau_e": 3.2e-2},
    **{"model.k_s": 14220.0, "model.r_0": 0.1, "model.b": 0.0025 / (2 * math.pi)},
}


def exact(values: Array | list[float] | float) -> Exact:
    """Doubles as multiple-precision numbers, of the same shape."""
    doubles = np.asarray(values, dtype=float)
    numbers = np.array([gmpy2.mpfr(float(x)) for x in doubles.flat], dtype=object)
    return numbers.reshape(doubles.shape)


def rounded(numbers: Exact) -> Array:
    """The nearest doubles."""
    return numbers.astype(float)


def measurement_variance(p: Parameters, x_dot: float, w_s: float) -> float:
    """R at a velocity, (11) [rad2]."""
    if w_s == 0:
        return p["filter.V_min"]
    velocity = abs(x_dot) / w_s if p["filter.weighting"] == NORMALIZED else abs(x_dot) * w_s
    spread = gmpy2.mpfr(p["filter.V_max"]) - p["filter.V_min"]
    variance: float = (
        spread / (1 + gmpy2.exp((velocity - 1) * p["filter.alpha"])) + p["filter.V_min"]
    )
    return variance


def velocity_filter(p: Parameters, measured: Array, counts: float) -> tuple[Exact, Exact]:
    """Position and velocity of one axis, (9)-(11) [size: ticks, ticks]."""
    z = exact(measured)
    T = gmpy2.mpfr(p["samplePeriod"])
    if p["filter.kind"] == FINITE_DIFFERENCE:
        return z, np.concatenate([[gmpy2.mpfr(0)], np.diff(z) / T])

    w_s = 2 * gmpy2.const_pi() / counts / T if counts else 0.0
    A = np.array([[1, T], [0, 1]], dtype=object)
    C = np.array([1, 0], dtype=object)
    Gamma = np.array([T * T / 2, T], dtype=object)
    Q = p["filter.V_a"] * np.outer(Gamma, Gamma)
    xi = np.array([z[0], gmpy2.mpfr(0)], dtype=object)
    P = gmpy2.mpfr(p["filter.P_0"]) * np.eye(2, dtype=int)
    states = [xi]
    for z_k in z[1:]:
        xi = A @ xi
        P = A @ P @ A.T + Q
        R = p["filter.R"] if p["filter.kind"] == KALMAN else measurement_variance(p, xi[1], w_s)
        K = P @ C / (C @ P @ C + R)
        xi = xi + K * (z_k - C @ xi)
        P = P - np.outer(K, C @ P)
        states.append(xi)
    x, x_dot = np.array(states).T
    return x, x_dot


def residual_torque(p: Parameters, theta: Exact, theta_dot: Exact, tau: Array) -> Exact:
    """gamma r_e, (8) [N.m, size: ticks]."""
    T, K_I = gmpy2.mpfr(p["samplePeriod"]), gmpy2.mpfr(p["residual.K_I"])
    B, D, gamma = (gmpy2.mpfr(p["motor." + name]) for name in ("B", "D_theta", "gamma"))
    torque = exact(tau)
    r_e = [gmpy2.mpfr(0)]
    I_tau = gmpy2.mpfr(0)
    r = K_I * (B * gamma * theta_dot[0] + D * gamma * theta[0] - I_tau)
    for k in range(1, len(torque)):
        I_tau = I_tau + (torque[k] + torque[k - 1]) / 2 * T
        before, r = r, K_I * (B * gamma * theta_dot[k] + D * gamma * theta[k] - I_tau)
        r_e.append((2 - T * K_I) / (2 + T * K_I) * r_e[-1] + 2 * (r - before) / (2 + T * K_I))
    estimate: Exact = gamma * np.array(r_e)
    return estimate


def basis(n: int, m: int, set_point: Exact, phi: Exact, symmetric: int = 1) -> tuple[Exact, Exact]:
    """F of (22) and dF/dphi of (23), row by row [size: ticks x n m, ticks x n m].

    symmetric  1: the odd powers of (18); 0: the powers 0 to n - 1 in their place
    """
    powers = [2 * i + 1 if symmetric else i for i in range(n)]
    F = [set_point**j * phi**e for j in range(m) for e in powers]
    dF = [set_point**j * (e * phi ** (e - 1) if e else 0 * phi) for j in range(m) for e in powers]
    return np.array(F).T, np.array(dF).T


@dataclass(frozen=True)
class Regression:
    """Results of the recursion at every tick, for each column of y, see `least_squares`."""

    eta: Exact  # [size: ticks x parameters x columns] after the update
    epsilon: Exact  # [size: ticks x columns] before the update, as rho
    rho: Exact  # [size: ticks]
    a: Exact  # [size: ticks]
    variances: Exact  # [size: ticks x 2] after the update: F P F' and dF P dF'
    P: Exact  # [size: parameters x parameters] after the last tick


def least_squares(
    kind: int, factor: float, P_0: float, eta_0: Array, F: Exact, y: Exact, dF: Exact | None = None
) -> Regression:
    """The recursion (14) with (25), and (27) for the enhanced kind.

    kind    ENHANCED with factor = c, STANDARD, or CONSTANT_FACTOR with factor = a
    eta_0   [size: parameters]
    F       [size: ticks x parameters]
    y       [size: ticks x columns], independent right-hand sides that share one P
    dF      [size: ticks x parameters], along which the variance is asked for, too
    """
    c = gmpy2.mpfr(factor)
    P = gmpy2.mpfr(P_0) * np.eye(F.shape[1], dtype=int)
    eta = np.repeat(exact(eta_0)[:, None], y.shape[1], axis=1)
    ticks = []
    for F_k, dF_k, y_k in zip(F, F if dF is None else dF, y, strict=True):
        epsilon = y_k - F_k @ eta
        PF = P @ F_k
        rho = F_k @ PF
        K = PF / (1 + rho)
        a = {ENHANCED: (c + c * rho) / (1 + c * rho), STANDARD: gmpy2.mpfr(1)}.get(kind, c)
        eta = eta + a * np.outer(K, epsilon)
        P = P - a * np.outer(K, PF)
        ticks.append((eta, epsilon, rho, a, (rho - a * rho**2 / (1 + rho), dF_k @ P @ dF_k)))
    etas, epsilons, rhos, factors, variances = map(np.array, zip(*ticks, strict=True))
    return Regression(etas, epsilons, rhos, factors, variances, P)


def solve(matrix: Numbers, right: Numbers) -> Numbers:
    """Solution of a symmetric positive definite system, by elimination."""
    A: Numbers = matrix.copy()
    b: Numbers = right.copy()
    size = len(A)
    for j in range(size):
        factors = A[j + 1 :, j] / A[j, j]
        A[j + 1 :] -= np.outer(factors, A[j])
        b[j + 1 :] -= np.outer(factors, b[j])
    for j in reversed(range(size)):
        b[j] = (b[j] - A[j, j + 1 :] @ b[j + 1 :]) / A[j, j]
    return b


def relative_error(got: Array, want: Array, scale: float | Array | None = None) -> float:
    """Largest relative error over the ticks. Where a value is below 1e-6 of the range of its
    signal, the error is relative to 1e-6 of the range.

    got, want  [size: ticks x ...], where each trailing entry is a signal with its own range
    scale      used instead of the range, if given
    """
    span = np.ptp(want, axis=0) if scale is None else np.asarray(scale)
    floor = np.maximum(np.abs(want), 1e-6 * span)
    error = np.abs(got - want)
    return float(np.max(error / np.where(floor > 0, floor, np.finfo(float).tiny)))


Estimate = Mapping[str, Array]
"""Outputs of every tick by name [size: ticks], and eta [size: ticks x n x m]."""


def estimator(
    p: Parameters, measurements: Array, variants: Sequence[Parameters], eta_0: Array | None = None
) -> list[Estimate]:
    """The whole estimator. Returns one Estimate for each of `variants`.

    p             parameters
    measurements  [size: ticks x 5] theta, q, theta_c, tau, tau_e_sensor
    variants      changes of p. They may differ in modality and in filter, but not in parameters on
                  which P depends, because they share one recursion of P
    eta_0         [size: n x m], zero if None
    """
    theta, q, theta_c, tau, sensor = measurements.T
    n, m = int(p["rls.n"]), int(p["rls.m"])
    set_point = p["setPoint.offset"] + p["setPoint.scale"] * exact(theta_c)
    phi = exact(q) - exact(theta)
    signals: list[tuple[Exact, Exact, Exact]] = []  # velocity, residual, torque
    noise: list[float] = []  # standard deviation of the torque [N.m]
    filters: dict[tuple[Value, ...], tuple[Exact, Exact, Exact]] = {}
    for variant in variants:
        v = {**p, **variant}
        key = tuple(v[name] for name in v if name.startswith(("filter.", "motor.", "residual.")))
        if key not in filters:
            x, x_dot = velocity_filter(v, theta, v["encoder.theta"])
            filters[key] = x, x_dot, residual_torque(v, x, x_dot, tau)
        x, x_dot, residual = filters[key]
        if v["modality"] == RESIDUAL:
            torque = residual
        elif v["modality"] == SENSOR:
            torque = exact(sensor)
        else:
            r = v["model.r_0"] - v["model.b"] * exact(theta_c)  # (30)
            sine = np.array([gmpy2.sin(2 * angle) for angle in exact(q) - exact(theta)])
            torque = v["model.k_s"] * r**2 * sine  # (28)
        if v["deformation"] == FILTERED:
            phi = velocity_filter(v, q, v["encoder.q"])[0] - x
        signals.append((x_dot, residual, torque))
        of_motor = abs(v["motor.gamma"]) * v["noise.tau"]
        noise.append(of_motor if v["modality"] == RESIDUAL else v["noise.tau_e"])

    F, dF = basis(n, m, set_point, phi, int(p["rls.symmetric"]))
    factor = p["rls.a"] if p["rls.kind"] == CONSTANT_FACTOR else p["rls.c"]
    flat = np.zeros(n * m) if eta_0 is None else eta_0.T.ravel()
    torques = np.array([torque for _, _, torque in signals]).T
    regression = least_squares(int(p["rls.kind"]), factor, p["rls.P_0"], flat, F, torques, dF)
    unit = factor if p["rls.kind"] == ENHANCED else 1.0  # variance over P, for a noise of 1 N.m
    of_tau_e, of_sigma = np.sqrt(unit * rounded(regression.variances)).T
    return [
        {
            "sigma_std": noise[i] * of_sigma,
            "tau_e_std": noise[i] * of_tau_e,
            "sigma": rounded((dF * regression.eta[:, :, i]).sum(axis=1)),
            "tau_e": rounded((F * regression.eta[:, :, i]).sum(axis=1)),
            "tau_e_residual": rounded(residual),
            "theta_dot": rounded(velocity),
            "phi": rounded(phi),
            "setPoint": rounded(set_point),
            "a": rounded(regression.a),
            "rho": rounded(regression.rho),
            "epsilon": rounded(regression.epsilon[:, i]),
            "eta": rounded(regression.eta[:, :, i]).reshape(-1, m, n).transpose(0, 2, 1),
        }
        for i, (velocity, residual, _) in enumerate(signals)
    ]
