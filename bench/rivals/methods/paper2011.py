"""Paper2011 of this package.

F. Flacco, A. De Luca, I. Sardellitti, N. G. Tsagarakis, "Robust estimation of variable stiffness
in flexible joints", Proc. IEEE/RSJ IROS 2011: residual (6), (8), kinematic Kalman filter (9) to
(11), recursive least squares (14), (27). Its own parameters are those of the paper, which are the
start values of the FMU, but for c of (27): with it the start P(0) counts as 1/(c P(0)) in units of
the squares of the columns. The paper's columns go up to (100 mm)^2 times 0.3 rad, so that a single
sample counts 1e7 times as much as the start; c is such that a sample at the range of the
deformation does so here, too. It claims no standard deviation, and is never confident.
"""

from __future__ import annotations

import numpy as np

from rivals.records import Estimate, JointLog
from rivals.replayed import replayed

P_0 = 1e20
"""Initial covariance, as in the paper."""
SAMPLE = 1e7
"""What a sample at the range of the deformation counts, the start being 1."""


def estimate(log: JointLog) -> Estimate:
    """The estimate on line: at each sample from those up to it."""
    c = SAMPLE / (P_0 * log.known.range_phi**2)
    found, seconds = replayed(log, {"method": "Paper2011", "rls.P_0": P_0, "rls.c": c})
    nothing = np.full(len(log.theta), np.nan)
    return Estimate(found["sigma"], nothing, np.zeros(len(nothing), bool), seconds)
