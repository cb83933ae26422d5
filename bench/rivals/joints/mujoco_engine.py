"""A model of MuJoCo, stepped by hand: what the joints in MuJoCo have in common.

Motor i is the hinge theta_i, with an actuator of the same name; its spring is on the hinge phi_i of
the body behind it, so that q = theta + phi. Armature, damping, dry friction (a constraint, whose
limit is set at every step), springs, tendons, contact and integration are MuJoCo's.
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco

from rivals.joints.parameters import FLANGE, Link, Motor
from rivals.joints.simulation import Instant

DIFFERENCE = 1e-6  # of phi, for the slope of the torque [rad]


def model(bodies: str, motors: Sequence[Motor], gravity: float, step: float, more: str = "") -> str:
    """MJCF of these bodies, with an actuator for each motor; `more` stands beside the world."""
    actuators = "".join(
        f'<motor name="theta_{i}" joint="theta_{i}" gear="{motor.gear!r}"/>'
        for i, motor in enumerate(motors)
    )
    return (
        f'<mujoco><compiler angle="radian"/>'
        f'<option timestep="{step!r}" integrator="implicitfast" gravity="0 0 {-gravity!r}"/>'
        f"<worldbody>{bodies}</worldbody><actuator>{actuators}</actuator>{more}</mujoco>"
    )


def flange(i: int, motor: Motor) -> str:
    """What stands in the body of a motor's flange: hinge and inertia."""
    body = FLANGE * motor.inertia
    return (
        f'<joint name="theta_{i}" axis="0 -1 0" armature="{motor.inertia - body!r}"'
        f' damping="{motor.D * motor.gear**2!r}"'
        f' frictionloss="{motor.gear * motor.friction.at_rest!r}"'
        f' solreffriction="{motor.stiction_time!r} 1"/>'
        f'<inertial pos="0 0 0" mass="1e-6" diaginertia="{body!r} {body!r} {body!r}"/>'
    )


def inertia(link: Link) -> str:
    """Mass of a link that hangs down at q = 0."""
    turning = f"{link.inertia!r} {link.inertia!r} {link.inertia!r}"
    return f'<inertial pos="0 0 {-link.centre!r}" mass="{link.mass!r}" diaginertia="{turning}"/>'


class MujocoPhysics:
    """Implements `simulation.Physics`."""

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

    @property
    def data(self) -> mujoco.MjData:
        """State and results of MuJoCo."""
        return self._data

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
        """One step; the torques are on the axes of the motors."""
        data = self._data
        for k, i in enumerate(self._theta):
            data.ctrl[k] = torques[k]
            self._model.dof_frictionloss[i] = self._gears[k] * dry[k]
        if self._travel is not None:
            data.ctrl[-1] = self._travel * target
            self._theta_c = float(data.qpos[self._slider]) / self._travel
        i, j = self._theta[self._observed], self._phi[self._observed]
        self._before = (
            float(data.qpos[i]),
            float(data.qpos[j]),
            float(data.qvel[i]),
            float(data.qvel[j]),
        )
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
