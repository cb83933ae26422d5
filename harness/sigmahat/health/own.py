"""What each log says by itself: its estimates without the priors of motor and friction."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sigmahat.estimator.instances import QUANTITIES
from sigmahat.result.sheet import Prior, Together

Array = NDArray[np.float64]

_BY_THE_LOG = 0.5
"""Largest share of the variance of the prior that is left after a log, for a quantity from which
the prior can be taken away: with more, it is the prior that determines the quantity."""
_KNOWN = 0.1  # largest relative standard deviation of an inertia that a log determines
_EXACT = Prior(0.0, 0.0)


@dataclass(frozen=True)
class OwnEstimates:
    """Estimates of logs: first the stiffness at points, then QUANTITIES.

    A log with fewer points than another has NaN as the deformation of the others, and values of 0.
    """

    phi: Array  # deformations of the points [rad] [size: logs x points]
    set_point: Array  # and their set-points [1] [size: logs x points]
    values: Array  # [size: logs x values]
    covariance: Array  # without the gain of the torque [size: logs x values x values]
    per_gain: Array  # change of the values per relative change of this gain [size: logs x values]
    determines_inertia: NDArray[np.bool_]  # [size: logs]

    def index(self, name: str) -> int:
        """Returns the index of one of QUANTITIES in the values."""
        return int(self.phi.shape[1]) + QUANTITIES.index(name)


def own_estimates(logs: Sequence[Together]) -> OwnEstimates:
    """Takes the normal priors of motor and friction out of the estimates of each log.

    A prior N(m, s^2) of quantity e is a factor of the density of all estimates. Without it, the
    inverse of the covariance P is smaller by e e' / s^2, so that P grows by P e e' P / (s^2 - P_ee)
    and the estimates change by P e (x_e - m) / (s^2 - P_ee). A quantity that the log does not
    determine keeps its prior.
    """
    points = max((len(each.phi) for each in logs), default=0)
    size = points + len(QUANTITIES)
    phi, set_point = np.full((2, len(logs), points), np.nan)
    values, per_gain = np.zeros((2, len(logs), size))
    P = np.zeros((len(logs), size, size))
    for i, each in enumerate(logs):
        count = len(each.phi)
        phi[i, :count], set_point[i, :count] = each.phi, each.set_point
        at = np.array([*range(count), *range(points, size)])
        values[i, at], per_gain[i, at] = each.values, each.per_gain
        P[i, at[:, None], at] = each.covariance
    inertia = points + QUANTITIES.index("B")
    before = P[:, inertia, inertia]
    for e, name in enumerate(QUANTITIES, points):
        mean, variance = _priors(logs, name)
        column = P[:, :, e]
        is_taken = (column[:, e] > 0) & (column[:, e] < _BY_THE_LOG * variance)
        rest = np.where(is_taken, variance - column[:, e], np.inf)[:, None]
        values = values + column * (values[:, e] - mean)[:, None] / rest
        per_gain = per_gain + column * per_gain[:, e, None] / rest
        P = P + column[:, :, None] * column[:, None, :] / rest[:, :, None]
    _, prior = _priors(logs, "B")
    is_determined = (before > 0) & (before < _BY_THE_LOG * prior)
    B = values[:, inertia]
    is_known = (B > 0) & (np.sqrt(P[:, inertia, inertia]) < _KNOWN * B)
    return OwnEstimates(phi, set_point, values, P, per_gain, is_determined & is_known)


def _priors(logs: Sequence[Together], name: str) -> tuple[Array, Array]:
    """Returns means and variances of the priors of a quantity; 0 where it has none [size: logs]."""
    priors = [each.prior.get(name, _EXACT) for each in logs]
    return np.array([each.mean for each in priors]), np.array([each.std for each in priors]) ** 2
