"""Every joint of the comparison by kind, engine and seed.

The seeds were fixed in the commit that brought the joints, before any method saw one of them.
Nobody tunes on them: for development there are all other seeds, for instance 1 to 5.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from rivals.joints import draw
from rivals.joints.logs import log
from rivals.joints.parameters import Arm
from rivals.joints.simulation import STEP, Run
from rivals.records import JointLog

SEEDS = range(9001, 9041)

KINDS = ("series_elastic", "variable_stiffness", "arm")
ENGINES = ("mujoco",)
BUILDS = {
    ("series_elastic", "mujoco"): "mujoco_series_elastic",
    ("variable_stiffness", "mujoco"): "mujoco_tendons",
    ("arm", "mujoco"): "mujoco_arm",
}
"""The module that builds each kind in each engine."""


def rng(kind: str, engine: str, seed: int) -> np.random.Generator:
    """Each joint has random numbers of its own: no two kinds or engines share a draw."""
    return np.random.default_rng([seed, KINDS.index(kind), ENGINES.index(engine)])


def drawn(kind: str, engine: str, seed: int) -> Any:
    """Parameters of a joint."""
    numbers = rng(kind, engine, seed)
    if kind == "series_elastic":
        return draw.series_elastic(numbers)
    if kind == "variable_stiffness":
        return draw.variable_stiffness(numbers)
    return draw.arm(numbers)


def simulate(kind: str, engine: str, joint: Any, step: float = STEP) -> Run:
    """Signals of a joint without the errors of instruments. `step` [s] is that of the engine."""
    run: Run = import_module(f"rivals.joints.{BUILDS[kind, engine]}").simulate(joint, step)
    return run


def make(kind: str, engine: str, seed: int) -> JointLog:
    """The log of a joint: one of KINDS in one of ENGINES."""
    joint = drawn(kind, engine, seed)
    run = simulate(kind, engine, joint)
    motor, instruments = _observed(joint)
    noise = np.random.default_rng([seed, KINDS.index(kind), ENGINES.index(engine), 1])
    return log((kind, engine, seed), run, motor, instruments, joint.sheet, noise)


def _observed(joint: Any) -> Any:
    if isinstance(joint, Arm):
        return joint.motors[joint.observed], joint.instruments[joint.observed]
    return joint.motor, joint.instruments
