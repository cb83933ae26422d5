"""Simulates the log of a motion of a joint, and its evaluation by `identify` and `estimate`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import tomlkit

from sigmahat.files.toml_file import set_dotted
from sigmahat.identification.identify import identify
from sigmahat.identification.write import update
from sigmahat.joint.curve import stiffness_in_the_middle
from sigmahat.logs.configuration import checked_configuration
from sigmahat.logs.estimate import estimate
from sigmahat.logs.log import LogError, LogInMemory
from sigmahat.motion.joints import Joint
from sigmahat.motion.multisine import Array, Multisine

NOISE = 0.003  # default noise of the torque: standard deviation divided by the limit of the torque


@dataclass(frozen=True)
class Sensors:
    """The sensors of a joint."""

    gear_ratio: float
    counts: tuple[float, float]
    """Counts of the encoders of motor and link, per turn at the gear output."""
    torque_gain: float  # relative standard deviation of the gain of the torque: prior.torque_gain
    noise: float  # noise of the torque of the motor at the gear output [N.m]
    T: float  # time between samples [s]


def relative_half_width(joint: Joint, motion: Multisine, sensors: Sensors) -> float:
    """Half of the 95 % interval of the stiffness in the middle, divided by the stiffness.

    `identify` and `estimate` evaluate a simulated log. Infinite if they refuse this log.
    """
    log = _log(joint, motion, sensors)
    document = tomlkit.document()
    document["ports"] = {name: {"column": name} for name in ("theta", "q", "tau")}
    document["parameters"] = parameters = tomlkit.table()
    for name, value in {
        "method": "FilteredRegression",
        "motor.gamma": sensors.gear_ratio,
        "samplePeriod": sensors.T,
        "encoder.theta": sensors.counts[0],
        "encoder.q": sensors.counts[1],
        "prior.torque_gain": sensors.torque_gain,
    }.items():
        set_dotted(parameters, name, tomlkit.item(value))
    configured = partial(checked_configuration, document, log.path)
    try:
        update(document, identify(log, configured()))
        curve = estimate(log, configured()).curve
    except LogError:
        return float("inf")
    if not curve.branches:
        return float("inf")
    _, sigma, interval = stiffness_in_the_middle(curve.branches[0])
    assert interval is not None  # FilteredRegression gives an interval
    return (interval[1] - interval[0]) / 2 / max(abs(sigma), 1e-300)


def _log(joint: Joint, motion: Multisine, sensors: Sensors) -> LogInMemory:
    theta, phi, torque = joint.move(motion, sensors.T)
    noise = sensors.noise * np.random.default_rng(1).standard_normal(len(theta))
    columns = {
        "theta": _rounded(theta, sensors.counts[0]),
        "q": _rounded(theta + phi, sensors.counts[1]),
        "tau": (torque + noise) / sensors.gear_ratio,
    }
    return LogInMemory(Path("motion"), columns)


def _rounded(angle: Array, counts: float) -> Array:
    if not counts:
        return angle
    step = 2 * np.pi / counts
    rounded: Array = step * np.round(angle / step)
    return rounded
