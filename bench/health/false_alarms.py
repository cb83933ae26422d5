"""The rate of false alarms by the limit of |z|: python -m health.false_alarms --series 20000.

Normal results without any change, one after another. After each of them, the largest step and the
largest trend are looked for, with all change points that change.py tries, by its formulas for equal
times and weights. The series counts as a false alarm at the first |z| above a limit. The fit below
the table is for FIT in sigmahat.health.threshold.
"""

import argparse

import numpy as np
from numpy.typing import NDArray

from sigmahat.health.change import FEWEST_AFTER, SHORTEST_TREND, as_normal

Array = NDArray[np.float64]

SEED = 64
LOGS = 365
LIMITS = np.arange(3.0, 5.41, 0.2)
_BATCH = 500
_FEWEST = 5  # logs with three degrees of freedom


def largest_z(values: Array) -> Array:
    """Returns the largest |z| of each series until each log [size: series x logs]."""
    series, logs = values.shape
    index = np.arange(1, logs + 1, dtype=np.float64)
    S, T, Q = (
        np.cumsum(each, axis=1) for each in (values, index * values, values**2)
    )  # sums of y, i y, y^2
    found = np.zeros((series, logs))
    for n in range(_FEWEST, logs + 1):
        k = index[FEWEST_AFTER - 1 : n - FEWEST_AFTER]  # logs before the change
        total = S[:, n - 1 : n]
        squares = Q[:, n - 1 : n] - total**2 / n
        later = total - S[:, k.astype(int) - 1]
        step = later - total * (n - k) / n
        largest = np.max(_t(step, k * (n - k) / n, squares, n - 2), axis=1)
        # A ramp that begins at log k, which is the last one before the change.
        k = k[k <= n - SHORTEST_TREND]
        if not len(k):
            found[:, n - 1] = as_normal(largest, n - 2)
            continue
        at = k.astype(int) - 1
        later = total - S[:, at]
        m = n - k
        mean = m * (m + 1) / 2 / n
        ramp = T[:, n - 1 : n] - T[:, at] - k * later - total * mean
        ramps = m * (m + 1) * (2 * m + 1) / 6 - n * mean**2
        largest = np.maximum(largest, np.max(_t(ramp, ramps, squares, n - 2), axis=1))
        found[:, n - 1] = as_normal(largest, n - 2)
    return found


def _t(products: Array, own: Array, squares: Array, freedom: int) -> Array:
    explained = products**2 / own
    return np.sqrt(explained / np.maximum(squares - explained, 1e-300) * freedom)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--series", type=int, default=20000)
    arguments = parser.parse_args()
    rng = np.random.default_rng(SEED)
    ever = []
    for _ in range(arguments.series // _BATCH):
        ever.append(np.maximum.accumulate(largest_z(rng.standard_normal((_BATCH, LOGS))), axis=1))
    largest = np.concatenate(ever)
    print(f"{len(largest)} series; share with a false alarm until log 30, 100 and 365")
    for limit in LIMITS:
        print(
            f"{limit:.1f}", *(f"{np.mean(largest[:, n - 1] > limit):.5f}" for n in (30, 100, 365))
        )
    shares = np.array([np.mean(largest[:, -1] > limit) for limit in LIMITS])
    chosen = (shares < 0.3) & (shares * len(largest) >= 20)
    hazard = -np.log1p(-shares[chosen]) / LOGS
    a, b = LIMITS[chosen], np.log(hazard) + LIMITS[chosen] ** 2 / 2
    weights = np.sqrt(shares[chosen] * len(largest))
    power, level = np.polyfit(np.log(a), b, 1, w=weights)
    print(f"ln(rate per log) = {level:.3f} + {power:.3f} ln z - z^2 / 2")


if __name__ == "__main__":
    main()
