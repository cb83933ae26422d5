"""MuJoCo: two links under gravity, a flexible joint in each, and a floor that the tip touches."""

from __future__ import annotations

from rivals.joints.mujoco_engine import MujocoPhysics, flange, inertia, model
from rivals.joints.parameters import Arm
from rivals.joints.simulation import STEP, Run, run


def simulate(arm: Arm, step: float = STEP) -> Run:
    """Signals of the observed joint; `step` [s] is that of MuJoCo."""
    bodies = (
        f'<geom type="plane" pos="0 0 {arm.floor!r}" size="5 5 1"/>'
        f"<body>{flange(0, arm.motors[0])}<body>{_link(arm, 0)}"
        f'<body pos="0 0 {-arm.links[0].length!r}">{flange(1, arm.motors[1])}'
        f"<body>{_link(arm, 1)}"
        f'<geom type="sphere" size="{arm.tip!r}" pos="0 0 {-arm.links[1].length!r}"/>'
        "</body></body></body></body>"
    )
    physics = MujocoPhysics(model(bodies, arm.motors, arm.gravity, step), arm.motors, arm.observed)
    physics.place(arm.start)
    return run(physics, arm.motors, arm.drives, arm.instruments, arm.observed, step=step)


def _link(arm: Arm, i: int) -> str:
    spring = arm.springs[i]
    return (
        f'<joint name="phi_{i}" axis="0 -1 0" stiffness="{spring.stiffness!r} 0 {spring.k_3!r}"'
        f' damping="{spring.damping!r}"/>{inertia(arm.links[i])}'
    )
