"""MuJoCo: a motor with gear, a spring that hardens or not, and a link."""

from __future__ import annotations

from rivals.joints.mujoco_engine import MujocoPhysics, flange, inertia, model
from rivals.joints.parameters import SeriesElastic
from rivals.joints.simulation import STEP, Run, run


def simulate(joint: SeriesElastic, step: float = STEP) -> Run:
    """Its signals; `step` [s] is that of MuJoCo."""
    spring, link = joint.spring, joint.link
    bodies = (
        f"<body>{flange(0, joint.motor)}<body>"
        f'<joint name="phi_0" axis="0 -1 0" stiffness="{spring.stiffness!r} 0 {spring.k_3!r}"'
        f' damping="{spring.damping!r}"/>{inertia(link)}</body></body>'
    )
    physics = MujocoPhysics(model(bodies, [joint.motor], joint.gravity, step), [joint.motor])
    return run(physics, [joint.motor], [joint.drive], [joint.instruments], step=step)
