"""Estimates from what a method computed."""

from __future__ import annotations

import numpy as np

from rivals.records import Array, Estimate, JointLog

CONFIDENT = 0.1
"""A rival is confident while its standard deviation is below this share of a positive stiffness, as
FilteredRegression is at most."""


def answer(log: JointLog, stiffness: Array, std: Array, seconds: float) -> Estimate:
    """The estimate of a method that claims a standard deviation.

    What is known of the gain of the torque is added to it: the stiffness is proportional to it.

    stiffness, std  at every sample [N.m/rad]
    seconds         wall time
    """
    std = np.hypot(std, log.known.relative_std_gain * stiffness)
    confident = np.isfinite(stiffness) & np.isfinite(std) & (std < CONFIDENT * stiffness)
    return Estimate(stiffness, std, confident, seconds)


def no_answer(log: JointLog, seconds: float, reason: str) -> Estimate:
    """The estimate of a method that has none for this log."""
    nothing = np.full(len(log.theta), np.nan)
    return Estimate(nothing, nothing, np.zeros(len(log.theta), bool), seconds, reason)
