"""The answer of a log: the curve, and the measured points behind it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sigmahat.fmi.instance import Slave, Value
from sigmahat.joint.curve import Curve
from sigmahat.joint.records import LearnedLog
from sigmahat.logs.curve import curve
from sigmahat.logs.measured import MeasuredPoints, with_what_was_learned
from sigmahat.logs.sampling import Samples
from sigmahat.logs.statistics import ReplayStatistics


@dataclass(frozen=True)
class Answer:
    """What a replay found."""

    curve: Curve
    """Torque and stiffness over the deformation."""
    points: MeasuredPoints
    """That stand behind it."""


def answer(
    slave: Slave,
    every: Mapping[str, Value],
    logs: Sequence[LearnedLog],
    samples: Samples,
    statistics: ReplayStatistics,
) -> Answer:
    """The answer of a slave at the end of a replay; nothing is written.

    every  parameters of the slave
    logs   that it has learned from; samples and statistics are of the last one
    """
    method = str(every["method"])
    points = statistics.points(method)
    found = curve(slave, every, logs, points)
    if method == "FilteredRegression":
        points = with_what_was_learned(slave, every, samples)
    return Answer(found, points)
