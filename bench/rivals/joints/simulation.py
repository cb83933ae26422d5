"""Runs a joint in MuJoCo: drives at the rate of the log, current loops, encoders, clean signals."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from rivals.joints.excitation import Drive
from rivals.joints.parameters import Instruments, Joint, Motor, VariableStiffness
from rivals.records import Array

SAMPLE_PERIOD = 1e-3  # [s]
DURATION = 20.0  # [s]
STEP = 1e-4  # of the physics [s]
VELOCITY_LAG = 5e-3  # of the low pass behind the difference of the encoder [s]
INNER_DELAY = 2e-4  # from command to torque where the log has measured torque [s]


def count(counts: int) -> float:
    """The angle of one count [rad]."""
    return 2 * math.pi / counts


def rounded(angle: Array, counts: int) -> Array:
    """What an encoder with this number of counts a turn reads [rad]; it counts on past a turn."""
    read: Array = np.round(angle / count(counts)) * count(counts)
    return read


class Delay:
    """Gives what it was given `seconds` ago, to the nearest step; zero before that."""

    def __init__(self, seconds: float, step: float) -> None:
        length = round(seconds / step)
        self._past = deque([0.0] * length, maxlen=length) if length else None

    def __call__(self, value: float) -> float:
        if self._past is None:
            return value
        oldest = self._past[0]
        self._past.append(value)
        return oldest


class CurrentLoop:
    """The torque of a motor follows its command late: dead time, then a lag of the first order.

    Torque on the motor's axis [N.m], advanced by one step of the physics at each call.
    """

    def __init__(self, delay: float, lag: float, step: float) -> None:
        """Dead time and time constant [s]."""
        self._delay = Delay(delay, step)
        self._share = -math.expm1(-step / lag)
        self._torque = 0.0

    def __call__(self, command: float) -> float:
        """The torque during the step that begins now, for a command that holds during it."""
        self._torque += self._share * (self._delay(command) - self._torque)
        return self._torque


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


def run(joint: Joint, step: float = STEP) -> Run:
    """Runs the drives of a joint to their end. `step` [s] is that of the physics."""
    from rivals.joints.mujoco_joints import Instant, build  # what is drawn needs no MuJoCo

    physics, observed = build(joint, step), joint.observed
    parts = zip(joint.motors, joint.drives, joint.instruments, strict=True)
    axes = [_Axis(motor, drive, each, step) for motor, drive, each in parts]
    samples = len(joint.drives[0].reference)
    targets = joint.theta_c if isinstance(joint, VariableStiffness) else np.zeros(samples)
    instants: list[Instant] = []
    torques = np.empty((3, samples))
    for k in range(samples):
        for axis, (theta, _, _) in zip(axes, physics.motors(), strict=True):
            axis.decide(k, theta)
        for substep in range(round(SAMPLE_PERIOD / step)):
            states = physics.motors()
            dry = [axis.act(v, load) for axis, (_, v, load) in zip(axes, states, strict=True)]
            physics.advance([axis.torque for axis in axes], dry, float(targets[k]))
            if substep == 0:
                instants.append(physics.instant())
                axis = axes[observed]
                torques[:, k] = axis.torque, axis.late, axis.command
    columns = dict(zip(Instant._fields, np.array(instants).T, strict=True))
    return Run(columns, *torques)
