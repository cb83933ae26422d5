"""Runs a joint in a foreign engine: drives at the rate of the log, current loops, clean signals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from rivals.joints.current_loop import CurrentLoop, Delay
from rivals.joints.encoders import count
from rivals.joints.excitation import Drive
from rivals.joints.parameters import Instruments, Motor
from rivals.records import Array

SAMPLE_PERIOD = 1e-3  # [s]
DURATION = 20.0  # [s]
STEP = 1e-4  # of the physics [s]
VELOCITY_LAG = 5e-3  # of the low pass behind the difference of the encoder [s]
INNER_DELAY = 2e-4  # from command to torque where the log has measured torque [s]


class Instant(NamedTuple):
    """The observed joint at the beginning of a step; torques behind the gear, on the motor."""

    theta: float  # [rad]
    phi: float  # [rad]
    theta_dot: float  # [rad/s]
    phi_dot: float  # [rad/s]
    theta_ddot: float  # [rad/s2]
    friction: float  # dry, what the engine applied [N.m]
    damper: float  # of the spring [N.m]
    tau_e: float  # of the spring alone [N.m]
    stiffness: float  # [N.m/rad]
    theta_c: float  # [rad]


class Physics(Protocol):
    """A joint in an engine."""

    def motors(self) -> Sequence[tuple[float, float, float]]:
        """Position, velocity and load of each motor, behind its gear [rad, rad/s, N.m]."""

    def advance(self, torques: Sequence[float], dry: Sequence[float], target: float) -> None:
        """One step with these torques, and at most this friction, on the axes of the motors.

        `target` [rad] is where the stiffness motor shall be, if there is one.
        """

    def instant(self) -> Instant:
        """The beginning of the step that `advance` made."""


@dataclass(frozen=True)
class Run:
    """Signals without errors, one entry a sample."""

    signals: dict[str, Array]  # those of Instant by name
    torque: Array  # of the observed motor, on its axis [N.m]
    late: Array  # the same as late as it comes into the log [N.m]
    command: Array  # [N.m]


class _Axis:
    """Controller, current loop and friction of one motor."""

    def __init__(self, motor: Motor, drive: Drive, instruments: Instruments, step: float) -> None:
        delay = instruments.delay if instruments.commanded else INNER_DELAY
        self._loop = CurrentLoop(delay, instruments.lag, step)
        self._late = Delay(0.0 if instruments.commanded else instruments.delay, step)
        self._count = count(instruments.counts_theta)
        self._motor, self._drive = motor, drive
        self._seen: float | None = None
        self._velocity = 0.0
        self.command = self.torque = self.late = 0.0

    def decide(self, k: int, theta: float) -> None:
        """The command of sample k; theta is the true position [rad]."""
        drive = self._drive
        seen = round(theta / self._count) * self._count
        before = seen if self._seen is None else self._seen
        share = SAMPLE_PERIOD / (SAMPLE_PERIOD + VELOCITY_LAG)
        self._velocity += share * ((seen - before) / SAMPLE_PERIOD - self._velocity)
        self._seen = seen
        wanted = drive.kp * (drive.reference[k] - seen) - drive.kd * self._velocity
        self.command = min(max(drive.feed_forward[k] + wanted, -drive.peak), drive.peak)

    def act(self, v: float, load: float) -> float:
        """Sets the torque of the next step; the friction that may resist it [N.m]."""
        self.torque = self._loop(self.command)
        self.late = self._late(self.torque)
        return self._motor.friction.budget(v, self.torque, load / self._motor.gear)


def run(
    physics: Physics,
    motors: Sequence[Motor],
    drives: Sequence[Drive],
    instruments: Sequence[Instruments],
    observed: int = 0,
    theta_c: Array | None = None,
    step: float = STEP,
) -> Run:
    """Runs the drives to their end. `step` [s] is that of `physics`."""
    parts = zip(motors, drives, instruments, strict=True)
    axes = [_Axis(motor, drive, each, step) for motor, drive, each in parts]
    samples = len(drives[0].reference)
    instants: list[Instant] = []
    torques = np.empty((3, samples))
    for k in range(samples):
        for axis, (theta, _, _) in zip(axes, physics.motors(), strict=True):
            axis.decide(k, theta)
        target = 0.0 if theta_c is None else float(theta_c[k])
        for substep in range(round(SAMPLE_PERIOD / step)):
            states = physics.motors()
            dry = [axis.act(v, load) for axis, (_, v, load) in zip(axes, states, strict=True)]
            physics.advance([axis.torque for axis in axes], dry, target)
            if substep == 0:
                instants.append(physics.instant())
                axis = axes[observed]
                torques[:, k] = axis.torque, axis.late, axis.command
    columns = dict(zip(Instant._fields, np.array(instants).T, strict=True))
    return Run(columns, *torques)
