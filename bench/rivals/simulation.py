"""Runs a joint in MuJoCo: drive at the rate of the log, current loop, encoders; makes the log.

The motor is the hinge theta. The spring is on the hinge phi of the body behind it, so that
q = theta + phi. Armature, damping, dry friction (a constraint, whose limit is set at every step),
spring and integration are MuJoCo's.
"""

from __future__ import annotations

import math
from collections import deque
from typing import Any

import numpy as np

from rivals.draw import SAMPLE_PERIOD, STD_B, STD_D, STD_GAIN, drawn
from rivals.joint import Joint
from rivals.records import Array, JointLog, Known

STEP = 1e-4  # of the physics [s]
VELOCITY_LAG = 5e-3  # of the low pass behind the difference of the encoder [s]
INNER_DELAY = 2e-4  # from command to torque where the log has measured torque [s]
FLANGE = 0.002
"""Share of a motor's inertia that is a body behind its gear, the rest is armature. An engine needs
a body there, which has no weight."""

Run = dict[str, Array]
"""A run without errors, one entry a sample.

theta, phi [rad], theta_dot [rad/s], theta_ddot [rad/s2]; torques behind the gear, on the motor:
dry friction that the engine applied, damper and spring (tau_e) [N.m]; stiffness [N.m/rad]; torques
on the motor's axis: command, torque, late (the torque after the delay of its measurement) [N.m].
"""


def make(seed: int) -> JointLog:
    """The log of the joint with this seed."""
    joint = drawn(seed)
    return log(run(joint), joint, np.random.default_rng([seed, 0, 0, 1]))


def log(run: Run, joint: Joint, rng: np.random.Generator) -> JointLog:
    """The log of a run of a joint; `rng` draws the noise."""
    sheet, motor, tools = joint.sheet, joint.motor, joint.instruments
    torque = run["command" if tools.commanded else "late"]
    return JointLog(
        sample_period=SAMPLE_PERIOD,
        theta=_rounded(run["theta"], tools.counts_theta),
        q=_rounded(run["theta"] + run["phi"], tools.counts_q),
        tau=tools.gain * torque + tools.noise * rng.standard_normal(len(torque)),
        stiffness=run["stiffness"],
        known=Known(
            gamma=motor.gear,
            B=sheet.B * motor.B,
            D_theta=sheet.D * motor.D,
            relative_std_B=STD_B,
            relative_std_D_theta=STD_D,
            relative_std_gain=STD_GAIN,
            tau_coulomb=sheet.coulomb * motor.friction.at_rest,
            noise_tau=tools.noise,
            counts_theta=tools.counts_theta,
            counts_q=tools.counts_q,
            range_phi=sheet.phi * float(np.abs(run["phi"]).max()),
            range_tau_e=sheet.tau_e * float(np.abs(run["tau_e"]).max()),
        ),
    )


def _rounded(angle: Array, counts: int) -> Array:
    """The reading of an encoder with this number of counts a turn [rad], also beyond a turn."""
    count = 2 * math.pi / counts
    read: Array = np.round(angle / count) * count
    return read


def run(joint: Joint) -> Run:
    """Runs the drive of a joint to its end."""
    physics, axis = _Physics(joint), _Axis(joint)
    rows: list[dict[str, float]] = []
    for k in range(len(joint.drive.reference)):
        axis.decide(k, physics.theta)
        for substep in range(round(SAMPLE_PERIOD / STEP)):
            axis.act(physics.velocity, physics.load)
            state = physics.advance(axis.torque, axis.dry)
            if substep == 0:
                of_axis = {"torque": axis.torque, "late": axis.late, "command": axis.command}
                rows.append({**state, **of_axis})
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


class _Delay:
    """Gives the value of `seconds` ago, to the nearest step; zero before that."""

    def __init__(self, seconds: float) -> None:
        length = 1 + round(seconds / STEP)
        self._past = deque([0.0] * length, maxlen=length)

    def __call__(self, value: float) -> float:
        self._past.append(value)
        return self._past[0]


class _Axis:
    """Controller, current loop and friction of the motor.

    The torque follows its command late: after a dead time, with a lag of the first order.
    """

    def __init__(self, joint: Joint) -> None:
        tools = joint.instruments
        at_command, at_log = tools.delay, 0.0
        if not tools.commanded:
            at_command, at_log = INNER_DELAY, tools.delay
        self._dead, self._late = _Delay(at_command), _Delay(at_log)
        self._share = -math.expm1(-STEP / tools.lag)
        self._count = 2 * math.pi / tools.counts_theta
        self._motor, self._drive = joint.motor, joint.drive
        self._seen: float | None = None
        self._velocity = 0.0
        self.command = self.torque = self.late = self.dry = 0.0

    def decide(self, k: int, theta: float) -> None:
        """Sets the command of sample k; theta is the true position [rad]."""
        drive, peak = self._drive, self._motor.peak
        seen = round(theta / self._count) * self._count
        before = seen if self._seen is None else self._seen
        share = SAMPLE_PERIOD / (SAMPLE_PERIOD + VELOCITY_LAG)
        self._velocity += share * ((seen - before) / SAMPLE_PERIOD - self._velocity)
        self._seen = seen
        wanted = drive.kp * (drive.reference[k] - seen) - drive.kd * self._velocity
        self.command = min(max(drive.feed_forward[k] + wanted, -peak), peak)

    def act(self, v: float, load: float) -> None:
        """Sets the torque of the next step, and the friction `dry` that may resist it [N.m]."""
        self.torque += self._share * (self._dead(self.command) - self.torque)
        self.late = self._late(self.torque)
        self.dry = self._motor.friction.budget(v, self.torque, load / self._motor.gear)


class _Physics:
    """A joint in MuJoCo."""

    def __init__(self, joint: Joint) -> None:
        import mujoco  # drawing needs no MuJoCo

        self._engine = mujoco
        self._model = mujoco.MjModel.from_xml_string(_mjcf(joint))
        self._data: Any = mujoco.MjData(self._model)
        self._gear, self._spring = joint.motor.gear, joint.spring
        self._theta, self._phi = self._dof("theta"), self._dof("phi")
        mujoco.mj_forward(self._model, self._data)

    def _dof(self, name: str) -> int:
        return int(self._model.joint(name).dofadr[0])

    @property
    def theta(self) -> float:
        """Position of the motor behind its gear [rad]."""
        return float(self._data.qpos[self._theta])

    @property
    def velocity(self) -> float:
        """Velocity of the motor behind its gear [rad/s]."""
        return float(self._data.qvel[self._theta])

    @property
    def load(self) -> float:
        """Torque of the spring with its damping on the motor [N.m]."""
        data, j = self._data, self._phi
        return -float(data.qfrc_spring[j]) - float(data.qfrc_damper[j])

    def advance(self, torque: float, dry: float) -> dict[str, float]:
        """One step; the motion and the torques at its beginning, as in Run.

        torque  of the motor, on its axis [N.m]
        dry     largest dry friction, on the motor's axis [N.m]
        """
        data, i, j = self._data, self._theta, self._phi
        data.ctrl[0] = torque
        self._model.dof_frictionloss[i] = self._gear * dry
        phi = float(data.qpos[j])
        motion = {"theta": self.theta, "phi": phi, "theta_dot": self.velocity}
        self._engine.mj_step(self._model, data)
        return {
            **motion,
            "theta_ddot": float(data.qacc[i]),
            "friction": float(data.qfrc_constraint[i] - data.qfrc_constraint[j]),
            "damper": -float(data.qfrc_damper[j]),
            "tau_e": -float(data.qfrc_spring[j]),
            "stiffness": self._spring.stiffness + 3 * self._spring.k_3 * phi**2,
        }


def _mjcf(joint: Joint) -> str:
    """The model: a flange with the motor's hinge, and a link that hangs down at q = 0."""
    motor, spring, link = joint.motor, joint.spring, joint.link
    flange = FLANGE * motor.inertia
    return f"""
        <mujoco>
          <compiler angle="radian"/>
          <option timestep="{STEP!r}" integrator="implicitfast" gravity="0 0 {-joint.gravity!r}"/>
          <worldbody>
            <body>
              <joint name="theta" axis="0 -1 0" armature="{motor.inertia - flange!r}"
                     damping="{motor.D * motor.gear**2!r}"
                     frictionloss="{motor.gear * motor.friction.at_rest!r}"
                     solreffriction="{motor.stiction_time!r} 1"/>
              <inertial pos="0 0 0" mass="1e-6" diaginertia="{flange!r} {flange!r} {flange!r}"/>
              <body>
                <joint name="phi" axis="0 -1 0" stiffness="{spring.stiffness!r} 0 {spring.k_3!r}"
                       damping="{spring.damping!r}"/>
                <inertial pos="0 0 {-link.centre!r}" mass="{link.mass!r}"
                          diaginertia="{link.inertia!r} {link.inertia!r} {link.inertia!r}"/>
              </body>
            </body>
          </worldbody>
          <actuator><motor joint="theta" gear="{motor.gear!r}"/></actuator>
        </mujoco>"""
