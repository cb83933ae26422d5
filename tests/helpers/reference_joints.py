"""The AwAS solved by scipy, as a reference for the plants and the estimator.

The equations are (5) with (28)-(31), written from the paper. These equations share no code with the
plants that are generated to C.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]
# d/dt of the state, of state and torques
Derivative = Callable[..., Array]

SCREW, K_S = 0.0025 / (2 * math.pi), 14220.0  # of the AwAS [m/rad, N/m]


def lever_arm(theta_c: Array | float) -> Array:
    """r of the AwAS, (30) [m]."""
    return np.asarray(0.1 - SCREW * theta_c)


def flexibility_torque(r: Array, phi: Array) -> Array:
    """tau_e of the AwAS, (28) [N.m]."""
    return np.asarray(K_S * r**2 * np.sin(2 * phi))


def stiffness(r: Array, phi: Array) -> Array:
    """sigma of the AwAS, (29) [N.m/rad]."""
    return np.asarray(2 * K_S * r**2 * np.cos(2 * phi))


def awas(state: Array, tau: float, tau_c: float, tau_ext: float) -> Array:
    """Derivative of the state (q, theta, theta_c and their velocities) under three torques."""
    q, theta, theta_c, q_dot, theta_dot, theta_c_dot = state
    r = 0.1 - SCREW * theta_c
    tau_e = K_S * r**2 * math.sin(2 * (q - theta))
    psi_e = -2 * K_S * SCREW * r * math.sin(q - theta) ** 2  # (31)
    link = (tau_ext - 0.15 * q_dot - tau_e) / 0.1  # (2)
    motor = _motor(theta_dot, tau, tau_e, B=2.3e-5, D_theta=1e-3, gamma=50.0)
    lever = _motor(theta_c_dot, tau_c, -psi_e, B=1.29e-7, D_theta=0.0141, gamma=23.0)
    return np.array([q_dot, theta_dot, theta_c_dot, link, motor, lever])


def _motor(
    theta_dot: float, tau: float, tau_e: float, *, B: float, D_theta: float, gamma: float
) -> float:
    """Acceleration after the gear, (3)."""
    return (tau - D_theta * gamma * theta_dot + tau_e / gamma) / (B * gamma)


def solution(
    derivative: Derivative, torques: Callable[[float], Any], initial: Array, duration: float
) -> Callable[[Array | float], Array]:
    """States as a function of time, up to `duration` [s]: times [size: p] -> [size: states x p]."""
    solved = solve_ivp(
        lambda t, x: derivative(x, *torques(t)),
        (0.0, duration),
        initial,
        method="Radau",
        dense_output=True,
        rtol=1e-10,
        atol=1e-14,
    )
    if not solved.success:
        raise RuntimeError(f"the reference could not be solved: {solved.message}")
    states: Callable[[Array | float], Array] = solved.sol
    return states


def solve(derivative: Derivative, h: float, torques: Array, initial: Array) -> Array:
    """States [size: steps + 1 x states] under torques linear between the rows given every h [s]."""

    def between(begin: Array, end: Array, t: float) -> Array:
        return begin + (end - begin) * (t / h)

    states = [initial]
    for rows in pairwise(torques):
        states.append(solution(derivative, partial(between, *rows), states[-1], h)(h))
    return np.array(states)


def round_to_counts(angle: Array, counts: float) -> Array:
    """Reading of an encoder with `counts` per turn: the nearest count [rad]. 0: no quantisation."""
    count = 2 * math.pi / counts if counts else 0.0
    return np.round(angle / count) * count if count else angle


@dataclass(frozen=True)
class Recording:
    """Measurements and true signals of a run, sampled at k T."""

    measured: Array  # theta, q, theta_c, tau, tau_e_sensor [size: p x 5]
    true_tau_e: Array  # [size: p]
    true_sigma: Array

    def measurements(self) -> Array:
        """A copy to change."""
        return np.array(self.measured)


def paper_tau(t: Array | float) -> Array:
    """Torque of the principal motor in section VI.B [N.m]."""
    return np.asarray(0.3 * np.sin(0.2 * math.pi * t))


def paper_tau_c(t: Array | float) -> Array:
    """Torque of the secondary motor in section VI.B [N.m]."""
    return np.asarray(8.0 * np.sin(0.2 * math.pi * t))


@cache
def table1_recording() -> Recording:
    """Measurements of the run of Table I, 15001 samples at 1 kHz: r(0) = 70 mm, at rest.

    Signals with the encoders of the paper and the noise (32), (33).
    """
    at_rest = np.array([0.0, 0.0, 0.030 / SCREW, 0.0, 0.0, 0.0])
    states = solution(awas, lambda t: (paper_tau(t), paper_tau_c(t), 0.0), at_rest, 15.0)
    t = 1e-3 * np.arange(15001, dtype=np.float64)
    q, theta, theta_c, *_ = states(t)
    noise = np.random.default_rng(1)
    r = lever_arm(theta_c)
    tau_e = flexibility_torque(r, q - theta)
    measured = [
        round_to_counts(theta, 40000),
        round_to_counts(q, 40000),
        round_to_counts(theta_c, 1024),
        paper_tau(t) + noise.normal(0.0, math.sqrt(1e-5), len(t)),
        tau_e + noise.normal(0.0, math.sqrt(1e-3), len(t)),
    ]
    return Recording(np.column_stack(measured), tau_e, stiffness(r, q - theta))
