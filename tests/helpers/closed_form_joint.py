"""Logs of joints whose motion is prescribed, so that the motor torque follows in closed form."""

import numpy as np
from numpy.typing import NDArray

from reference_joints import round_to_counts
from regression_joint import D_THETA, GAMMA, B, T

Array = NDArray[np.float64]

COUNTS = 1 << 18
LINEAR, CUBIC, OF_THETA_C = 140.0, 3000.0, 0.3
"""Stiffness [N.m/rad], coefficient of the cube of the deformation [N.m/rad3], and share by which
the position of the stiffness motor [rad] changes the stiffness."""


def _cosines(t: Array, *terms: tuple[float, float]) -> tuple[Array, Array, Array]:
    """A signal that begins at 0 and at rest, and two derivatives; terms: amplitude, frequency."""
    signal, first, second = np.zeros(len(t)), np.zeros(len(t)), np.zeros(len(t))
    for amplitude, f in terms:
        w = 2 * np.pi * f
        signal += amplitude * (1 - np.cos(w * t))
        first += amplitude * w * np.sin(w * t)
        second += amplitude * w**2 * np.cos(w * t)
    return signal, first, second


def closed_form_log(kind: str, tau_coulomb: float = 0.01, seed: int = 1) -> dict[str, Array]:
    """12 s of a joint with Coulomb friction: t, theta, q, theta_c, tau and the true stiffness.

    The stiffness is constant but for the kind variable_stiffness. The seed is that of the noise.
    """
    t = T * np.arange(12 / T)
    theta, theta_dot, theta_ddot = _cosines(t, (0.3, 0.31), (-0.15, 0.83), (0.06, 2.3))
    phi, _, _ = _cosines(t, (0.03, 0.45), (-0.03, 1.13), (0.015, 2.9))
    variable = kind == "variable_stiffness"
    theta_c = np.sin(2 * np.pi * 0.11 * t) if variable else np.zeros(len(t))
    share = 1 + OF_THETA_C * theta_c
    cubic = CUBIC if variable else 0.0
    tau_e = share * (LINEAR * phi + cubic * phi**3)
    stiffness = share * (LINEAR + 3 * cubic * phi**2)
    tau = GAMMA * (B * theta_ddot + D_THETA * theta_dot) + tau_coulomb * np.sign(theta_dot)
    tau = tau - tau_e / GAMMA + 1e-3 * np.random.default_rng(seed).normal(size=len(t))
    read, q = (round_to_counts(angle, COUNTS) for angle in (theta, theta + phi))
    return {
        **{"t": t, "theta": read, "q": q, "theta_c": theta_c, "tau": tau},
        "stiffness": stiffness,
    }
