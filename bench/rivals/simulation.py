"""Runs a joint in MuJoCo: drives at the rate of the log, current loops, encoders; makes the log.

Motor i is the hinge theta_i, with an actuator; its spring is on the hinge phi_i of the body behind
it, so that q = theta + phi. Armature, damping, dry friction (a constraint, whose limit is set at
every step), springs, tendons, contact and integration are MuJoCo's. The tendons are spatial: MuJoCo
finds their lengths and lever arms, so their torque is no formula of ours. Tendons pull, and do not
push; `joint.Tendons` describes their paths.
"""

import math
from collections import deque
from pathlib import Path
from typing import Any

import numpy as np

from rivals.draw import KINDS, SAMPLE_PERIOD, TIP, drawn
from rivals.joint import DrawnJoint, DriveCommand, Instruments, Motor
from rivals.records import Array, JointLog
from sigmahat.files.templates import environment

STEP = 1e-4  # of the physics [s]
VELOCITY_LAG = 5e-3  # time constant of the low pass of the encoder's difference [s]
INNER_DELAY = 2e-4  # delay from command to torque if the log has measured torque [s]
DIFFERENCE = 1e-6  # of phi, for the slope of the torque [rad]
FLANGE = 0.002
"""Fraction of the motor inertia in a body after the gear; the other part is armature. MuJoCo needs
this body without weight, whose acceleration is equal to the acceleration of the flange."""
SLIDER_MASS = 0.1  # [kg]
SLIDER_ARMATURE = 5.0  # of its screw and motor [kg]
SERVO = 40.0  # stiffness of the slider servo divided by the stiffness of a tendon
DAMPED = 1.4  # servo damping divided by the geometric mean of servo stiffness and armature

Run = dict[str, Array]
"""True signals of the observed joint, one entry per sample; torques are at the gear output.

theta, phi [rad], theta_dot [rad/s], theta_ddot [rad/s2], dry friction that the engine applied,
damper and spring (tau_e) [N.m], stiffness [N.m/rad], theta_c [rad]; on the motor's axis: torque,
the same as late as it comes into the log, command [N.m].
"""


def make(kind: str, seed: int) -> JointLog:
    """Simulates a joint of one of KINDS, and returns its log."""
    joint = drawn(kind, seed)
    noise = np.random.default_rng([seed, KINDS.index(kind), 0, 1])
    return log(kind, seed, run(joint), joint, noise)


def log(kind: str, seed: int, run: Run, joint: DrawnJoint, rng: np.random.Generator) -> JointLog:
    """Creates the log of a simulated joint; `rng` draws the noise."""
    motor, tools = joint.motors[joint.observed], joint.instruments[joint.observed]
    true = {
        "motor.gamma": motor.gear,
        "motor.B": motor.B,
        "motor.D_theta": motor.D,
        "prior.tau_coulomb": motor.friction.at_rest,
        "noise.tau": tools.noise,
        "encoder.theta": float(tools.counts_theta),
        "encoder.q": float(tools.counts_q),
        "range.phi": float(np.abs(run["phi"]).max()),
        "prior.tau_e": float(np.abs(run["tau_e"]).max()),
    }
    torque = run["command" if tools.commanded else "late"]
    return JointLog(
        kind=kind,
        seed=seed,
        sample_period=SAMPLE_PERIOD,
        theta=_rounded(run["theta"], tools.counts_theta),
        q=_rounded(run["theta"] + run["phi"], tools.counts_q),
        tau=tools.gain * torque + tools.noise * rng.standard_normal(len(torque)),
        theta_c=run["theta_c"],
        tau_e=run["tau_e"],
        stiffness=run["stiffness"],
        known={name: joint.sheet.get(name, 1.0) * value for name, value in true.items()},
    )


def _rounded(angle: Array, counts: int) -> Array:
    """Rounds an angle to the counts of an encoder [rad], which counts more than one turn."""
    count = 2 * math.pi / counts
    read: Array = np.round(angle / count) * count
    return read


def run(joint: DrawnJoint) -> Run:
    """Runs the drives of a joint to their end."""
    physics, observed = _Physics(joint), joint.observed
    parts = zip(joint.motors, joint.drives, joint.instruments, strict=True)
    axes = [_Axis(*each) for each in parts]
    samples = len(joint.drives[0].reference)
    targets = np.zeros(samples) if joint.theta_c is None else joint.theta_c
    rows: list[dict[str, float]] = []
    for k in range(samples):
        for axis, (theta, _, _) in zip(axes, physics.motors(), strict=True):
            axis.decide(k, theta)
        for substep in range(round(SAMPLE_PERIOD / STEP)):
            for axis, state in zip(axes, physics.motors(), strict=True):
                axis.act(*state)
            physics.advance(axes, float(targets[k]))
            if substep == 0:
                axis = axes[observed]
                of_axis = {"torque": axis.torque, "late": axis.late, "command": axis.command}
                rows.append({**physics.instant(), **of_axis})
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


class _Delay:
    """Delays a signal by `seconds`, to the nearest step; the signal is zero at first."""

    def __init__(self, seconds: float) -> None:
        length = 1 + round(seconds / STEP)
        self._past = deque([0.0] * length, maxlen=length)

    def __call__(self, value: float) -> float:
        self._past.append(value)
        return self._past[0]


class _Axis:
    """Controller, current loop and friction of one motor.

    The torque follows its command late: after a dead time, with a lag of the first order.
    """

    def __init__(self, motor: Motor, drive: DriveCommand, instruments: Instruments) -> None:
        at_command, at_log = instruments.delay, 0.0
        if not instruments.commanded:
            at_command, at_log = INNER_DELAY, instruments.delay
        self._dead, self._late = _Delay(at_command), _Delay(at_log)
        self._share = -math.expm1(-STEP / instruments.lag)
        self._count = 2 * math.pi / instruments.counts_theta
        self._motor, self._drive = motor, drive
        self._seen: float | None = None
        self._velocity = 0.0
        self.command = self.torque = self.late = self.dry = 0.0

    def decide(self, k: int, theta: float) -> None:
        """Computes the command of sample k; theta is the true position [rad]."""
        drive = self._drive
        seen = round(theta / self._count) * self._count
        before = seen if self._seen is None else self._seen
        share = SAMPLE_PERIOD / (SAMPLE_PERIOD + VELOCITY_LAG)
        self._velocity += share * ((seen - before) / SAMPLE_PERIOD - self._velocity)
        self._seen = seen
        wanted = drive.kp * (drive.reference[k] - seen) - drive.kd * self._velocity
        self.command = min(max(drive.feed_forward[k] + wanted, -drive.peak), drive.peak)

    def act(self, _theta: float, v: float, load: float) -> None:
        """Sets the torque of the next step, and the friction `dry` behind the gear [N.m]."""
        self.torque += self._share * (self._dead(self.command) - self.torque)
        self.late = self._late(self.torque)
        gear = self._motor.gear
        self.dry = gear * self._motor.friction.budget(v, self.torque, load / gear)


class _Physics:
    """A joint in MuJoCo."""

    def __init__(self, joint: DrawnJoint) -> None:
        import mujoco  # imported here, because drawing a joint needs no MuJoCo

        self._engine = mujoco
        self._model = mujoco.MjModel.from_xml_string(_mjcf(joint))
        self._data: Any = mujoco.MjData(self._model)
        self._probe: Any = mujoco.MjData(self._model)
        self._theta, self._phi = (
            [int(self._model.joint(f"{name}_{i}").dofadr[0]) for i in range(len(joint.motors))]
            for name in ("theta", "phi")
        )
        self._at = self._theta[joint.observed], self._phi[joint.observed]
        self._travel = joint.tendons.travel if joint.tendons else 0.0
        self._slider = int(self._model.joint("slider").dofadr[0]) if joint.tendons else -1
        self._data.qpos[self._theta] = joint.start
        mujoco.mj_forward(self._model, self._data)

    def motors(self) -> list[tuple[float, float, float]]:
        """Position, velocity and load of each motor, behind its gear [rad, rad/s, N.m]."""
        x, v, d = self._data.qpos, self._data.qvel, self._data
        return [
            (float(x[i]), float(v[i]), -float(d.qfrc_spring[j]) - float(d.qfrc_damper[j]))
            for i, j in zip(self._theta, self._phi, strict=True)
        ]

    def advance(self, axes: list[_Axis], target: float) -> None:
        """One step with the torques and the largest friction of the axes of the motors.

        target  where the stiffness motor shall be, if there is one [rad]
        """
        data = self._data
        data.ctrl[: len(axes)] = [axis.torque for axis in axes]
        self._model.dof_frictionloss[self._theta] = [axis.dry for axis in axes]
        if self._travel:
            data.ctrl[-1] = self._travel * target
        self._probe.qpos[:], self._probe.qvel[:] = data.qpos, data.qvel
        self._engine.mj_step(self._model, data)

    def instant(self) -> dict[str, float]:
        """Returns the state of the observed joint at the start of the last step of `advance`."""
        data, x, (i, j) = self._data, self._probe.qpos, self._at
        return {
            "theta": float(x[i]),
            "phi": float(x[j]),
            "theta_dot": float(self._probe.qvel[i]),
            "theta_c": float(x[self._slider]) / self._travel if self._travel else 0.0,
            "theta_ddot": float(data.qacc[i]),
            # A contact acts on both hinges, which have one axis; dry friction is of the motor.
            "friction": float(data.qfrc_constraint[i] - data.qfrc_constraint[j]),
            "damper": -float(data.qfrc_damper[j]),
            "tau_e": -float(data.qfrc_spring[j]),
            "stiffness": self._slope(j),
        }

    def _slope(self, dof: int) -> float:
        """Computes the slope of the motor torque by central differences of phi in the model."""
        probe, phi = self._probe, float(self._probe.qpos[dof])
        torque = []
        for side in (1, -1):
            probe.qpos[dof] = phi + side * DIFFERENCE
            self._engine.mj_fwdPosition(self._model, probe)
            self._engine.mj_fwdVelocity(self._model, probe)
            torque.append(-float(probe.qfrc_spring[dof]))
        return (torque[0] - torque[1]) / (2 * DIFFERENCE)


def _mjcf(joint: DrawnJoint) -> str:
    """Builds the MuJoCo model, with an actuator for each motor and for the slider of tendons."""
    values: dict[str, float] = {}
    if tendons := joint.tendons:
        behind = 0.05 + tendons.tension / tendons.stiffness  # from eyelet to slider [m]
        kp = SERVO * tendons.stiffness
        values = {
            "side": tendons.lever * math.sin(tendons.spread),
            "up": tendons.lever * math.cos(tendons.spread),
            "behind": behind,
            "rest": tendons.length(tendons.spread) + behind - tendons.tension / tendons.stiffness,
            "kp": kp,
            "kv": DAMPED * math.sqrt(kp * SLIDER_ARMATURE),
        }
    constants = {"STEP": STEP, "FLANGE": FLANGE, "TIP": TIP}
    constants |= {"SLIDER_MASS": SLIDER_MASS, "SLIDER_ARMATURE": SLIDER_ARMATURE}
    template = environment(Path(__file__).parent).get_template("joint.xml")
    return template.render(joint=joint, tendons=joint.tendons, **constants, **values)
