"""Joints that a motion has to suit, from limits or from a log, and the motion of these joints."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, fields

import numpy as np
from scipy import signal

from sigmahat.motion.multisine import Array, Multisine

Rng = np.random.Generator


@dataclass(frozen=True)
class Limits:
    """Limits of the motion, at the gear output."""

    angle: float  # largest distance from the start position [rad]
    velocity: float  # [rad/s]
    torque: float  # torque of the motor [N.m]
    deformation: float  # [rad]


@dataclass(frozen=True)
class Joint:
    """A joint; all values at the gear output. `Ranges` has the least and the largest values."""

    k: float  # stiffness [N.m/rad]
    M: float  # inertia of the link [kg.m2]
    D_q: float  # viscous friction of the link [N.m.s/rad]
    weight: float  # largest torque of the weight of the link [N.m]
    angle: float  # angle of the link at the start, 0 where the weight hangs down [rad]
    B: float  # inertia of the motor [kg.m2]
    D_theta: float  # viscous friction of the motor [N.m.s/rad]
    tau_coulomb: float  # Coulomb friction of the motor [N.m]

    @property
    def resonance(self) -> float:
        """Resonance of link and spring with the motor held [Hz]."""
        return float(np.sqrt(self.k / self.M)) / (2 * np.pi)

    def move(self, motion: Multisine, T: float) -> tuple[Array, Array, Array]:
        """Motor [rad], deformation [rad] and torque of the motor [N.m] at k T.

        The link is linear, (2), but the torque of the weight is taken at the angle of the motor.
        Inputs are linear between the samples, so the response is exact.
        """
        theta, velocity, acceleration = motion.at(motion.times(T))
        load = self.M * acceleration + self.D_q * velocity
        load += self.weight * np.sin(self.angle + theta)
        # M phi'' + (D_q + c) phi' + k phi = -load
        c = _DAMPING * 2 * np.sqrt(self.k * self.M)
        A = np.array([[0.0, 1.0], [-self.k / self.M, -(self.D_q + c) / self.M]])
        b, C = np.array([[0.0], [1.0 / self.M]]), np.array([[1.0, 0.0]])
        Ad, bd, Cd, dd, _ = signal.cont2discrete((A, b, C, np.zeros((1, 1))), T, "foh")
        numerator, denominator = signal.ss2tf(Ad, bd, Cd, dd)
        start = signal.lfilter_zi(numerator[0], denominator) * -load[0]
        phi: Array = signal.lfilter(numerator[0], denominator, -load, zi=start)[0]
        friction = self.D_theta * velocity + self.tau_coulomb * np.tanh(velocity / _SLOW)
        return theta, phi, self.B * acceleration + friction - self.k * phi


_DAMPING = 0.02  # damping ratio of the spring
_SLOW = 1e-3  # [rad/s] below this velocity, the Coulomb friction is smaller


@dataclass(frozen=True)
class Ranges:
    """The set of joints: each quantity between two values, drawn evenly over its logarithm.

    The angle is drawn evenly.
    """

    low: Joint
    high: Joint

    def draw(self, count: int, rng: Rng) -> Iterator[Joint]:
        for _ in range(count):
            yield Joint(**{f.name: self._drawn(f.name, rng) for f in fields(Joint)})

    def _drawn(self, name: str, rng: Rng) -> float:
        low, high = getattr(self.low, name), getattr(self.high, name)
        if name == "angle" or low <= 0:
            return float(rng.uniform(low, high))
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    def corners(self) -> Iterator[Joint]:
        """All joints with each quantity at one of its ends; the angle at up to four places."""
        ends = {
            f.name: {getattr(self.low, f.name), getattr(self.high, f.name)} for f in fields(Joint)
        }
        ends["angle"] = set(
            np.linspace(self.low.angle, self.high.angle, 4, endpoint=False).tolist()
        )
        for values in itertools.product(*ends.values()):
            yield Joint(*values)


def of_limits(limits: Limits) -> Ranges:
    """Joints that are likely for a user who gives these limits, and nothing else."""
    k = limits.torque / limits.deformation
    speed_up = limits.torque / limits.velocity  # [N.m.s/rad] times the time to the full velocity
    low = Joint(k, 0.1 * speed_up, 0.0, 0.0, 0.0, 0.02 * speed_up, 0.0, 0.0)
    high = Joint(
        k=4 * k,
        M=0.4 * speed_up,
        D_q=0.02 * speed_up,
        weight=0.2 * limits.torque,
        angle=2 * np.pi,
        B=0.4 * speed_up,
        D_theta=0.2 * speed_up,
        tau_coulomb=0.1 * limits.torque,
    )
    return Ranges(low, high)
