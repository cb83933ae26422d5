"""What the page starts from: the guess of `init`."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from sigmahat.fmi.opened import installed
from sigmahat.guessing import template
from sigmahat.guessing.columns import read_columns
from sigmahat.guessing.guess import JointGuess, guess_chosen, guess_of
from sigmahat.logs.log import Log
from sigmahat.page.setup import Chosen


def guessed(log: Log) -> tuple[Mapping[str, JointGuess], Mapping[str, str], Chosen]:
    """The joints of a log, the configuration of each as `init` writes it, and what guesses units,
    signs and gear of columns that somebody chooses.
    """
    columns = read_columns(log)
    joints = guess_of(columns, log)
    fmu = installed("StiffnessEstimator")
    motor = {n: float(fmu.variable(n).start) for n in ("motor.B", "motor.D_theta")}
    templates = {name: template.write(log, joint, motor) for name, joint in joints.items()}
    return joints, templates, partial(guess_chosen, columns)
