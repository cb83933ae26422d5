"""The AwAS, (5) with (28)-(31), solved by scipy: the reference for the plant and the estimator.

It is written from the paper and shares nothing with the plant that is generated to C. Names are
those of the FMU's parameters.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]
Torque = Callable[[float], float]

SCREW = 0.0025 / (2 * math.pi)  # spring.b [m/rad]


@dataclass(frozen=True)
class Awas:
    """Parameters of the plant, section VI.A, in SI units."""

    link_M: float = 0.1
    link_D_q: float = 0.15
    link_mgl: float = 0.0
    link_tau_coulomb: float = 0.0
    motor_B: float = 2.3e-5
    motor_D_theta: float = 1e-3
    motor_gamma: float = 50.0
    motor_tau_coulomb: float = 0.0
    coulomb_velocity: float = 0.02  # rad/s, width of the tanh that replaces the sign
    motor_c_B: float = 1.29e-7
    motor_c_D: float = 0.0141
    motor_c_gamma: float = 23.0
    spring_k_s: float = 14220.0
    spring_r_0: float = 0.1
    spring_b: float = SCREW

    def lever_arm(self, theta_c: Array) -> Array:
        """r, (30) [m]."""
        return self.spring_r_0 - self.spring_b * theta_c

    def flexibility_torque(self, r: Array, phi: Array) -> Array:
        """tau_e, (28) [N.m]."""
        torque: Array = self.spring_k_s * r**2 * np.sin(2 * phi)
        return torque

    def stiffness(self, r: Array, phi: Array) -> Array:
        """sigma, (29) [N.m/rad]."""
        stiffness: Array = 2 * self.spring_k_s * r**2 * np.cos(2 * phi)
        return stiffness

    def derivative(self, state: Array, tau: float, tau_c: float, tau_ext: float) -> Array:
        """d/dt of (q, theta, theta_c and their velocities), (5) [size: 6]."""
        q, theta, theta_c, q_dot, theta_dot, theta_c_dot = state
        phi = q - theta
        r = self.spring_r_0 - self.spring_b * theta_c
        tau_e = self.spring_k_s * r**2 * math.sin(2 * phi)  # (28)
        psi_e = -2 * self.spring_k_s * self.spring_b * r * math.sin(phi) ** 2  # (31)
        friction = self.motor_D_theta * self.motor_gamma * theta_dot
        friction += self.motor_tau_coulomb * math.tanh(theta_dot / self.coulomb_velocity)
        link_friction = self.link_D_q * q_dot
        link_friction += self.link_tau_coulomb * math.tanh(q_dot / self.coulomb_velocity)
        return np.array(
            [
                q_dot,
                theta_dot,
                theta_c_dot,
                (tau_ext - link_friction - tau_e - self.link_mgl * math.sin(q)) / self.link_M,
                (tau - friction + tau_e / self.motor_gamma) / (self.motor_B * self.motor_gamma),
                (
                    tau_c
                    - self.motor_c_D * self.motor_c_gamma * theta_c_dot
                    - psi_e / self.motor_c_gamma
                )
                / (self.motor_c_B * self.motor_c_gamma),
            ]
        )


def solve(
    plant: Awas,
    tau: Torque,
    tau_c: Torque,
    initial: Array,
    duration: float,
    tau_ext: Torque = lambda t: 0.0,
    rtol: float = 1e-10,
) -> Callable[[Array], Array]:
    """Solution of (5) from `initial` [size: 6] over `duration` [s].

    Returns the state as a function of time: times [size: p] -> states [size: 6 x p], in the order
    q, theta, theta_c, q_dot, theta_dot, theta_c_dot.
    """
    solution = solve_ivp(
        lambda t, x: plant.derivative(x, tau(t), tau_c(t), tau_ext(t)),
        (0.0, duration),
        initial,
        method="Radau",
        dense_output=True,
        rtol=rtol,
        atol=1e-14,
    )
    if not solution.success:
        raise RuntimeError(f"the reference plant could not be solved: {solution.message}")
    dense: Callable[[Array], Array] = solution.sol
    return dense


def round_to_counts(angle: Array, counts: float) -> Array:
    """Reading of an encoder with `counts` per turn: the nearest count [rad]. 0: no quantisation."""
    if counts == 0:
        return angle
    count = 2 * math.pi / counts
    rounded: Array = np.round(angle / count) * count
    return rounded


@dataclass(frozen=True)
class Recording:
    """Measurements and true signals of a run, each [size: p], sampled at k T."""

    theta: Array  # measured
    q: Array
    theta_c: Array
    tau: Array
    tau_e_sensor: Array
    true_theta_dot: Array
    true_phi: Array
    true_tau_e: Array
    true_sigma: Array

    def measurements(self) -> Array:
        """[size: p x 5] in the order theta, q, theta_c, tau, tau_e_sensor."""
        return np.column_stack([self.theta, self.q, self.theta_c, self.tau, self.tau_e_sensor])


def record(
    plant: Awas, states: Callable[[Array], Array], tau: Torque, samples: int, T: float, seed: int
) -> Recording:
    """Samples a solution, with the encoders of the paper and the noise (32), (33)."""
    t: Array = T * np.arange(samples, dtype=float)
    q, theta, theta_c, _, theta_dot, _ = states(t)
    noise = np.random.default_rng(seed)
    phi = q - theta
    r = plant.lever_arm(theta_c)
    tau_e = plant.flexibility_torque(r, phi)
    return Recording(
        theta=round_to_counts(theta, 40000),
        q=round_to_counts(q, 40000),
        theta_c=round_to_counts(theta_c, 1024),
        tau=np.array([tau(time) for time in t]) + noise.normal(0.0, math.sqrt(1e-5), samples),
        tau_e_sensor=tau_e + noise.normal(0.0, math.sqrt(1e-3), samples),
        true_theta_dot=theta_dot,
        true_phi=phi,
        true_tau_e=tau_e,
        true_sigma=plant.stiffness(r, phi),
    )


def paper_tau(t: float) -> float:
    """Torque of the principal motor in section VI.B [N.m]."""
    return 0.3 * math.sin(0.2 * math.pi * t)


def paper_tau_c(t: float) -> float:
    """Torque of the secondary motor in section VI.B [N.m]."""
    return 8.0 * math.sin(0.2 * math.pi * t)


@cache
def table1() -> Callable[[Array], Array]:
    """Solution for the conditions of Table I: r(0) = 70 mm, at rest, 15 s."""
    initial = np.array([0.0, 0.0, 0.030 / SCREW, 0.0, 0.0, 0.0])
    return solve(Awas(), paper_tau, paper_tau_c, initial, 15.0)


@cache
def table1_recording() -> Recording:
    """Measurements of the run of Table I, 15001 samples at 1 kHz."""
    return record(Awas(), table1(), paper_tau, samples=15001, T=1e-3, seed=1)
