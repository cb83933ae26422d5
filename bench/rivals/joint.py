"""Data of a simulated joint. `draw.py` draws the values, `simulation.py` builds the joints."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from rivals.records import Array


@dataclass(frozen=True)
class Friction:
    """Dry friction of servo actuators, all torques on the motor's axis [N.m].

    The models M1 to M6 of M. Duclusaud, G. Passault, V. Padois, O. Ly, "Extended Friction Models
    for the Physics Simulation of Servo Actuators", Proc. IEEE ICRA 2025, 12091-12097, arXiv
    2410.08650. Written from the formulas; no code of theirs is used. With v the velocity behind the
    gear, tau_m the torque of the motor and tau_e what acts on it from outside, the friction is

        M1  K_v |v| + K_c
        M2  M1 + s K_cs                                       s = exp(-|v / v_s|^alpha)
        M3  M1 + K_l |tau_m - tau_e|
        M4  M1 + K_l |tau_m - tau_e| + s (K_cs + K_ls |tau_m - tau_e|)
        M5  M1 + |K_m tau_m - K_e tau_e| + s (K_cs + |K_ms tau_m - K_es tau_e|)
        M6  M5 + s Q ,   Q = K_eq tau_e^2 if |tau_m| > |tau_e|, else K_mq tau_m^2

    M6 contains the others: K_m = K_e = K_l and K_ms = K_es = K_ls give M4, and what a model does
    not have is zero. The part with K_v is the damping of a joint, which the engine has itself.
    """

    K_c: float  # [N.m]
    K_cs: float = 0.0  # [N.m]
    v_s: float = 1.0  # behind the gear [rad/s]
    alpha: float = 1.0
    K_m: float = 0.0
    K_e: float = 0.0
    K_ms: float = 0.0
    K_es: float = 0.0
    K_mq: float = 0.0  # [1/N.m]
    K_eq: float = 0.0  # [1/N.m]

    @property
    def at_rest(self) -> float:
        """Friction at rest without load [N.m]."""
        return self.K_c + self.K_cs

    def budget(self, v: float, tau_m: float, tau_e: float) -> float:
        """Computes the largest torque of dry friction [N.m] at the velocity v after the gear."""
        backdriven = abs(tau_e) >= abs(tau_m)
        slow = self.K_cs + abs(self.K_ms * tau_m - self.K_es * tau_e)
        slow += self.K_mq * tau_m * tau_m if backdriven else self.K_eq * tau_e * tau_e
        dry = self.K_c + abs(self.K_m * tau_m - self.K_e * tau_e)
        return dry + slow * math.exp(-(abs(v / self.v_s) ** self.alpha))


@dataclass(frozen=True)
class Motor:
    """A motor with its gear; the values refer to the motor axis."""

    gear: float
    B: float  # all inertia that moves with the motor [kg.m2]
    D: float  # viscous friction [N.m.s/rad]
    peak: float  # largest torque [N.m]
    friction: Friction
    stiction_time: float  # in which MuJoCo's dry friction stops a motor [s]

    @property
    def inertia(self) -> float:
        """Inertia of the motor at the gear output [kg.m2]."""
        return self.B * self.gear**2


@dataclass(frozen=True)
class DrawnSpring:
    """Torque on the motor: stiffness phi + k_3 phi^3 + damping phi'."""

    stiffness: float  # [N.m/rad]
    k_3: float  # [N.m/rad3]
    damping: float  # [N.m.s/rad]


@dataclass(frozen=True)
class Tendons:
    """Two tendons from a lever on the motor's flange to a slider on the link, mirror images.

    Each tendon begins on the flange at the radius `lever`, at the angle +-`spread` from the link.
    The tendon passes an eyelet on the link at the radius `eyelet`, and ends on the slider. If the
    slider moves out by x, both tendons get longer by x: tension and joint stiffness increase.
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
        """Computes the distance of lever and eyelet at the angle alpha between both [m]."""
        a, r = self.lever, self.eyelet
        return math.sqrt(a * a + r * r - 2 * a * r * math.cos(alpha))

    def joint_stiffness(self) -> float:
        """Stiffness of the joint at phi = 0 and x = 0 [N.m/rad]."""
        a, r, alpha = self.lever, self.eyelet, self.spread
        d = self.length(alpha)
        slope = a * r * math.sin(alpha) / d
        bend = (a * r * math.cos(alpha) - slope**2) / d
        return 2 * (self.stiffness * slope**2 + self.tension * bend)


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
class DriveCommand:
    """Command of a motor: u = feed_forward + kp (reference - theta) - kd theta', within +-peak.

    theta is the encoder position, theta' the difference of theta after a first-order low pass.
    """

    feed_forward: Array  # [N.m] at every sample
    reference: Array  # [rad] at every sample
    kp: float  # [N.m/rad]
    kd: float  # [N.m.s/rad]
    peak: float  # [N.m]


@dataclass(frozen=True)
class Instruments:
    """Properties of the current loop, of the encoders, and of the log."""

    commanded: bool  # the log has the command, otherwise a measurement of the torque
    delay: float  # from command to torque if it has the command, else from torque to log [s]
    lag: float  # time constant of the current loop [s]
    gain: float  # torque in the log by true torque
    noise: float  # standard deviation of the torque in the log [N.m]
    counts_theta: int  # behind the gear
    counts_q: int


@dataclass(frozen=True, kw_only=True)
class DrawnJoint:
    """Motors, links, drives and instruments of a joint; an arm has two motors and links.

    An arm has two links in a vertical plane, a motor and a spring in each joint, and a floor.
    """

    motors: tuple[Motor, ...]
    links: tuple[Link, ...]
    drives: tuple[DriveCommand, ...]
    instruments: tuple[Instruments, ...]
    sheet: Mapping[str, float]
    """Ratios of the data sheet values to the true values, by start value of the estimator."""
    gravity: float  # 0 where the axis is vertical [m/s2]
    springs: tuple[DrawnSpring, ...] = ()  # one a motor, or none beside tendons
    tendons: Tendons | None = None
    theta_c: Array | None = None  # where the stiffness motor shall be at every sample [rad]
    floor: float | None = None  # of an arm, height against the first axis [m]
    start: tuple[float, ...] = (0.0,)  # angles of the motors [rad]
    observed: int = 0  # the joint in the log; of an arm 0 is the shoulder, 1 the elbow
