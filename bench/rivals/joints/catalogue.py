"""Every joint of the comparison by kind and seed.

Nobody tunes on the seeds of docs/rivals.md, 9001 to 9040: they were fixed in the commit that
brought the joints, before any method saw one of them. The seeds of a second look are 9101 to 9140,
fixed before they were run, too. All other seeds are for development.
"""

from __future__ import annotations

import numpy as np

from rivals.joints import draw
from rivals.joints.logs import log
from rivals.joints.parameters import Joint
from rivals.joints.simulation import run
from rivals.records import JointLog

KINDS = ("series_elastic", "variable_stiffness", "arm")
_DRAW = (draw.series_elastic, draw.variable_stiffness, draw.arm)


def drawn(kind: str, seed: int) -> Joint:
    """A joint; no two kinds share random numbers."""
    place = KINDS.index(kind)
    return _DRAW[place](np.random.default_rng([seed, place, 0]))


def make(kind: str, seed: int) -> JointLog:
    """The log of a joint: one of KINDS."""
    joint = drawn(kind, seed)
    noise = np.random.default_rng([seed, KINDS.index(kind), 0, 1])
    return log(kind, seed, run(joint), joint, noise)
