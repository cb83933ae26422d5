"""The joints as models of MuJoCo, stepped by hand.

Motor i is the hinge theta_i, with an actuator of the same name; its spring is on the hinge phi_i of
the body behind it, so that q = theta + phi. Armature, damping, dry friction (a constraint, whose
limit is set at every step), springs, tendons, contact and integration are MuJoCo's. The tendons are
spatial: MuJoCo finds their lengths and lever arms, so their torque is no formula of ours. They
pull, and do not push; `parameters.Tendons` says how they run.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import mujoco

from rivals.joints.parameters import (
    FLANGE,
    Arm,
    Joint,
    Link,
    Motor,
    SeriesElastic,
    Spring,
    VariableStiffness,
)

DIFFERENCE = 1e-6  # of phi, for the slope of the torque [rad]
SLIDER_MASS = 0.1  # [kg]
SLIDER_ARMATURE = 5.0  # of its screw and motor [kg]
SERVO = 40.0  # stiffness of the servo of the slider, by that of a tendon
DAMPED = 1.4  # damping of that servo, by the geometric mean of its stiffness and armature


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


def build(joint: Joint, step: float) -> Physics:
    """The physics of a joint; `step` [s] is that of MuJoCo."""
    if isinstance(joint, VariableStiffness):
        return _tendons(joint, step)
    assert isinstance(joint, SeriesElastic)
    if isinstance(joint, Arm):
        bodies = (
            f'<geom type="plane" pos="0 0 {joint.floor!r}" size="5 5 1"/>'
            f"<body>{_flange(0, joint.motors[0])}<body>{_link(joint, 0)}"
            f'<body pos="0 0 {-joint.links[0].length!r}">{_flange(1, joint.motors[1])}'
            f"<body>{_link(joint, 1)}"
            f'<geom type="sphere" size="{joint.tip!r}" pos="0 0 {-joint.links[1].length!r}"/>'
            "</body></body></body></body>"
        )
    else:
        bodies = f"<body>{_flange(0, joint.motors[0])}<body>{_link(joint, 0)}</body></body>"
    physics = Physics(_model(bodies, joint, step), joint.motors, joint.observed)
    if isinstance(joint, Arm):
        physics.place(joint.start)
    return physics


def _link(joint: SeriesElastic, i: int) -> str:
    spring: Spring = joint.springs[i]
    return (
        f'<joint name="phi_{i}" axis="0 -1 0" stiffness="{spring.stiffness!r} 0 {spring.k_3!r}"'
        f' damping="{spring.damping!r}"/>{_inertia(joint.links[i])}'
    )


def _tendons(joint: VariableStiffness, step: float) -> Physics:
    tendons, (motor,) = joint.tendons, joint.motors
    side, up = tendons.lever * math.sin(tendons.spread), tendons.lever * math.cos(tendons.spread)
    behind = 0.05 + tendons.tension / tendons.stiffness  # [m] from eyelet to slider
    end = tendons.eyelet + behind
    bodies = (
        f'<body>{_flange(0, motor)}<site name="left" pos="{-side!r} 0 {-up!r}"/>'
        f'<site name="right" pos="{side!r} 0 {-up!r}"/>'
        f'<body><joint name="phi_0" axis="0 -1 0" damping="{tendons.damping!r}"/>'
        f'{_inertia(joint.links[0])}<site name="eyelet" pos="0 0 {-tendons.eyelet!r}"/>'
        f'<body pos="0 0 {-end!r}"><inertial pos="0 0 0" mass="{SLIDER_MASS!r}"'
        ' diaginertia="1e-5 1e-5 1e-5"/><site name="slider"/>'
        f'<joint name="slider" type="slide" axis="0 0 -1" armature="{SLIDER_ARMATURE!r}"/>'
        "</body></body></body>"
    )
    rest = tendons.length(tendons.spread) + behind - tendons.tension / tendons.stiffness
    pulls = "".join(
        f'<spatial stiffness="{tendons.stiffness!r}" springlength="0 {rest!r}">'
        f'<site site="{end}"/><site site="eyelet"/><site site="slider"/></spatial>'
        for end in ("left", "right")
    )
    kp = SERVO * tendons.stiffness
    kv = DAMPED * math.sqrt(kp * SLIDER_ARMATURE)
    servo = f'<actuator><position joint="slider" kp="{kp!r}" kv="{kv!r}"/></actuator>'
    mjcf = _model(bodies, joint, step, f"<tendon>{pulls}</tendon>{servo}")
    return Physics(mjcf, joint.motors, travel=tendons.travel)


def _model(bodies: str, joint: Joint, step: float, more: str = "") -> str:
    """MJCF of these bodies, with an actuator for each motor; `more` stands beside the world."""
    actuators = "".join(
        f'<motor name="theta_{i}" joint="theta_{i}" gear="{motor.gear!r}"/>'
        for i, motor in enumerate(joint.motors)
    )
    return (
        f'<mujoco><compiler angle="radian"/>'
        f'<option timestep="{step!r}" integrator="implicitfast" gravity="0 0 {-joint.gravity!r}"/>'
        f"<worldbody>{bodies}</worldbody><actuator>{actuators}</actuator>{more}</mujoco>"
    )


def _flange(i: int, motor: Motor) -> str:
    """What stands in the body of a motor's flange: hinge and inertia."""
    body = FLANGE * motor.inertia
    return (
        f'<joint name="theta_{i}" axis="0 -1 0" armature="{motor.inertia - body!r}"'
        f' damping="{motor.D * motor.gear**2!r}"'
        f' frictionloss="{motor.gear * motor.friction.at_rest!r}"'
        f' solreffriction="{motor.stiction_time!r} 1"/>'
        f'<inertial pos="0 0 0" mass="1e-6" diaginertia="{body!r} {body!r} {body!r}"/>'
    )


def _inertia(link: Link) -> str:
    """Mass of a link that hangs down at q = 0."""
    turning = f"{link.inertia!r} {link.inertia!r} {link.inertia!r}"
    return f'<inertial pos="0 0 {-link.centre!r}" mass="{link.mass!r}" diaginertia="{turning}"/>'


class Physics:
    """A joint in MuJoCo."""

    def __init__(
        self, mjcf: str, motors: Sequence[Motor], observed: int = 0, travel: float | None = None
    ) -> None:
        """With `travel` [m/rad], the model has a joint slider, moved by a last actuator."""
        self._model = mujoco.MjModel.from_xml_string(mjcf)
        self._data = mujoco.MjData(self._model)
        self._probe = mujoco.MjData(self._model)
        self._gears = [motor.gear for motor in motors]
        names = range(len(motors))
        self._theta = [int(self._model.joint(f"theta_{i}").dofadr[0]) for i in names]
        self._phi = [int(self._model.joint(f"phi_{i}").dofadr[0]) for i in names]
        self._observed = observed
        self._travel = travel
        self._slider = -1 if travel is None else int(self._model.joint("slider").dofadr[0])
        self._theta_c = 0.0
        self._before: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)

    def place(self, angles: Sequence[float]) -> None:
        """Turns the motors to these angles [rad], at rest, with no deformation."""
        for dof, angle in zip(self._theta, angles, strict=True):
            self._data.qpos[dof] = angle
        mujoco.mj_forward(self._model, self._data)

    def motors(self) -> list[tuple[float, float, float]]:
        """Position, velocity and load of each motor, behind its gear [rad, rad/s, N.m]."""
        x, v, d = self._data.qpos, self._data.qvel, self._data
        return [
            (float(x[i]), float(v[i]), -float(d.qfrc_spring[j]) - float(d.qfrc_damper[j]))
            for i, j in zip(self._theta, self._phi, strict=True)
        ]

    def advance(self, torques: Sequence[float], dry: Sequence[float], target: float) -> None:
        """One step with these torques, and at most this friction, on the axes of the motors.

        target  where the stiffness motor shall be, if there is one [rad]
        """
        data = self._data
        for k, i in enumerate(self._theta):
            data.ctrl[k] = torques[k]
            self._model.dof_frictionloss[i] = self._gears[k] * dry[k]
        if self._travel is not None:
            data.ctrl[-1] = self._travel * target
            self._theta_c = float(data.qpos[self._slider]) / self._travel
        i, j = self._theta[self._observed], self._phi[self._observed]
        x, v = data.qpos, data.qvel
        self._before = float(x[i]), float(x[j]), float(v[i]), float(v[j])
        self._probe.qpos[:] = data.qpos
        mujoco.mj_step(self._model, data)

    def instant(self) -> Instant:
        """The beginning of the step that `advance` made."""
        data, j = self._data, self._phi[self._observed]
        return Instant(
            *self._before,
            theta_ddot=float(data.qacc[self._theta[self._observed]]),
            friction=self._friction(),
            damper=-float(data.qfrc_damper[j]),
            tau_e=-float(data.qfrc_spring[j]),
            stiffness=self._slope(j),
            theta_c=self._theta_c,
        )

    def _friction(self) -> float:
        """Dry friction on the observed motor; contacts are constraints, too."""
        data, dof = self._data, self._theta[self._observed]
        dry = mujoco.mjtConstraint.mjCNSTR_FRICTION_DOF
        rows = range(data.nefc)
        return sum(
            float(data.efc_force[row])
            for row in rows
            if data.efc_type[row] == dry and data.efc_id[row] == dof
        )

    def _slope(self, dof: int) -> float:
        """Of the torque on the motor, by central differences of phi in the model itself."""
        probe, phi = self._probe, float(self._probe.qpos[dof])
        torque = []
        for side in (1, -1):
            probe.qpos[dof] = phi + side * DIFFERENCE
            mujoco.mj_fwdPosition(self._model, probe)
            mujoco.mj_fwdVelocity(self._model, probe)
            torque.append(-float(probe.qfrc_spring[dof]))
        return (torque[0] - torque[1]) / (2 * DIFFERENCE)
