"""Drake: a motor with gear, a linear spring, and a link."""

from __future__ import annotations

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import DiagramBuilder

from rivals.joints.drake_engine import DrakePhysics, flexible_joint
from rivals.joints.parameters import SeriesElastic
from rivals.joints.simulation import STEP, Run, run


def simulate(joint: SeriesElastic, step: float = STEP) -> Run:
    """Its signals; `step` [s] is that of Drake."""
    if joint.spring.k_3 != 0:
        raise ValueError("expected a linear spring, received one with k_3: Drake's are linear")
    builder = DiagramBuilder()
    plant = builder.AddSystem(MultibodyPlant(step))
    flexible_joint(plant, 0, plant.world_frame(), joint.motor, joint.spring, joint.link)
    plant.mutable_gravity_field().set_gravity_vector(np.array([0.0, 0.0, -joint.gravity]))
    plant.Finalize()
    physics = DrakePhysics(builder.Build(), plant, [joint.motor], [joint.spring])
    return run(physics, [joint.motor], [joint.drive], [joint.instruments], step=step)
