"""Logs of joints that are drawn at random, with effects that the motor equation does not have, and
right configurations of these logs."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from plant_runs import run_plant, times
from recorded_logs import configured

Array = NDArray[np.float64]

MOTIONS = ("sines", "slow", "pushed")
"""Several sines of the motor's torque; slow ones alone; a link that is pushed against a contact."""
_EFFECTS = 4  # number of unmodelled effects of a joint
_GEARS = (30.0, 50.0, 80.0, 100.0, 120.0, 160.0)
_PERIODS = (1e-3, 2e-3, 4e-3)  # [s]
_LINES = (2000.0, 4096.0, 16384.0)  # counts per turn of the motor


@dataclass(frozen=True)
class DrawnJoint:
    """A joint, and the size of its motions."""

    plant: Mapping[str, float]  # start values of RealJointPlant
    T: float  # sample period [s]
    top: float  # largest torque of the spring [N.m]

    @property
    def gear(self) -> float:
        return self.plant["motor.gamma"]

    def log(self, motion: str, duration: float) -> dict[str, Array]:
        """Records one of MOTIONS: t, theta before the gear, q and tau, in rad and N.m."""
        t = times(self.T, duration)
        torque, push = _torques(motion, t)
        contact = {}
        if motion == "pushed":
            stiffness = self.plant["spring.k_1"]
            contact = {"contact.k": 0.3 * stiffness, "contact.d": 0.01 * stiffness}
        run = run_plant(
            "RealJointPlant",
            ("tau", "tau_ext"),
            self.T,
            np.column_stack([0.9 * self.top / self.gear * torque, self.top * push]),
            {**self.plant, **contact},
            ("theta_measured", "q_measured", "tau_measured"),
        )
        theta, q, tau = run.values()
        return {"t": t, "theta": self.gear * theta, "q": q, "tau": tau}

    def configuration(self, is_motor_known: bool) -> str:
        """A right configuration, with the motor of a data sheet or before `identify`."""
        plant = self.plant
        names = ("motor.gamma", "encoder.theta", "encoder.q")
        motor = [
            f"motor.B = {1.08 * plant['motor.B']}",
            f"motor.D_theta = {0.8 * plant['motor.D_theta']}",
            "prior.B = 0.1",
        ]
        unknown = ["prior.B = 1000", "prior.D_theta = 1000", "prior.tau_coulomb = 1.0"]
        parameters = configured(
            f"samplePeriod = {self.T}",
            "rls.m = 1",
            *(f"{name} = {plant[name]}" for name in names),
            *(motor if is_motor_known else unknown),
        )
        return f"ports.theta.gear_ratio = {self.gear}\n{parameters}"


def drawn_joint(seed: int) -> DrawnJoint:
    """Draws a joint from a watt to several kilowatts, with four unmodelled effects."""
    rng = np.random.default_rng(seed)

    def between(low: float, high: float) -> float:
        """Draws from a uniform distribution of the logarithm."""
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    gear, T = float(rng.choice(_GEARS)), float(rng.choice(_PERIODS))
    stiffness = between(80, 8000)
    link = between(0.1, 2.0) * stiffness / 1000 + 0.02
    top = between(0.01, 0.05) * stiffness
    coulomb = between(0.02, 0.15) * top / gear
    plant = {
        "motor.gamma": gear,
        "motor.B": between(0.05, 0.5) * link / gear**2,
        "motor.D_theta": between(0.02, 0.2) * top / gear**2,
        "motor.tau_coulomb": coulomb,
        "link.M": link,
        "link.D_q": 0.01 * top + 0.001,
        "link.mgl": float(rng.choice([0.0, between(0.05, 0.5) * top])),
        "spring.k_1": stiffness,
        "encoder.theta": float(rng.choice(_LINES)) * gear,
        "encoder.q": float(2 ** rng.integers(15, 20)),
        "noise.tau_variance": (between(0.001, 0.01) * top / gear) ** 2,
        "noise.seed": float(seed),
    }
    effects = {
        "spring.k_3": between(0.1, 1.0) * stiffness**3 / top**2 / 3,
        "spring.damping": between(2e-4, 3e-3),
        "spring.dahl": rng.uniform(0.01, 0.05) * top,
        "motor.load_friction": rng.uniform(0.02, 0.12),
        "motor.stribeck": rng.uniform(0.1, 0.6),
        "motor.uneven": rng.uniform(-0.2, 0.2),
        "motor.cogging": rng.uniform(0.02, 0.2) * coulomb,
        "motor.ripple": rng.uniform(0.005, 0.03),
        "motor.v_bend": between(0.5, 3.0),
        "gear.kinematic_error": rng.uniform(0.002, 0.02) * top / stiffness,
    }
    chosen = rng.choice(list(effects), _EFFECTS, replace=False)
    return DrawnJoint(plant | {name: float(effects[name]) for name in chosen}, T, top)


def _torques(motion: str, t: Array) -> tuple[Array, Array]:
    """Torques of motor and hand, relative to the largest one of motor and spring."""

    def sines(*waves: tuple[float, float]) -> Array:
        """Waves of given amplitudes and frequencies [Hz]."""
        each = [A * np.sin(2 * np.pi * f * t + 0.7 * i) for i, (A, f) in enumerate(waves)]
        return np.asarray(np.sum(each, axis=0))

    if motion == "slow":
        return sines((0.8, 0.23), (0.2, 0.61)), 0 * t
    if motion == "pushed":
        return sines((0.6, 0.9)), sines((0.4, 0.37), (0.2, 2.3))
    return sines((0.5, 0.31), (0.4, 1.3), (0.3, 4.1)), 0 * t
