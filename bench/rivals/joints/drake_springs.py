"""Drake: a joint whose stiffness a second motor sets, by where two linear springs end.

As `mujoco_tendons`, but without the eyelet: each spring runs straight from the lever on the flange
to the slider, which is at the radius of the eyelet when the stiffness motor is at 0. So the slider
changes the lever arm, too. They are LinearSpringDampers between points of bodies; the torque and
its slope are asked from Drake, from a copy of the joint that has no gravity.
"""

from __future__ import annotations

import math

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    LinearSpringDamper,
    MultibodyForces,
    PrismaticJoint,
    RotationalInertia,
    SpatialInertia,
)
from pydrake.systems.framework import DiagramBuilder

from rivals.joints.drake_engine import DrakePhysics
from rivals.joints.drake_engine import joint as add_joint
from rivals.joints.parameters import VariableStiffness
from rivals.joints.simulation import STEP, Instant, Run, run

SLIDER_MASS = 0.1  # [kg]
SLIDER_ARMATURE = 5.0  # of its screw and motor [kg]
SERVO = 40.0  # stiffness of the servo of the slider, by that of a spring
DAMPED = 1.4  # damping of that servo, by the geometric mean of its stiffness and armature
DIFFERENCE = 1e-6  # of phi, for the slope of the torque [rad]


def _build(joint: VariableStiffness, plant: MultibodyPlant, gravity: float) -> None:
    """Adds the joint to a plant, and finishes it."""
    tendons = joint.tendons
    world = plant.world_frame()
    flange, link, _ = add_joint(plant, 0, world, joint.motor, tendons.damping, joint.link)
    small = RotationalInertia(1e-5, 1e-5, 1e-5)
    inertia = SpatialInertia.MakeFromCentralInertia(SLIDER_MASS, np.zeros(3), small)
    slider = plant.AddRigidBody("slider", inertia)
    along = PrismaticJoint(
        "slider", link.body_frame(), slider.body_frame(), np.array([0.0, 0.0, -1.0])
    )
    motor = plant.AddJointActuator("slider", plant.AddJoint(along))
    motor.set_default_rotor_inertia(SLIDER_ARMATURE)
    length = tendons.length(tendons.spread) - tendons.tension / tendons.stiffness
    for side in (-1, 1):
        at = tendons.lever * np.array(
            [side * math.sin(tendons.spread), 0.0, -math.cos(tendons.spread)]
        )
        plant.AddForceElement(
            LinearSpringDamper(flange, at, slider, np.zeros(3), length, tendons.stiffness, 0.0)
        )
    plant.mutable_gravity_field().set_gravity_vector(np.array([0.0, 0.0, -gravity]))
    plant.Finalize()


class _Pair:
    """Implements `drake_engine.Elastic`; `x` is the radius at which the slider is [m]."""

    def __init__(self, joint: VariableStiffness, step: float) -> None:
        self.damping = joint.tendons.damping
        self.x = joint.tendons.eyelet
        self._plant = MultibodyPlant(step)
        _build(joint, self._plant, gravity=0.0)
        self._context = self._plant.CreateDefaultContext()
        self._forces = MultibodyForces(self._plant)
        self._phi = self._plant.GetJointByName("phi_0")
        self._slider = self._plant.GetJointByName("slider")

    def torque(self, phi: float) -> float:
        """On the motor at rest [N.m]."""
        self._phi.set_angle(self._context, phi)
        self._slider.set_translation(self._context, self.x)
        self._plant.CalcForceElementsContribution(self._context, self._forces)
        torques = self._plant.CalcGeneralizedForces(self._context, self._forces)
        return -float(torques[self._phi.velocity_start()])

    def slope(self, phi: float) -> float:
        """Of the torque [N.m/rad]."""
        return (self.torque(phi + DIFFERENCE) - self.torque(phi - DIFFERENCE)) / (2 * DIFFERENCE)


class _Physics(DrakePhysics):
    """With a stiffness motor."""

    def __init__(self, joint: VariableStiffness, step: float) -> None:
        builder = DiagramBuilder()
        plant = builder.AddSystem(MultibodyPlant(step))
        _build(joint, plant, joint.gravity)
        self._tendons, self._pair = joint.tendons, _Pair(joint, step)
        self._slider = plant.GetJointByName("slider")
        self._slider.set_default_translation(joint.tendons.eyelet)
        super().__init__(builder.Build(), plant, [joint.motor], [self._pair])
        self._radius = joint.tendons.eyelet

    def _others(self, target: float) -> list[float]:
        """The force of the servo, which holds the slider where `target` [rad] says."""
        self._radius = self._pair.x
        kp = SERVO * self._tendons.stiffness
        kd = DAMPED * math.sqrt(kp * SLIDER_ARMATURE)
        wanted = self._tendons.eyelet + self._tendons.travel * target
        speed = float(self._slider.get_translation_rate(self._context))
        return [kp * (wanted - self._pair.x) - kd * speed]

    def _state(self) -> list[tuple[float, float, float, float, float]]:
        self._pair.x = float(self._slider.get_translation(self._context))
        return super()._state()

    def instant(self) -> Instant:
        """The beginning of the step that `advance` made."""
        after, self._pair.x = self._pair.x, self._radius
        now = super().instant()
        self._pair.x = after
        return now._replace(theta_c=(self._radius - self._tendons.eyelet) / self._tendons.travel)


def simulate(joint: VariableStiffness, step: float = STEP) -> Run:
    """Its signals; `step` [s] is that of Drake."""
    physics = _Physics(joint, step)
    return run(
        physics,
        [joint.motor],
        [joint.drive],
        [joint.instruments],
        theta_c=joint.theta_c,
        step=step,
    )
