"""MuJoCo: a joint whose stiffness a second motor sets, by the tension of two tendons.

The tendons are spatial: MuJoCo finds their lengths and lever arms, so the torque is no formula of
ours. They pull, and do not push. `parameters.Tendons` says how they run.
"""

from __future__ import annotations

import math

from rivals.joints.mujoco_engine import MujocoPhysics, flange, inertia, model
from rivals.joints.parameters import VariableStiffness
from rivals.joints.simulation import STEP, Run, run

SLIDER_MASS = 0.1  # [kg]
SLIDER_ARMATURE = 5.0  # of its screw and motor [kg]
SERVO = 40.0  # stiffness of the servo of the slider, by that of a tendon
DAMPED = 1.4  # damping of that servo, by the geometric mean of its stiffness and armature


def simulate(joint: VariableStiffness, step: float = STEP) -> Run:
    """Its signals; `step` [s] is that of MuJoCo."""
    tendons, motor = joint.tendons, joint.motor
    side, up = tendons.lever * math.sin(tendons.spread), tendons.lever * math.cos(tendons.spread)
    behind = 0.05 + tendons.tension / tendons.stiffness  # [m] from eyelet to slider
    end = tendons.eyelet + behind
    bodies = (
        f'<body>{flange(0, motor)}<site name="left" pos="{-side!r} 0 {-up!r}"/>'
        f'<site name="right" pos="{side!r} 0 {-up!r}"/>'
        f'<body><joint name="phi_0" axis="0 -1 0" damping="{tendons.damping!r}"/>'
        f'{inertia(joint.link)}<site name="eyelet" pos="0 0 {-tendons.eyelet!r}"/>'
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
    mjcf = model(bodies, [motor], joint.gravity, step, f"<tendon>{pulls}</tendon>{servo}")
    physics = MujocoPhysics(mjcf, [motor], travel=tendons.travel)
    return run(
        physics,
        [motor],
        [joint.drive],
        [joint.instruments],
        theta_c=joint.theta_c,
        step=step,
    )
