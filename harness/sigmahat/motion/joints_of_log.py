"""A motion in closed form, the joints that it has to suit, and their response."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import signal

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Multisine:
    """Position e(t) sum_i A_i sin(2 pi f_i t + p_i) of the motor at the gear output.

    The envelope e rises from 0 to 1 in the ramp, as s^4 (35 - 84 s + 70 s^2 - 20 s^3) with s from 0
    to 1, and falls at the end. Position, velocity, acceleration and jerk are 0 at both ends.
    """

    amplitudes: Sequence[float]  # [rad]
    frequencies: Sequence[float]  # [Hz]
    phases: Sequence[float]  # [rad]
    duration: float  # [s]
    ramp: float  # [s]

    def times(self, T: float) -> Array:
        return T * np.arange(round(self.duration / T) + 1, dtype=np.float64)

    def at(self, t: Array) -> tuple[Array, Array, Array]:
        """Position [rad], velocity [rad/s] and acceleration [rad/s2]."""
        w = 2 * np.pi * np.array(self.frequencies)[:, None]
        A, angle = np.array(self.amplitudes)[:, None], w * t + np.array(self.phases)[:, None]
        x, v = np.sum(A * np.sin(angle), axis=0), np.sum(A * w * np.cos(angle), axis=0)
        a = -np.sum(A * w**2 * np.sin(angle), axis=0)
        # The envelope e with its derivatives; the ramps do not overlap.
        rising = t < self.duration / 2
        s = np.clip(np.where(rising, t, self.duration - t) / self.ramp, 0.0, 1.0)
        slope = np.where(rising, 1.0, -1.0) / self.ramp
        u = s * (1 - s)
        e = s**4 * (35 - 84 * s + 70 * s**2 - 20 * s**3)
        de, dde = 140 * u**3 * slope, 420 * u**2 * (1 - 2 * s) * slope**2
        return e * x, de * x + e * v, dde * x + 2 * de * v + e * a

    def scaled(self, factor: float) -> Multisine:
        """The motion with amplitudes multiplied by a factor."""
        return replace(self, amplitudes=[factor * A for A in self.amplitudes])


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

    def respond(
        self, theta: Array, velocity: Array, acceleration: Array, T: float
    ) -> tuple[Array, Array]:
        """Deformation [rad] and torque of the motor [N.m] for a motion of the motor at k T.

        The link is linear, (2), but the torque of the weight is taken at the angle of the motor.
        Inputs are linear between the samples, so the response is exact.
        """
        load = self.M * acceleration + self.D_q * velocity
        load += self.weight * np.sin(self.angle + theta)
        numerator, denominator, start = _response(self.k, self.M, self.D_q, T)
        phi: Array = signal.lfilter(numerator, denominator, -load, zi=-load[0] * start)[0]
        friction = self.D_theta * velocity + self.tau_coulomb * np.tanh(velocity / _SLOW)
        return phi, self.B * acceleration + friction - self.k * phi


@lru_cache(maxsize=4096)
def _response(k: float, M: float, D_q: float, T: float) -> tuple[Array, Array, Array]:
    """Filter from -load to phi with M phi'' + (D_q + c) phi' + k phi = -load, and its steady state.

    A search computes it for hundreds of joints, each with many motions.
    """
    c = _DAMPING * 2 * np.sqrt(k * M)
    A = np.array([[0.0, 1.0], [-k / M, -(D_q + c) / M]])
    b, C = np.array([[0.0], [1.0 / M]]), np.array([[1.0, 0.0]])
    Ad, bd, Cd, dd, _ = signal.cont2discrete((A, b, C, np.zeros((1, 1))), T, "foh")
    numerator, denominator = signal.ss2tf(Ad, bd, Cd, dd)
    return numerator[0], denominator, signal.lfilter_zi(numerator[0], denominator)


_DAMPING = 0.02  # damping ratio of the spring
_SLOW = 1e-3  # [rad/s] below this velocity, the Coulomb friction is smaller


@dataclass(frozen=True)
class Ranges:
    """The set of joints: each quantity between two values, drawn from a log-uniform distribution.

    The angle is drawn evenly.
    """

    low: Joint
    high: Joint

    def draw(self, count: int, rng: np.random.Generator) -> Iterator[Joint]:
        for _ in range(count):
            yield Joint(**{f.name: self._drawn(f.name, rng) for f in fields(Joint)})

    def _drawn(self, name: str, rng: np.random.Generator) -> float:
        low, high = getattr(self.low, name), getattr(self.high, name)
        if name == "angle" or low <= 0:
            return float(rng.uniform(low, high))
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    def corners(self) -> Iterator[Joint]:
        """All joints with each quantity at one of its ends; the angle at up to four places."""
        ends = {
            f.name: {getattr(self.low, f.name), getattr(self.high, f.name)} for f in fields(Joint)
        }
        angles = np.linspace(self.low.angle, self.high.angle, 4, endpoint=False)
        ends["angle"] = set(angles.tolist())
        for values in itertools.product(*ends.values()):
            yield Joint(*values)


def of_limits(limits: Limits) -> Ranges:
    """Joints that are likely for a user who gives these limits, and nothing else."""
    k = limits.torque / limits.deformation
    speed_up = limits.torque / limits.velocity  # [N.m.s/rad] times the time to the full velocity
    low = Joint(k, 0.1 * speed_up, 0.0, 0.0, 0.0, 0.02 * speed_up, 0.0, 0.0)
    high = Joint(
        k=4 * k, M=0.4 * speed_up, D_q=0.02 * speed_up,
        weight=0.2 * limits.torque, angle=2 * np.pi,
        B=0.4 * speed_up, D_theta=0.2 * speed_up, tau_coulomb=0.1 * limits.torque,
    )  # fmt: skip
    return Ranges(low, high)
