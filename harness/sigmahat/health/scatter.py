"""How far results of logs scatter beyond their own standard deviations (random effects).

The estimates of a joint differ from log to log, because no model holds exactly: another motion
shows other errors. The variance between logs adds to the variance that each log claims.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import ndtri

Array = NDArray[np.float64]

_MEDIAN = float(ndtri(0.75)) ** 2  # of the square of a normal deviate
_FEWEST = 3  # logs from which there is a scatter


def variance_between(values: Array, variances: Array) -> float:
    """Estimates the variance between logs, besides the variance of each, from neighbours in time.

    The equation is that of Paule and Mandel (J. Res. NBS 87, 1982, p. 377) with medians in place of
    means, and with differences of successive values: half of the squares of the differences, over
    their variances, are below the median of chi-square. So neither a change nor a bad log counts.

    values     in the order of time [size: logs]
    variances  that the logs claim, >= 0 [size: logs]

    Returns 0 for fewer than three logs, and if the claimed variances explain the differences.
    """
    if len(values) < _FEWEST:
        return 0.0
    squares = np.diff(values) ** 2
    claimed = variances[1:] + variances[:-1]

    def surplus(between: float) -> float:
        expected = claimed + 2 * between
        ratios = np.divide(
            squares, expected, out=np.where(squares > 0, np.inf, 0.0), where=expected > 0
        )
        return min(float(np.median(ratios)), 1e300) - _MEDIAN

    most = float(squares.max()) / _MEDIAN
    if surplus(0.0) <= 0 or most == 0:
        return 0.0
    return float(brentq(surplus, 0.0, most))
