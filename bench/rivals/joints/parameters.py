"""What a joint is made of. `draw.py` draws the values, the engines build what they say."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rivals.joints.excitation import Drive
from rivals.joints.friction import Friction
from rivals.records import Array

FLANGE = 0.002
"""Share of a motor's inertia that is a body behind its gear, the rest is armature. An engine needs
a body there; its acceleration is that of the flange in space, and it has no weight."""


@dataclass(frozen=True)
class Motor:
    """A motor with its gear. All but the last two is on the motor's axis."""

    gear: float
    B: float  # all inertia that moves with the motor [kg.m2]
    D: float  # viscous friction [N.m.s/rad]
    peak: float  # largest torque [N.m]
    friction: Friction
    stiction_time: float  # in which MuJoCo's dry friction stops a motor [s]

    @property
    def inertia(self) -> float:
        """Behind the gear [kg.m2]."""
        return self.B * self.gear**2


@dataclass(frozen=True)
class Spring:
    """Torque on the motor: stiffness phi + k_3 phi^3 + damping phi'."""

    stiffness: float  # [N.m/rad]
    k_3: float  # [N.m/rad3]
    damping: float  # [N.m.s/rad]


@dataclass(frozen=True)
class Tendons:
    """Two tendons from a lever on the motor's flange to a slider on the link, mirror images.

    Each begins on the flange at the radius `lever`, at the angle +-`spread` from the link, passes
    an eyelet on the link at the radius `eyelet`, and ends on the slider. When the slider moves out
    by x, both get longer by x: the tension rises, and with it the stiffness of the joint.
    """

    lever: float  # [m]
    eyelet: float  # [m]
    spread: float  # [rad]
    stiffness: float  # of one tendon [N/m]
    tension: float  # of one tendon at phi = 0, x = 0 [N]
    travel: float  # x when the stiffness motor has turned by one radian [m/rad]
    range_theta_c: float  # the stiffness motor turns from 0 to this [rad]
    damping: float  # of the joint [N.m.s/rad]

    def length(self, alpha: float) -> float:
        """From lever to eyelet when the angle between them is alpha [m]."""
        a, r = self.lever, self.eyelet
        return math.sqrt(a * a + r * r - 2 * a * r * math.cos(alpha))

    def joint_stiffness(self, theta_c: float) -> float:
        """Slope of the torque at phi = 0 [N.m/rad]."""
        a, r, alpha = self.lever, self.eyelet, self.spread
        d = self.length(alpha)
        slope = a * r * math.sin(alpha) / d
        bend = (a * r * math.cos(alpha) - slope**2) / d
        tension = self.tension + self.stiffness * self.travel * theta_c
        return 2 * (self.stiffness * slope**2 + tension * bend)


@dataclass(frozen=True)
class Link:
    """A link that turns about a horizontal axis; it hangs down at q = 0."""

    mass: float  # [kg]
    length: float  # to the next joint or to the tip [m]
    centre: float  # from the axis to the centre of mass [m]
    inertia: float  # about the centre of mass [kg.m2]

    @property
    def about_axis(self) -> float:
        """Inertia about the axis of the joint [kg.m2]."""
        return self.inertia + self.mass * self.centre**2


@dataclass(frozen=True)
class Instruments:
    """Current loop, encoders and log."""

    commanded: bool  # the log has the command, otherwise a measurement of the torque
    delay: float  # from command to torque if it has the command, else from torque to log [s]
    lag: float  # time constant of the current loop [s]
    gain: float  # torque in the log by true torque
    noise: float  # standard deviation of the torque in the log [N.m]
    counts_theta: int  # behind the gear
    counts_q: int


@dataclass(frozen=True)
class Sheet:
    """How wrong the owner's data are: factors to the true values."""

    B: float
    D: float
    coulomb: float  # the largest plausible one by the dry friction at rest
    phi: float  # the largest expected one by the largest one
    tau_e: float


@dataclass(frozen=True, kw_only=True)
class Joint:
    """Motors, links, drives and instruments: one of each but for an arm, which has two."""

    motors: tuple[Motor, ...]
    links: tuple[Link, ...]
    gravity: float  # 0 where the axis is vertical [m/s2]
    drives: tuple[Drive, ...]
    instruments: tuple[Instruments, ...]
    sheet: Sheet
    observed: int = 0  # the joint in the log; of an arm 0 is the shoulder, 1 the elbow


@dataclass(frozen=True, kw_only=True)
class SeriesElastic(Joint):
    """A spring between motor and link."""

    springs: tuple[Spring, ...]


@dataclass(frozen=True, kw_only=True)
class VariableStiffness(Joint):
    """Two tendons between motor and link, and a second motor that moves the slider."""

    tendons: Tendons
    theta_c: Array  # where the stiffness motor shall be at every sample [rad]


@dataclass(frozen=True, kw_only=True)
class Arm(SeriesElastic):
    """Two links in a vertical plane, a motor and a spring in each joint, and a floor."""

    tip: float  # radius of the sphere at the end [m]
    floor: float  # height against the first axis [m]
    start: tuple[float, ...]  # angles of the motors [rad]
