"""Drake: two links under gravity, a flexible joint in each, and a floor that the tip touches."""

from __future__ import annotations

import numpy as np
from pydrake.geometry import Box, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction
from pydrake.multibody.tree import FixedOffsetFrame
from pydrake.systems.framework import DiagramBuilder

from rivals.joints.drake_engine import DrakePhysics, flexible_joint
from rivals.joints.parameters import Arm
from rivals.joints.simulation import STEP, Run, run

RUBBING = 0.6  # friction of tip and floor
THICK = 1.0  # the floor [m]


def simulate(arm: Arm, step: float = STEP) -> Run:
    """Signals of the observed joint; `step` [s] is that of Drake."""
    if any(spring.k_3 != 0 for spring in arm.springs):
        raise ValueError("expected linear springs, received one with k_3: Drake's are linear")
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, step)
    upper = flexible_joint(
        plant, 0, plant.world_frame(), arm.motors[0], arm.springs[0], arm.links[0]
    )
    elbow = plant.AddFrame(
        FixedOffsetFrame("elbow", upper.body_frame(), _below(arm.links[0].length))
    )
    lower = flexible_joint(plant, 1, elbow, arm.motors[1], arm.springs[1], arm.links[1])
    friction = CoulombFriction(RUBBING, RUBBING)
    tip = _below(arm.links[1].length)
    plant.RegisterCollisionGeometry(lower, tip, Sphere(arm.tip), "tip", friction)
    floor = _below(THICK / 2 - arm.floor)
    slab = Box(10.0, 10.0, THICK)
    plant.RegisterCollisionGeometry(plant.world_body(), floor, slab, "floor", friction)
    plant.mutable_gravity_field().set_gravity_vector(np.array([0.0, 0.0, -arm.gravity]))
    plant.Finalize()
    physics = DrakePhysics(builder.Build(), plant, arm.motors, arm.springs, arm.observed)
    physics.place(arm.start)
    return run(physics, arm.motors, arm.drives, arm.instruments, arm.observed, step=step)


def _below(distance: float) -> RigidTransform:
    return RigidTransform(np.array([0.0, 0.0, -distance]))
