"""The joints of the catalogue, as data: plants, their usual motion, settings of the estimator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Joint:
    """A joint without misfits."""

    name: str
    plant: Mapping[str, float]
    """Start values of RealJointPlant that differ from the default values."""
    lever_arm: float | None
    """Mean lever arm [m]; None for a joint without a lever arm."""
    torque: float
    """Peak of the torque command [N.m]."""
    deformation: float
    """Usual peak of the deformation [rad]."""
    order: int
    """rls.n and rls.m of the estimator."""
    range_phi: float
    """range.phi of the estimator [rad]."""
    load: float
    """Constant torque on the link, for conditions with a load [N.m]."""
    contact: Mapping[str, float]
    """Start values of RealJointPlant, for conditions with a contact."""
    kp: float
    """Gain of a control of the motor position, on the motor axis [N.m/rad]."""
    kd: float
    """Velocity gain of this control [N.m.s/rad]."""


def _elastic(name: str, k: float, counts: float, deformation: float) -> Joint:
    """A series elastic actuator with the stiffness k [N.m/rad]."""
    return Joint(
        name=name,
        plant={
            "motor.B": 1e-4,
            "motor.D_theta": 5e-4,
            "motor.gamma": 100.0,
            "motor.tau_coulomb": 0.03,
            "link.M": 0.5,
            "link.D_q": 0.1,
            "spring.k_1": k,
            "encoder.theta": counts,
            "encoder.q": counts,
        },
        lever_arm=None,
        torque=0.35,
        deformation=deformation,
        order=1,
        range_phi=2.5 * deformation,
        load=-10.0,
        contact={"contact.k": 3000.0, "contact.d": 20.0},
        kp=15.0,
        kd=0.4,
    )


AWAS = Joint(
    name="AwAS",
    plant={
        "motor.B": 2.3e-5,
        "motor.D_theta": 1e-3,
        "motor.gamma": 50.0,
        "motor.tau_coulomb": 0.02,
        "link.M": 0.1,
        "link.D_q": 0.15,
        "spring.k_1": 0.0,
        "spring.k_s": 14220.0,
        "encoder.theta": 40000.0,
        "encoder.q": 40000.0,
    },
    lever_arm=0.07,
    torque=0.4,
    deformation=0.05,
    order=3,
    range_phi=0.3,
    load=-8.0,
    contact={"contact.k": 200.0, "contact.d": 1.0},
    kp=2.0,
    kd=0.03,
)
SEA_1K = _elastic("SEA1k", 1000.0, 40000.0, 0.012)
SEA_5K = _elastic("SEA5k", 5000.0, 262144.0, 0.0024)

JOINTS: Sequence[Joint] = (AWAS, SEA_1K, SEA_5K)
