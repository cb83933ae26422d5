"""Runs a joint in MuJoCo: drive at the rate of the log, current loop, encoders; makes the log.

The motor is the hinge theta. The spring is on the hinge phi of the body behind it, so that
q = theta + phi. Armature, damping, dry friction (a constraint, whose limit is set at every step),
springs, tendons and integration are MuJoCo's. The tendons are spatial: MuJoCo finds their lengths
and lever arms, so their torque is no formula of ours. They pull, and do not push; `joint.Tendons`
says how they run.
"""

from __future__ import annotations

import math
from collections import deque
from typing import Any

import numpy as np

from rivals.draw import KINDS, SAMPLE_PERIOD, STD_B, STD_D, STD_GAIN, drawn
from rivals.joint import Joint, Link, Motor, Spring, Tendons
from rivals.records import Array, JointLog, Known

STEP = 1e-4  # of the physics [s]
VELOCITY_LAG = 5e-3  # of the low pass behind the difference of the encoder [s]
INNER_DELAY = 2e-4  # from command to torque where the log has measured torque [s]
DIFFERENCE = 1e-6  # of phi, for the slope of the torque [rad]
FLANGE = 0.002
"""Share of a motor's inertia that is a body behind its gear, the rest is armature. An engine needs
a body there, which has no weight."""
SLIDER_MASS = 0.1  # [kg]
SLIDER_ARMATURE = 5.0  # of its screw and motor [kg]
SERVO = 40.0  # stiffness of the servo of the slider, by that of a tendon
DAMPED = 1.4  # damping of that servo, by the geometric mean of its stiffness and armature

Run = dict[str, Array]
"""A run without errors, one entry a sample; torques behind the gear, on the motor.

theta, phi [rad], theta_dot [rad/s], theta_ddot [rad/s2], dry friction that the engine applied,
damper and spring (tau_e) [N.m], stiffness [N.m/rad], theta_c [rad]; on the motor's axis: torque,
late (the torque after the delay of its measurement), command [N.m].
"""


def make(kind: str, seed: int) -> JointLog:
    """The log of a joint: one of KINDS."""
    joint = drawn(kind, seed)
    return log(run(joint), joint, np.random.default_rng([seed, KINDS.index(kind), 0, 1]))


def log(run: Run, joint: Joint, rng: np.random.Generator) -> JointLog:
    """The log of a run of a joint; `rng` draws the noise."""
    sheet, motor, tools = joint.sheet, joint.motor, joint.instruments
    torque = run["command" if tools.commanded else "late"]
    return JointLog(
        sample_period=SAMPLE_PERIOD,
        theta=_rounded(run["theta"], tools.counts_theta),
        q=_rounded(run["theta"] + run["phi"], tools.counts_q),
        tau=tools.gain * torque + tools.noise * rng.standard_normal(len(torque)),
        theta_c=run["theta_c"],
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
            before = physics.advance(axis.torque, axis.dry, float(joint.theta_c[k]))
            if substep == 0:
                of_axis = {"torque": axis.torque, "late": axis.late, "command": axis.command}
                rows.append({**before, **physics.instant(), **of_axis})
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
        self._probe: Any = mujoco.MjData(self._model)
        self._gear = joint.motor.gear
        self._theta, self._phi = self._dof("theta"), self._dof("phi")
        self._travel, self._slider = 0.0, -1
        if isinstance(joint.elastic, Tendons):
            self._travel, self._slider = joint.elastic.travel, self._dof("slider")
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
        """Torque of the elastic element on the motor [N.m]."""
        data, j = self._data, self._phi
        return -float(data.qfrc_spring[j]) - float(data.qfrc_damper[j])

    def advance(self, torque: float, dry: float, theta_c: float) -> dict[str, float]:
        """One step; positions and velocity before it.

        torque   of the motor, on its axis [N.m]
        dry      largest dry friction, on the motor's axis [N.m]
        theta_c  reference of the stiffness motor, if there is one [rad]
        """
        data = self._data
        data.ctrl[0] = torque
        self._model.dof_frictionloss[self._theta] = self._gear * dry
        phi, theta_dot = float(data.qpos[self._phi]), self.velocity
        before = {"theta": self.theta, "phi": phi, "theta_dot": theta_dot, "theta_c": 0.0}
        if self._travel:
            data.ctrl[1] = self._travel * theta_c
            before["theta_c"] = float(data.qpos[self._slider]) / self._travel
        self._probe.qpos[:] = data.qpos
        self._engine.mj_step(self._model, data)
        return before

    def instant(self) -> dict[str, float]:
        """Acceleration and torques at the beginning of the step that `advance` made."""
        data, i, j = self._data, self._theta, self._phi
        return {
            "theta_ddot": float(data.qacc[i]),
            "friction": float(data.qfrc_constraint[i] - data.qfrc_constraint[j]),
            "damper": -float(data.qfrc_damper[j]),
            "tau_e": -float(data.qfrc_spring[j]),
            "stiffness": self._slope(j),
        }

    def _slope(self, dof: int) -> float:
        """Of the torque on the motor, by central differences of phi in the model itself."""
        probe, phi = self._probe, float(self._probe.qpos[dof])
        torque = []
        for side in (1, -1):
            probe.qpos[dof] = phi + side * DIFFERENCE
            self._engine.mj_fwdPosition(self._model, probe)
            self._engine.mj_fwdVelocity(self._model, probe)
            torque.append(-float(probe.qfrc_spring[dof]))
        return (torque[0] - torque[1]) / (2 * DIFFERENCE)


def _mjcf(joint: Joint) -> str:
    """The model, with an actuator for each motor."""
    elastic, levers, slider, pulls = joint.elastic, "", "", ""
    if isinstance(elastic, Tendons):
        levers, slider, pulls = _levers(elastic), _slider(elastic), _pulls(elastic)
    return (
        f'<mujoco><compiler angle="radian"/>'
        f'<option timestep="{STEP!r}" integrator="implicitfast" gravity="0 0 {-joint.gravity!r}"/>'
        f"<worldbody><body>{_flange(joint.motor)}{levers}<body>{_hinge(elastic)}"
        f"{_inertia(joint.link)}{slider}</body></body></worldbody>"
        f'<actuator><motor joint="theta" gear="{joint.motor.gear!r}"/></actuator>{pulls}</mujoco>'
    )


def _flange(motor: Motor) -> str:
    """Hinge and inertia of a motor's flange."""
    body = FLANGE * motor.inertia
    return (
        f'<joint name="theta" axis="0 -1 0" armature="{motor.inertia - body!r}"'
        f' damping="{motor.D * motor.gear**2!r}"'
        f' frictionloss="{motor.gear * motor.friction.at_rest!r}"'
        f' solreffriction="{motor.stiction_time!r} 1"/>'
        f'<inertial pos="0 0 0" mass="1e-6" diaginertia="{body!r} {body!r} {body!r}"/>'
    )


def _hinge(elastic: Spring | Tendons) -> str:
    spring = ""
    if isinstance(elastic, Spring):
        spring = f' stiffness="{elastic.stiffness!r} 0 {elastic.k_3!r}"'
    return f'<joint name="phi" axis="0 -1 0"{spring} damping="{elastic.damping!r}"/>'


def _inertia(link: Link) -> str:
    """Mass of a link that hangs down at q = 0."""
    turning = f"{link.inertia!r} {link.inertia!r} {link.inertia!r}"
    return f'<inertial pos="0 0 {-link.centre!r}" mass="{link.mass!r}" diaginertia="{turning}"/>'


def _levers(tendons: Tendons) -> str:
    """The ends of the tendons in the body of the motor's flange."""
    side = tendons.lever * math.sin(tendons.spread)
    up = tendons.lever * math.cos(tendons.spread)
    return "".join(
        f'<site name="{end}" pos="{x!r} 0 {-up!r}"/>'
        for end, x in (("left", -side), ("right", side))
    )


def _slider(tendons: Tendons) -> str:
    """The eyelet in the body of the link, and the slider."""
    return (
        f'<site name="eyelet" pos="0 0 {-tendons.eyelet!r}"/>'
        f'<body pos="0 0 {-tendons.eyelet - _behind(tendons)!r}">'
        f'<inertial pos="0 0 0" mass="{SLIDER_MASS!r}"'
        ' diaginertia="1e-5 1e-5 1e-5"/><site name="slider"/>'
        f'<joint name="slider" type="slide" axis="0 0 -1" armature="{SLIDER_ARMATURE!r}"/></body>'
    )


def _behind(tendons: Tendons) -> float:
    """From eyelet to slider [m]."""
    return 0.05 + tendons.tension / tendons.stiffness


def _pulls(tendons: Tendons) -> str:
    """The tendons, and the servo of their slider."""
    behind = _behind(tendons)
    rest = tendons.length(tendons.spread) + behind - tendons.tension / tendons.stiffness
    pulls = "".join(
        f'<spatial stiffness="{tendons.stiffness!r}" springlength="0 {rest!r}">'
        f'<site site="{end}"/><site site="eyelet"/><site site="slider"/></spatial>'
        for end in ("left", "right")
    )
    kp = SERVO * tendons.stiffness
    kv = DAMPED * math.sqrt(kp * SLIDER_ARMATURE)
    servo = f'<position joint="slider" kp="{kp!r}" kv="{kv!r}"/>'
    return f"<tendon>{pulls}</tendon><actuator>{servo}</actuator>"
