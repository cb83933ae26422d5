"""Paper2011 of this package.

F. Flacco, A. De Luca, I. Sardellitti, N. G. Tsagarakis, "Robust estimation of variable stiffness
in flexible joints", Proc. IEEE/RSJ IROS 2011: residual (6), (8), kinematic Kalman filter (9) to (11),
recursive least squares (14), (27). Its own parameters are those of the paper, which are the start
values of the FMU. It claims no standard deviation, and is never confident.
"""

from __future__ import annotations

import numpy as np

from rivals.records import Estimate, JointLog
from rivals.replayed import replayed


def estimate(log: JointLog) -> Estimate:
    """The estimate on line: at each sample from those up to it."""
    found, seconds = replayed(log, {"method": "Paper2011"})
    nothing = np.full(len(log.theta), np.nan)
    return Estimate(found["sigma"], nothing, np.zeros(len(nothing), bool), seconds)
