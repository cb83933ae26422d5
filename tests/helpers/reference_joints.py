"""A joint with one motor and one with two, solved by scipy: what their plants are held to.

Written from (2) and (3), and sharing nothing with the plants that are generated to C. Parameters
go by the names of the FMUs, whose start values stand here a second time.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]
# d/dt of the state, of state and torques
Derivative = Callable[..., Array]
Parameters = Mapping[str, float]

COULOMB_VELOCITY = 0.02  # rad/s, where tanh replaces the step of the sign

_MOTOR = {"B": 2.3e-5, "D_theta": 1e-3, "gamma": 50.0, "tau_coulomb": 0.0}
PAIR: Parameters = {
    "link.M": 0.02,
    "link.D_q": 0.05,
    "link.mgl": 0.5,
    "link.tau_coulomb": 0.0,
    **{f"motor_{i}.{name}": value for i in (1, 2) for name, value in _MOTOR.items()},
    "spring_1.k": 0.0026,
    "spring_1.a": 8.9995,
    "spring_2.k": 0.0011,
    "spring_2.a": 8.9989,
}


def pair(changed: Parameters) -> Derivative:
    """Equations of an antagonistic pair, but for these parameters as it starts.

    State (q, theta_1, theta_2 and their velocities), torques (tau_1, tau_2, tau_ext).
    """
    p = {**PAIR, **changed}

    def derivative(state: Array, tau_1: float, tau_2: float, tau_ext: float) -> Array:
        q, theta_1, theta_2, q_dot, theta_dot_1, theta_dot_2 = state
        tau_e_1 = p["spring_1.k"] * math.sinh(p["spring_1.a"] * (q - theta_1))
        tau_e_2 = p["spring_2.k"] * math.sinh(p["spring_2.a"] * (q - theta_2))
        return np.array(
            [
                q_dot,
                theta_dot_1,
                theta_dot_2,
                _link(p, q, q_dot, tau_e_1 + tau_e_2, tau_ext),
                _motor(p, "motor_1", theta_dot_1, tau_1, tau_e_1),
                _motor(p, "motor_2", theta_dot_2, tau_2, tau_e_2),
            ]
        )

    return derivative


def solve(derivative: Derivative, h: float, torques: Array, initial: Array) -> Array:
    """States [size: steps + 1 x states] under torques linear between the rows given every h [s]."""
    states = [initial]
    for begin, end in pairwise(torques):
        slope = (end - begin) / h
        solution = solve_ivp(
            lambda t, x, begin=begin, slope=slope: derivative(x, *(begin + slope * t)),
            (0.0, h),
            states[-1],
            method="Radau",
            rtol=1e-10,
            atol=1e-14,
        )
        if not solution.success:
            raise RuntimeError(f"the reference could not be solved: {solution.message}")
        states.append(solution.y[:, -1])
    return np.array(states)


def _link(p: Parameters, q: float, q_dot: float, tau_e: float, tau_ext: float) -> float:
    """Acceleration, (2)."""
    friction = p["link.D_q"] * q_dot
    friction += p["link.tau_coulomb"] * math.tanh(q_dot / COULOMB_VELOCITY)
    return (tau_ext - friction - p["link.mgl"] * math.sin(q) - tau_e) / p["link.M"]


def _motor(p: Parameters, motor: str, theta_dot: float, tau: float, tau_e: float) -> float:
    """Acceleration after the gear, (3)."""
    B, D_theta, gamma, tau_coulomb = (p[f"{motor}.{name}"] for name in _MOTOR)
    coulomb = tau_coulomb * math.tanh(theta_dot / COULOMB_VELOCITY)
    return (tau - coulomb - D_theta * gamma * theta_dot + tau_e / gamma) / (B * gamma)
