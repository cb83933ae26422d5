"""Defines an experiment of the misfit study, and a condition: a misfit that is added to it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum

import numpy as np

from sigmahat.experiments.scenario import Sine, Sines
from sigmahat.fmi.model import Value


@dataclass(frozen=True)
class JointKind:
    """A kind of joint, without misfits."""

    name: str
    plant: Mapping[str, float]  # start values of RealJointPlant that differ from the default values
    lever_arm: float | None  # mean lever arm [m]; None for a joint without a lever arm
    torque: float  # peak of the torque command [N.m]
    deformation: float  # usual peak of the deformation [rad]
    order: int  # rls.n and rls.m of the estimator
    range_phi: float  # range.phi of the estimator [rad]
    load: float  # constant torque on the link, for conditions with a load [N.m]
    contact: Mapping[str, float]  # start values of RealJointPlant, for conditions with a contact
    kp: float  # gain of a control of the motor position, on the motor axis [N.m/rad]
    kd: float  # velocity gain of this control [N.m.s/rad]


def _elastic(name: str, k: float, counts: float, deformation: float) -> JointKind:
    """A series elastic actuator with the stiffness k [N.m/rad]."""
    return JointKind(
        name=name,
        plant={
            "motor.B": 1e-4, "motor.D_theta": 5e-4, "motor.gamma": 100.0, "motor.tau_coulomb": 0.03,
            "link.M": 0.5, "link.D_q": 0.1, "spring.k_1": k,
            "encoder.theta": counts, "encoder.q": counts,
        },
        lever_arm=None, torque=0.35, deformation=deformation, order=1, range_phi=2.5 * deformation,
        load=-10.0, contact={"contact.k": 3000.0, "contact.d": 20.0}, kp=15.0, kd=0.4,
    )  # fmt: skip


AWAS = JointKind(
    name="AwAS",
    plant={
        "motor.B": 2.3e-5, "motor.D_theta": 1e-3, "motor.gamma": 50.0, "motor.tau_coulomb": 0.02,
        "link.M": 0.1, "link.D_q": 0.15, "spring.k_1": 0.0, "spring.k_s": 14220.0,
        "encoder.theta": 40000.0, "encoder.q": 40000.0,
    },
    lever_arm=0.07, torque=0.4, deformation=0.05, order=3, range_phi=0.3,
    load=-8.0, contact={"contact.k": 200.0, "contact.d": 1.0}, kp=2.0, kd=0.03,
)  # fmt: skip
SEA_1K = _elastic("SEA1k", 1000.0, 40000.0, 0.012)
SEA_5K = _elastic("SEA5k", 5000.0, 262144.0, 0.0024)

JOINTS: Sequence[JointKind] = (AWAS, SEA_1K, SEA_5K)

DRIFT_TIME = 60.0  # time in which a drift reaches its value [s]
_LEVER_ARM_CHANGE = 0.012  # peak of the motion of a lever arm [m]


class TorqueHold(Enum):
    """The torque between two samples, and the torque that is measured at a sample."""

    LINEAR = 1  # linear between the samples; measured: the torque at the sample
    HELD = 2  # held; measured: the torque of the period that begins
    HELD_MEAN = 3  # held; measured: the mean torque of the periods that end and begin


@dataclass(frozen=True)
class Control:
    """Control of the measured motor position, by the torque that the drive holds."""

    reference: Sines  # wanted position [rad]
    kp: float  # motor torque per position error at the gear output [N.m/rad]
    kd: float  # motor torque per motor velocity at the gear output [N.m.s/rad]
    kq: float = 0.0  # motor torque per link velocity [N.m.s/rad]


@dataclass(frozen=True)
class Experiment:
    """All settings of a run. Function `draw` adds no misfits; conditions add misfits."""

    joint: JointKind
    seed: int  # seed of the noise and of other random effects in the run
    plant: Mapping[str, float]  # start values of RealJointPlant that differ from the default values
    torque: Sines  # torque command, on the motor axis [N.m]; not used under control
    lever_arm: Sines | None  # lever arm [m]; None for a joint without a lever arm
    errors: Mapping[str, float]  # relative errors of B and D_theta that the estimator is given [1]
    estimator: Mapping[str, Value] = field(default_factory=dict)  # start values besides `settings`
    T: float = 1e-3  # sample period [s]
    duration: float = 20.0  # [s]
    rest: float = 0.0  # time until the torque begins [s]
    hold: TorqueHold = TorqueHold.LINEAR
    control: Control | None = None  # control of the position; None: the torque is the command
    late: float = 0.0  # delay of the measured torque [s], below 0: early; TorqueHold.LINEAR only
    jitter: float = 0.0  # standard deviation of the sample times, divided by T [1]
    load: float = 0.0  # constant external torque on the link [N.m]
    drift: Mapping[str, float] = field(default_factory=dict)
    """Inputs of RealJointPlant that go from 0 to this value in DRIFT_TIME, linearly."""

    @property
    def stiffness(self) -> float:
        """Stiffness of the undeformed spring, at the mean lever arm [N.m/rad]."""
        arm = self.joint.lever_arm or 0.0
        return self.plant["spring.k_1"] + 2 * self.plant.get("spring.k_s", 0.0) * arm**2

    def with_plant(self, changed: Mapping[str, float]) -> Experiment:
        return replace(self, plant={**self.plant, **changed})

    def with_estimator(self, changed: Mapping[str, Value]) -> Experiment:
        return replace(self, estimator={**self.estimator, **changed})


class Group(Enum):
    """Class of a condition, which decides on the requirements for the estimate."""

    CLEAN = "clean"
    CLASS_1 = "class 1"
    CLASS_2 = "class 2"
    CLASS_3 = "class 3"
    GAIN = "torque gain"
    RANDOM = "random"
    NONE = "no class"


Change = Callable[[Experiment], Experiment]


@dataclass(frozen=True)
class Condition:
    """A row of the table for each of its joints."""

    group: Group
    name: str
    change: Change  # adds the misfit to an experiment
    joints: Sequence[JointKind] = JOINTS  # joints that can have the misfit
    torque_gain: float = 0.0  # prior standard deviation of the gain of the torque [1]


def draw(joint: JointKind, seed: int) -> Experiment:
    """An experiment without misfits, whose motion and errors of motor data are random.

    The estimator is given friction 10 % and inertia 5 % wrong, each too large or too small.
    """
    rng = np.random.default_rng([seed, JOINTS.index(joint)])
    torque = _multisine(rng, (0.1, 10.0), joint.torque, (3, 6))
    arm = _multisine(rng, (0.05, 0.5), _LEVER_ARM_CHANGE, (1, 3))
    return Experiment(
        joint=joint,
        seed=int(rng.integers(1, 2**31)),
        plant=joint.plant,
        torque=torque,
        lever_arm=None if joint.lever_arm is None else replace(arm, offset=joint.lever_arm),
        errors={"D_theta": 0.1 * rng.choice((-1, 1)), "B": 0.05 * rng.choice((-1, 1))},
    )


def _multisine(
    rng: np.random.Generator, band: tuple[float, float], peak: float, count: tuple[int, int]
) -> Sines:
    """Sines at random frequencies: one sine in each of equal parts of the band [Hz] on a log axis.

    The sum of the amplitudes is the peak. The number of sines is between the two counts.
    """
    n = int(rng.integers(count[0], count[1] + 1))
    low, high = map(math.log, band)
    places = (np.arange(n) + rng.uniform(size=n)) / n
    frequencies = np.exp(low + places * (high - low))
    phases = 2 * math.pi * rng.uniform(size=n)
    amplitudes = rng.uniform(0.3, 1.0, n)
    amplitudes *= peak / amplitudes.sum()
    terms = zip(amplitudes.tolist(), frequencies.tolist(), phases.tolist(), strict=True)
    return Sines(0.0, tuple(Sine(*term) for term in terms))
