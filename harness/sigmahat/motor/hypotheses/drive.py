"""Relates a torque to two positions whose units are not known, by the motor equation: which of both
is the motor, how much of the torque its motion explains, and the sign of the torque."""

from dataclasses import dataclass

import numpy as np

from sigmahat.motor.equation import CONSTANT, WIDEST, Equations, Form, equations, explained
from sigmahat.motor.hypotheses.slope import slope_of
from sigmahat.motor.noise import low_pass
from sigmahat.motor.quick_fit import LINEAR
from sigmahat.motor.signals import Signals
from sigmahat.recording.log import Array

_T = 0.01  # nominal time between samples [s]: the unit of the times may be wrong, too
_HIGHEST = WIDEST / _T  # low pass: all that the samples show [Hz]
_COULOMB = 0.05  # width of the sign change of the friction, relative to the largest velocity
_LEAST = 120  # samples
_PARTS = 8  # number of parts of a log for the significance of a sign


@dataclass(frozen=True)
class Drive:
    """Relation between a torque and the motion of two positions, by the motor equation (3)."""

    explained: float  # explained fraction of the variance of the torque [1]
    sign: int  # 1 if the torque drives the motion, -1 if its sign is reversed, 0: not sure


def drive(x: Array, y: Array, tau: Array) -> Drive:
    """Relates a torque to two positions, whatever their units are; all [size: samples].

    tau = B x'' + D x' + C sign(x') + K (x - y) + G x + c for a linear spring, with only the part of
    y that is not proportional to x. The equation contains the acceleration of the motor, not of the
    link. Therefore the equation explains the torque better if x is the motor position. The sign of
    the torque follows from friction, which dissipates power of the motor on average. If a hand
    moves the link, the deformation follows the velocity, and `sign` is 0.
    """
    if len(x) < _LEAST or not np.ptp(x) or not np.ptp(tau):
        return Drive(0.0, 0)
    slope = slope_of([np.column_stack([x, y])], _T)
    position = x - x.mean()
    phi = (y - y.mean()) / slope.value - position if slope else 0 * x
    piece = Signals(theta=x, phi=phi, set_point=0 * x, tau=tau, tau_e=None, extra=position[:, None])
    velocity = np.gradient(low_pass(x, _HIGHEST, _T), _T)
    v_s = _COULOMB * float(np.abs(velocity).max())
    form = Form(_HIGHEST, _HIGHEST, coulomb_velocity=v_s)
    system = equations([piece], _T, 1.0, form)
    of_deformation, of_torque = _powers(system)
    return Drive(explained(system), 0 if _sign(of_deformation) > 0 else _sign(of_torque))


def _powers(system: Equations) -> tuple[Array, Array]:
    """Computes the mean products of the velocity of the motor with the deformation, and with the
    torque without its mean, in parts of a log [size: parts]."""
    parts = system.in_parts(_PARTS)
    velocity, one, spring = map(parts.names.index, ("D_theta", CONSTANT, LINEAR))
    mean = parts.Zy[:, one].sum() / parts.rows.sum()
    of_torque = parts.Zy[:, velocity] - mean * parts.ZX[:, velocity, one]
    return parts.ZX[:, velocity, spring] / parts.rows, of_torque / parts.rows


def _sign(power: Array) -> int:
    """Returns the sign of the mean; 0 if the parts show no significant sign."""
    error = float(power.std(ddof=1)) / np.sqrt(len(power))
    return int(np.sign(power.mean())) if abs(power.mean()) > 3 * error else 0
