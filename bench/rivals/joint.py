"""The parts of a joint. `draw.py` draws their values, `simulation.py` builds the joint."""

from __future__ import annotations

import math
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
        """What resists at rest without load [N.m]."""
        return self.K_c + self.K_cs

    def budget(self, v: float, tau_m: float, tau_e: float) -> float:
        """Largest torque [N.m] of dry friction at the velocity v behind the gear [rad/s]."""
        backdriven = abs(tau_e) >= abs(tau_m)
        slow = self.K_cs + abs(self.K_ms * tau_m - self.K_es * tau_e)
        slow += self.K_mq * tau_m * tau_m if backdriven else self.K_eq * tau_e * tau_e
        dry = self.K_c + abs(self.K_m * tau_m - self.K_e * tau_e)
        return dry + slow * math.exp(-(abs(v / self.v_s) ** self.alpha))


@dataclass(frozen=True)
class Motor:
    """A motor with its gear. All but the last is on the motor's axis."""

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
class Link:
    """A rod that turns about a horizontal or a vertical axis; it hangs down at q = 0."""

    mass: float  # [kg]
    length: float  # [m]

    @property
    def centre(self) -> float:
        """Distance from the axis to the centre of mass [m]."""
        return self.length / 2

    @property
    def inertia(self) -> float:
        """Inertia about the centre of mass [kg.m2]."""
        return self.mass * self.length**2 / 12


@dataclass(frozen=True)
class Drive:
    """Command of a motor: u = feed_forward + kp (reference - theta) - kd theta', within +-peak.

    theta is the encoder reading, theta' its difference through a low pass of the first order.
    """

    feed_forward: Array  # [N.m] at every sample
    reference: Array  # [rad] at every sample
    kp: float  # [N.m/rad]
    kd: float  # [N.m.s/rad]


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
    """Errors of the owner's data: factors to the true values."""

    B: float
    D: float
    coulomb: float  # the largest plausible one by the dry friction at rest
    phi: float  # the largest expected one by the largest one
    tau_e: float


@dataclass(frozen=True)
class Joint:
    """A motor, a spring and a link, with drive and instruments."""

    motor: Motor
    spring: Spring
    link: Link
    gravity: float  # 0 where the axis is vertical [m/s2]
    drive: Drive
    instruments: Instruments
    sheet: Sheet
