"""Friction of servo actuators: the models M1 to M6 of Duclusaud et al.

M. Duclusaud, G. Passault, V. Padois, O. Ly, "Extended Friction Models for the Physics Simulation of
Servo Actuators", IEEE International Conference on Robotics and Automation (ICRA), 2025, pages
12091-12097, arXiv 2410.08650; the same formulas in the documentation of their project Rhoban/bam.
Written from the formulas; no code of theirs is used. With v the velocity behind the gear, tau_m the
torque of the motor and tau_e what acts on it from outside, friction resists with at most

    M1  K_v |v| + K_c
    M2  M1 + s K_cs                                       s = exp(-|v / v_s|^alpha)
    M3  M1 + K_l |tau_m - tau_e|
    M4  M1 + K_l |tau_m - tau_e| + s (K_cs + K_ls |tau_m - tau_e|)
    M5  M1 + |K_m tau_m - K_e tau_e| + s (K_cs + |K_ms tau_m - K_es tau_e|)
    M6  M5 + s Q ,   Q = K_eq tau_e^2 if |tau_m| > |tau_e|, else K_mq tau_m^2

M6 contains the others: K_m = K_e = K_l and K_ms = K_es = K_ls give M4, and so on. The part with K_v
is the damping of a joint, which the engines have themselves; what follows is the dry part.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

MODELS = (1, 2, 3, 4, 5, 6)


@dataclass(frozen=True)
class Friction:
    """Dry friction, all torques on the motor's axis [N.m]."""

    model: int  # 1 to 6; what a model does not have is zero
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
        dry = self.K_c
        if self.model >= 3:
            dry += abs(self.K_m * tau_m - self.K_e * tau_e)
        if self.model in (1, 3):
            return dry
        slow = self.K_cs
        if self.model >= 4:
            slow += abs(self.K_ms * tau_m - self.K_es * tau_e)
        if self.model == 6:
            backdriven = abs(tau_e) >= abs(tau_m)
            slow += self.K_mq * tau_m * tau_m if backdriven else self.K_eq * tau_e * tau_e
        return dry + slow * math.exp(-(abs(v / self.v_s) ** self.alpha))
