"""Whether two estimates of a stiffness agree, at the points of operation of a log."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sigmahat.joint.curve import NORMAL_95
from sigmahat.logs.log import Array


@dataclass(frozen=True)
class Agreement:
    """The stiffness that was learned before, beside that of a log alone."""

    before: tuple[float, float]
    """Median stiffness that was learned before, and of half the width of its interval [N.m/rad]."""
    alone: tuple[float, float]
    """The same of what the log alone gives."""
    alone_in_before: float
    """Share of the instants at which the interval of before holds what the log alone gives."""
    before_in_alone: float
    """The other way round."""
    overlap: float
    """Share of the instants at which both intervals overlap."""
    z: float
    """Difference over its standard deviation, root mean square over the instants."""
    agree: bool | None
    """Whether z is at most 1.96; None if an interval reaches down to 0 at half of the instants or
    more: then agreement would mean nothing."""


def agreement(
    before: Mapping[str, Array], alone: Mapping[str, Array], torque_gain: float
) -> Agreement:
    """Compares two estimates at the same points, logs.frozen.stiffness_at.

    torque_gain  relative standard deviation of the gain of the torque: it is one error of both, so
                 that it does not explain a difference
    """
    difference = alone["sigma"] - before["sigma"]
    halves = [NORMAL_95 * each["sigma_std"] for each in (before, alone)]
    by_gain = [torque_gain * e["sigma_per_gain"] * np.abs(e["sigma"]) for e in (before, alone)]
    own = [
        np.maximum(e["sigma_std"] ** 2 - g**2, 0.0)
        for e, g in zip((before, alone), by_gain, strict=True)
    ]
    std = np.sqrt(own[0] + own[1] + (by_gain[1] - by_gain[0]) ** 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(difference == 0, 0.0, difference / std)
    z = float(np.sqrt(np.mean(ratio**2)))
    says_nothing = any(
        np.median(half - np.abs(each["sigma"])) >= 0
        for half, each in zip(halves, (before, alone), strict=True)
    )
    return Agreement(
        before=(float(np.median(before["sigma"])), float(np.median(halves[0]))),
        alone=(float(np.median(alone["sigma"])), float(np.median(halves[1]))),
        alone_in_before=float(np.mean(np.abs(difference) <= halves[0])),
        before_in_alone=float(np.mean(np.abs(difference) <= halves[1])),
        overlap=float(np.mean(np.abs(difference) <= halves[0] + halves[1])),
        z=z,
        agree=None if says_nothing else bool(z <= NORMAL_95),
    )
