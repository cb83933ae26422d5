"""A multibody plant of Drake, stepped by hand: what the joints in Drake have in common.

Motor i is the revolute joint theta_i; its actuator has the inertia of the rotor and the gear ratio,
which Drake reflects. Its spring is a RevoluteSpring on the joint phi_i of the body behind it, so
that q = theta + phi. Inertia, damping, springs, contact and integration (in discrete time) are
Drake's.

Drake has no dry friction in joints. Here it is the rule of the authors of the friction models: the
torque that would stop the motor within the step, cut off at what friction can do.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    Frame,
    RevoluteJoint,
    RevoluteSpring,
    RigidBody,
    RotationalInertia,
    SpatialInertia,
)
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Diagram

from rivals.joints.parameters import FLANGE, Link, Motor, Spring
from rivals.joints.simulation import Instant

AXIS = np.array([0.0, -1.0, 0.0])
LIGHT = 1e-6  # mass of a flange [kg]


class Elastic(Protocol):
    """What is between a motor and its link."""

    @property
    def damping(self) -> float:
        """[N.m.s/rad]"""

    def torque(self, phi: float) -> float:
        """On the motor at rest [N.m]."""

    def slope(self, phi: float) -> float:
        """Of the torque [N.m/rad]."""


def flexible_joint(
    plant: MultibodyPlant, i: int, parent: Frame, motor: Motor, spring: Spring, link: Link
) -> RigidBody:
    """Adds a motor, a spring and a link behind a frame; the link, which hangs down at q = 0."""
    _, body, phi = joint(plant, i, parent, motor, spring.damping, link)
    plant.AddForceElement(RevoluteSpring(phi, 0.0, spring.stiffness))
    return body


def joint(
    plant: MultibodyPlant, i: int, parent: Frame, motor: Motor, damping: float, link: Link
) -> tuple[RigidBody, RigidBody, RevoluteJoint]:
    """Adds the same without a spring: the flange, the link, and the joint between them."""
    turning = FLANGE * motor.inertia
    flange = plant.AddRigidBody(f"flange_{i}", _inertia(LIGHT, 0.0, turning))
    body = plant.AddRigidBody(f"link_{i}", _inertia(link.mass, link.centre, link.inertia))
    theta = plant.AddJoint(
        RevoluteJoint(f"theta_{i}", parent, flange.body_frame(), AXIS, motor.D * motor.gear**2)
    )
    phi = plant.AddJoint(
        RevoluteJoint(f"phi_{i}", flange.body_frame(), body.body_frame(), AXIS, damping)
    )
    actuator = plant.AddJointActuator(f"theta_{i}", theta)
    actuator.set_default_rotor_inertia((1 - FLANGE) * motor.B)
    actuator.set_default_gear_ratio(motor.gear)
    return flange, body, phi


def _inertia(mass: float, centre: float, turning: float) -> SpatialInertia:
    at = np.array([0.0, 0.0, -centre])
    central = RotationalInertia(turning, turning, turning)
    return SpatialInertia.MakeFromCentralInertia(mass, at, central)


class DrakePhysics:
    """Implements `simulation.Physics` with a plant of such joints."""

    def __init__(
        self,
        diagram: Diagram,
        plant: MultibodyPlant,
        motors: Sequence[Motor],
        springs: Sequence[Elastic],
        observed: int = 0,
    ) -> None:
        self._simulator = Simulator(diagram)
        self._context = plant.GetMyMutableContextFromRoot(self._simulator.get_mutable_context())
        self._plant, self._motors, self._springs = plant, motors, springs
        self._step = plant.time_step()
        self._steps = 0
        nothing = np.zeros(plant.num_actuators())
        self._actuation = plant.get_actuation_input_port().FixValue(self._context, nothing)
        self._observed = observed
        names = range(len(motors))
        positions = plant.num_positions()
        self._x = [
            (
                plant.GetJointByName(f"theta_{i}").position_start(),
                plant.GetJointByName(f"phi_{i}").position_start(),
                positions + plant.GetJointByName(f"theta_{i}").velocity_start(),
                positions + plant.GetJointByName(f"phi_{i}").velocity_start(),
            )
            for i in names
        ]
        self._now = self._state()
        self._before = self._now
        self._friction = [0.0] * len(motors)

    def place(self, angles: Sequence[float]) -> None:
        """Turns the motors to these angles [rad], at rest, with no deformation."""
        state = self._plant.GetPositionsAndVelocities(self._context)
        for (theta, _, _, _), angle in zip(self._x, angles, strict=True):
            state[theta] = angle
        self._plant.SetPositionsAndVelocities(self._context, state)
        self._now = self._state()

    def _state(self) -> list[tuple[float, float, float, float, float]]:
        """theta, phi, their velocities, and the load of the motor, for each joint."""
        state = self._plant.GetPositionsAndVelocities(self._context).tolist()
        now = []
        for indices, spring in zip(self._x, self._springs, strict=True):
            theta, phi, v, phi_dot = (state[i] for i in indices)
            now.append((theta, phi, v, phi_dot, spring.torque(phi) + spring.damping * phi_dot))
        return now

    def motors(self) -> list[tuple[float, float, float]]:
        """Position, velocity and load of each motor, behind its gear [rad, rad/s, N.m]."""
        return [(theta, v, load) for theta, _, v, _, load in self._now]

    def advance(self, torques: Sequence[float], dry: Sequence[float], target: float) -> None:
        """One step; the torques are on the axes of the motors, `target` is for a subclass."""
        applied = []
        for i, (motor, (_, v, load)) in enumerate(zip(self._motors, self.motors(), strict=True)):
            driving = motor.gear * torques[i] + load - motor.D * motor.gear**2 * v
            stops = -(motor.inertia / self._step * v + driving)
            most = motor.gear * dry[i]
            self._friction[i] = min(max(stops, -most), most)
            applied.append(motor.gear * torques[i] + self._friction[i])
        applied += self._others(target)
        self._actuation.GetMutableData().get_mutable_value().SetFromVector(applied)
        self._steps += 1
        self._simulator.AdvanceTo(self._steps * self._step)
        self._before, self._now = self._now, self._state()

    def _others(self, target: float) -> list[float]:
        """What actuators other than the motors do, in the order in which they were added."""
        return []

    def instant(self) -> Instant:
        """The beginning of the step that `advance` made."""
        i = self._observed
        theta, phi, v, phi_dot, load = self._before[i]
        damper = self._springs[i].damping * phi_dot
        return Instant(
            theta=theta,
            phi=phi,
            theta_dot=v,
            phi_dot=phi_dot,
            theta_ddot=(self._now[i][2] - v) / self._step,
            friction=self._friction[i],
            damper=damper,
            tau_e=load - damper,
            stiffness=self._springs[i].slope(phi),
            theta_c=0.0,
        )
