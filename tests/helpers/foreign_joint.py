"""Joints that are simulated by scipy alone: no code and no plant of the package is used.

A series elastic joint with gravity, and a joint whose lever sets the stiffness, as the AwAS has.
Both have a motor with viscous and Coulomb friction behind a gear, and a controller of its position.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]

T = 1e-3  # [s]
GEAR = 80.0
TORQUE_CONSTANT = 0.09  # [N.m/A]
INERTIA = 8e-5  # inertia of the motor, on its axis [kg.m2]
FRICTION = 8e-4  # viscous, on its axis [N.m.s/rad]
COULOMB = 0.015  # on its axis [N.m]
LINK = 0.35  # inertia of the link [kg.m2]
GRAVITY = 4.0  # torque of the link at 90 degrees [N.m]
STIFFNESS = 260.0  # stiffness of the series elastic joint [N.m/rad]
PER_LEVER = 5200.0  # stiffness of the other joint over lever squared [N/m]
_GAIN, _DAMPING = 900.0, 40.0  # gains of the controller [N.m/rad, N.m.s/rad]
_MOTION = ((0.45, 0.4), (0.16, 1.3), (0.05, 3.1))  # amplitude [rad], frequency [Hz] of its target


@dataclass(frozen=True)
class Motion:
    """The true signals; all [size: samples], T apart."""

    t: Array  # [s]
    theta: Array  # motor behind its gear [rad]
    q: Array  # link [rad]
    velocity: Array  # velocity of the motor after its gear [rad/s]
    target: Array  # set-point of the motor after its gear [rad]
    tau: Array  # torque of the motor, on its axis [N.m]
    lever: Array  # [m]; 0 without one
    tau_e: Array  # torque of the spring from q - theta [N.m]
    stiffness: Array  # [N.m/rad]


def _target(t: Array | float) -> tuple[Array | float, Array | float]:
    waves = [(a, 2 * np.pi * f) for a, f in _MOTION]
    rate = sum(a * w * np.cos(w * t) for a, w in waves)
    return sum(a * np.sin(w * t) for a, w in waves), rate


def _lever(t: Array | float) -> Array | float:
    return 0.2 + 0.025 * np.sin(2 * np.pi * 0.15 * t)


@cache
def joint(has_lever: bool, seconds: float = 7.0, stiffer: float = 0.0) -> Motion:
    """A motion from rest; stiffer: change of the series elastic joint per deformation [1/rad]."""

    def spring(phi: Array | float, t: Array | float) -> tuple[Array | float, Array | float]:
        if has_lever:
            K = PER_LEVER * _lever(t) ** 2
            return 0.5 * K * np.sin(2 * phi), K * np.cos(2 * phi)
        return STIFFNESS * phi * (1 + stiffer * phi / 2), STIFFNESS * (1 + stiffer * phi)

    def torque(t: Array | float, theta: Array | float, velocity: Array | float) -> Array | float:
        target, rate = _target(t)
        return (_GAIN * (target - theta) + _DAMPING * (rate - velocity)) / GEAR

    def change(t: float, x: Array) -> list[float]:
        theta, omega, q, v = x
        f = float(spring(q - theta, t)[0])
        drive = float(torque(t, theta, omega)) - FRICTION * GEAR * omega
        drive -= COULOMB * np.tanh(omega / 0.005)
        load = (-f - 0.3 * v - GRAVITY * np.sin(q)) / LINK
        return [omega, (drive + f / GEAR) / (INERTIA * GEAR), v, load]

    t = np.arange(0.0, seconds, T)
    span, accuracy = (0.0, seconds), {"rtol": 1e-8, "atol": 1e-10}
    x = solve_ivp(change, span, [0.0] * 4, method="LSODA", t_eval=t, **accuracy).y
    f, stiffness = spring(x[2] - x[0], t)
    return Motion(
        t=t,
        theta=x[0],
        q=x[2],
        velocity=x[1],
        target=np.asarray(_target(t)[0]),
        tau=np.asarray(torque(t, x[0], x[1])),
        lever=np.asarray(_lever(t)) if has_lever else np.zeros_like(t),
        tau_e=np.asarray(f),
        stiffness=np.asarray(stiffness),
    )
