"""Instrumental variables: IDIM-IV.

A. Janot, P.-O. Vandanjon, M. Gautier, "A generic instrumental variable approach for industrial
robot identification", IEEE Trans. Control Systems Technology 22(1):132-145, 2014, section III: the
instruments are the columns of the regression for a motion that is simulated with the last
coefficients, and so without the noise of the measurements; estimation and simulation alternate
until neither the coefficients nor the residual change by more than 2.5 %. The authors simulate the
closed loop of robot and controller, so that the noise of the measured torque is no part of the
instruments. A log names no controller: here a proportional-derivative controller, as stiff as the
sample period allows, makes the motor follow the measured motion, while the spring pulls it to the
measured link position; both after the filter of the regression. The first coefficients are those
of least squares, and the data sheet takes part as there. The covariance is that of instrumental
variables, (Z'X)^-1 Z'Z (X'Z)^-1 times the variance of the residual.
"""

from __future__ import annotations

import math
import time

import numpy as np

from rivals.methods import least_squares
from rivals.records import Array, Estimate, JointLog, Known, none_found, with_interval
from rivals.regression import (
    COULOMB,
    INERTIA,
    OFFSET,
    SPRING,
    VISCOUS,
    Motion,
    Regression,
    columns,
    regression,
)
from rivals.spring import Spring

TOLERANCE = 0.025
ITERATIONS = 20
LOOP = 0.5
"""Bandwidth of the simulated loop times the sample period."""


def estimate(log: JointLog) -> Estimate:
    """The estimate of the whole log, the same at every sample but for the deformation."""
    begin = time.perf_counter()
    rows = regression(log)
    beta, covariance = least_squares.solve(rows.X, rows.y, log.known)
    error = float(np.linalg.norm(rows.y - rows.X @ beta))
    for _ in range(ITERATIONS):
        if beta[INERTIA] <= 0:
            return none_found(log, time.perf_counter() - begin, "the inertia became negative")
        motion = simulate(log, rows, beta)
        if motion is None:
            return none_found(log, time.perf_counter() - begin, "the simulation diverged")
        Z = rows.filters.decimated(columns(log, motion, rows.spring))
        last, last_error = beta, error
        beta, covariance = solve(Z, rows.X, rows.y, log.known)
        error = float(np.linalg.norm(rows.y - rows.X @ beta))
        change = np.abs(beta - last) <= np.maximum(
            TOLERANCE * np.abs(last), np.sqrt(np.diag(covariance))
        )
        if np.all(change) and abs(error - last_error) <= TOLERANCE * last_error:
            return with_interval(
                log, *rows.stiffness(log, beta, covariance), time.perf_counter() - begin
            )
    return none_found(log, time.perf_counter() - begin, f"not converged after {ITERATIONS} rounds")


def solve(Z: Array, X: Array, y: Array, known: Known) -> tuple[Array, Array]:
    """Coefficients and covariance from instruments Z. The rows' variance is of their residual."""
    scale = np.sqrt(np.mean(X**2, axis=0))
    Z, X = Z / scale, X / scale
    mean, information = least_squares.a_priori(known, scale)
    beta = np.linalg.lstsq(X, y)[0]
    for _ in range(2):  # the first time the residual is that of least squares
        residual = y - X @ beta
        variance = residual @ residual / (len(y) - len(beta))
        inverse = np.linalg.inv(Z.T @ X / variance + np.diag(information))
        beta = inverse @ (Z.T @ y / variance + information * mean)
    covariance = inverse @ (Z.T @ Z / variance + np.diag(information)) @ inverse.T
    return beta / scale, covariance / np.outer(scale, scale)


def simulate(log: JointLog, rows: Regression, beta: Array) -> Motion | None:
    """The motion of the motor with these coefficients; None if it does not stay finite.

    Each step is one of the semi-implicit Euler method; Coulomb friction stops the motor or takes
    its share of the momentum. Instruments need not be exact: they have to be free of noise.
    """
    T, g, shape = log.sample_period, log.known.gamma, rows.spring
    inertia, viscous = g**2 * beta[INERTIA], g**2 * beta[VISCOUS]
    friction = max(g * beta[COULOMB], 0.0) * T / inertia
    omega = LOOP / T
    kp, kd = g**2 * log.known.B * omega**2, 2 * g**2 * log.known.B * omega
    reference, velocities = rows.motion.theta, rows.motion.theta_dot
    drive = kp * reference + kd * velocities - beta[OFFSET]
    q = reference + rows.motion.phi
    curve = polynomial(log, shape, beta[SPRING:])
    limit = 100 * (np.ptp(log.theta) + np.ptp(log.q))
    theta, velocity = float(reference[0]), float(velocities[0])
    moved = np.empty((len(q), 2))
    for k, (force, link, coefficients) in enumerate(
        zip(drive.tolist(), q.tolist(), curve.tolist(), strict=True)
    ):
        moved[k] = theta, velocity
        phi = link - theta
        torque = math.fsum(c * phi ** (2 * i + 1) for i, c in enumerate(coefficients))
        torque += force - kp * theta - (kd + viscous) * velocity
        free = velocity + T * torque / inertia
        velocity = math.copysign(max(abs(free) - friction, 0.0), free)
        theta += T * velocity
        if not abs(theta - reference[0]) < limit:
            return None
    positions, velocities = moved.T
    return Motion(positions, velocities, np.gradient(velocities, T), q - positions)


def polynomial(log: JointLog, shape: Spring, coefficients: Array) -> Array:
    """Coefficients of phi, phi^3, ... in the torque at every sample [size: samples x n]."""
    powers = np.arange(1, 2 * shape.n, 2)
    of_theta_c = (log.theta_c[:, None] / shape.range_theta_c) ** np.arange(shape.m)
    curve = of_theta_c @ coefficients.reshape(shape.n, shape.m).T
    return np.asarray(curve / (powers * shape.range_phi**powers))
