"""Compares one estimate with the first logs of a joint: a limit while the robot works."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import timedelta

import numpy as np

from sigmahat.health.change import contrast
from sigmahat.health.judge import FEWEST, Difference, probability_of, weighted_mean
from sigmahat.health.logs import JointLogs, LogResult
from sigmahat.health.quantities import Name, quantities
from sigmahat.result.sheet import Together

_MOST = 60  # more logs would only take time


@dataclass(frozen=True)
class Reference:
    """The first logs of a joint, with which an estimate is compared."""

    logs: Sequence[LogResult]

    @staticmethod
    def of(logs: JointLogs) -> "Reference":
        """Raises ValueError for fewer than FEWEST logs."""
        if len(logs.used) < FEWEST:
            raise ValueError(
                f"joint {logs.joint}: expected results of {FEWEST} logs or more for a limit, got "
                f"{len(logs.used)}; record more, and run `sigmahat health` again"
            )
        return Reference(logs.used[:_MOST])

    def compare(self, together: Together, limit: float) -> tuple[Difference, float] | None:
        """Returns the difference of a stiffness from that of the logs, of its logarithm, and the
        probability that it has passed a limit.

        limit  relative change; below 0 for a decrease

        The estimate scatters as a log does. Returns None if it cannot be compared: it does not
        reach the deformations of the logs, or does not show the gain of the torque that they show,
        or none of them shows a stiffness.
        """
        last = self.logs[-1]
        now = replace(last, time=last.time + timedelta(days=1), together=together)
        joint = JointLogs(last.joint, [*self.logs, now], ())
        for each in quantities(joint).every:
            series, now_at = each.series, len(each.series.values) - 1
            if each.name is not Name.STIFFNESS or each.logs[-1] != len(self.logs) or now_at < 1:
                continue
            first, _ = weighted_mean(series.part(0, now_at))
            size, std = contrast(series, now_at, now_at)
            std = float(np.hypot(std, series.common))
            difference = Difference(first, size, std, max(now_at - 1, 1))
            return difference, probability_of(each, difference, limit)
        return None
