"""Measurements of a motor with a spring, by inverse dynamics from given motions.

The positions of the motor and the deformation are prescribed. The motor torque is computed from
them with (3) and friction, so no differential equation has to be solved.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from reference_joints import SCREW, Array, flexibility_torque, round_to_counts, stiffness

T = 1e-3  # [s]
GAMMA, B, D_THETA = 50.0, 2.3e-5, 1e-3
STIFFNESS, RANGE = 140.0, 0.1  # of MisfitJoint
SETTINGS = {  # for MisfitJoint, with the true scale of the stiffness, prior.tau_e / range.phi
    **{"method": 2, "rls.n": 2, "rls.m": 1, "range.phi": RANGE, "prior.tau_e": STIFFNESS * RANGE},
    "prior.torque_gain": 0.0,
}
WITHOUT_MISFITS = {
    f"prior.{name}": 0.0
    for name in (
        *("bias", "damping", "load_friction", "eccentric", "delay", "reversal"),
        *("power", "gap", "hysteresis", "eccentric_motor"),
    )
}
"""Parameters of FilteredRegression without the columns for effects that the model does not have."""
PLAIN = {"prior.torque_gain": 0.0, **WITHOUT_MISFITS}


def stop_operator(changes: Array, width: float) -> Array:
    """Sum of the changes so far, which stays within +-width [size: changes]."""
    states = accumulate(changes, lambda x, change: min(max(x + change, -width), width), initial=0.0)
    return np.array(list(states)[1:])


def at_rest(z: Array) -> Array:
    """One second in which a joint is at rest at the last motor position, without load [size: 1000 x
    5].
    """
    rest = z[-1:].repeat(1000, 0)
    rest[:, 1] = rest[:, 0]
    rest[:, 3] = 10**-2.5 * np.random.default_rng(1).normal(size=1000)
    return rest


@dataclass(frozen=True)
class Joint:
    """A joint with the lever arm of the AwAS, and effects that the model does not have.

    The motor data are the defaults of the estimator.
    """

    duration: float = 10.0  # [s]
    frequency: float = 1.0  # of the motor [Hz]
    amplitude: float = 0.8  # of the motor [rad]
    deformation: float = 0.02  # amplitude of phi, at 1.3 times the frequency [rad]
    B: float = B
    D_theta: float = D_THETA
    gamma: float = GAMMA
    tau_coulomb: float = 0.0
    coulomb_velocity: float = 0.02  # velocity of nearly full Coulomb friction [rad/s]
    stiffness: Callable[[Array], Array] = np.ones_like  # over time [s], relative to the AwAS
    counts: float = 40000.0  # counts per turn of the encoders; 0: no rounding
    noise: float = 10**-2.5  # standard deviation of the motor torque [N.m]
    seed: int = 1

    bias: float = 0.0  # constant torque [N.m]
    load_friction: float = 0.0  # per flexibility torque [1]
    delay: float = 0.0  # delay of the recorded torque [s]
    eccentric: float = 0.0  # amplitude of the once-per-turn error of the link encoder [rad]
    damping: float = 0.0  # of the spring [N.m.s/rad]
    hysteresis: float = 0.0  # half the height of the loop [N.m]
    hysteresis_width: float = 0.02 * RANGE  # half the width of the loop [rad]
    gap: float = 0.0  # half the dead zone [rad]

    @property
    def t(self) -> Array:
        """Times [s]."""
        return T * np.arange(round(self.duration / T) + 1, dtype=np.float64)

    @property
    def motion(self) -> tuple[Array, Array, Array, Array, Array]:
        """theta, its two derivatives, phi [rad], lever arm [m]. The motion starts at rest."""
        t, w = self.t, 2 * np.pi * self.frequency
        theta = self.amplitude * (1 - np.cos(w * t))
        theta_dot = self.amplitude * w * np.sin(w * t)
        theta_ddot = self.amplitude * w**2 * np.cos(w * t)
        phi = self.deformation * (1 - np.cos(1.3 * w * t)) * np.sin(0.7 * w * t)
        return theta, theta_dot, theta_ddot, phi, 0.07 + 0.02 * np.sin(0.9 * t)

    def spring(self, phi: Array, r: Array) -> tuple[Array, Array]:
        """Torque (28) [N.m] and stiffness (29) [N.m/rad]."""
        change = self.stiffness(self.t)
        return change * flexibility_torque(r, phi), change * stiffness(r, phi)

    @property
    def tau_e(self) -> Array:
        """Flexibility torque [N.m]."""
        _, _, _, phi, r = self.motion
        tau_e, _ = self.spring(phi - np.clip(phi, -self.gap, self.gap), r)
        play = stop_operator(np.diff(phi, prepend=phi[0]), self.hysteresis_width)
        tau_e = tau_e + self.hysteresis * play / self.hysteresis_width
        return tau_e + self.damping * np.gradient(phi, T, edge_order=2)

    @property
    def sigma(self) -> Array:
        """Stiffness of the spring [N.m/rad]."""
        _, _, _, phi, r = self.motion
        return self.spring(phi, r)[1]

    def measurements(self) -> Array:
        """theta, q, theta_c, tau, tau_e_sensor [size: ticks x 5]."""
        theta, theta_dot, theta_ddot, phi, r = self.motion
        rng, tau_e = np.random.default_rng(self.seed), self.tau_e
        friction = self.tau_coulomb * np.sign(self.gamma)
        friction = friction + self.load_friction * np.abs(tau_e) / self.gamma
        tau = self.gamma * (self.B * theta_ddot + self.D_theta * theta_dot)
        tau += friction * np.tanh(theta_dot / self.coulomb_velocity)
        tau -= (tau_e + self.bias) / self.gamma
        tau = np.interp(self.t - self.delay, self.t, tau)
        tau += self.noise * rng.normal(size=len(tau))
        sensor = tau_e + 10 * self.noise * rng.normal(size=len(tau))
        q = theta + phi
        angles = q + self.eccentric * np.sin(q + 0.7), theta
        q, theta = (round_to_counts(x, self.counts) for x in angles)
        return np.column_stack([theta, q, (0.1 - r) / SCREW, tau, sensor])


@dataclass(frozen=True)
class MisfitJoint(Joint):
    """A joint with a linear spring, and no lever arm, that moves with several frequencies."""

    duration: float = 12.0
    tau_coulomb: float = 0.01
    coulomb_velocity: float = 5e-3

    def sum_of_sines(self, size: float, *frequencies: float) -> Array:
        """Signal of about this amplitude [rad] that starts at zero with zero velocity."""
        rng = np.random.default_rng(self.seed)
        waves = [np.sin(2 * np.pi * f * self.t + rng.uniform(0, 6)) for f in frequencies]
        start = 1 - np.exp(-((self.t / 0.3) ** 3))
        return np.asarray(size * start * np.sum(waves, axis=0))

    @property
    def motion(self) -> tuple[Array, Array, Array, Array, Array]:
        theta = self.sum_of_sines(0.5, 0.31, 0.83, 1.7)
        phi = self.sum_of_sines(0.02, 0.45, 1.13, 2.31)
        theta_dot = np.gradient(theta, T, edge_order=2)
        theta_ddot = np.gradient(theta_dot, T, edge_order=2)
        return theta, theta_dot, theta_ddot, phi, np.full(len(phi), 0.1)

    def spring(self, phi: Array, r: Array) -> tuple[Array, Array]:
        sigma = STIFFNESS * self.stiffness(self.t)
        return sigma * phi, sigma


def hardening(phi: Array, theta_c: Array | float) -> tuple[Array, Array]:
    """Torque [N.m] and stiffness [N.m/rad] of a spring that another motor makes stiffer."""
    share = 1 + 0.3 * theta_c
    return share * (STIFFNESS * phi + 3000 * phi**3), share * (STIFFNESS + 9000 * phi**2)


@dataclass(frozen=True)
class HardeningJoint(MisfitJoint):
    """A joint with this spring; theta_c is a sine of 1 rad."""

    @property
    def motion(self) -> tuple[Array, Array, Array, Array, Array]:
        theta, theta_dot, theta_ddot, phi, _ = super().motion
        r = 0.1 - SCREW * np.sin(2 * np.pi * 0.11 * self.t)
        return theta, theta_dot, theta_ddot, phi, r

    def spring(self, phi: Array, r: Array) -> tuple[Array, Array]:
        return hardening(phi, (0.1 - r) / SCREW)
