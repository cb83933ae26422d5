"""False alarms by bad logs: python -m health.bad_logs --series 300.

Series of a year of daily logs without any change, of which one value in 24 is 10 standard
deviations off, always to the same side, or whose values have Student's t distribution with three
degrees of freedom. Prints how many have a change above a limit of |z| in one of 40 nights, by the
number of neighbours with which a log has to agree: a share of the logs, and nine or more.
"""

import argparse
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from sigmahat.health import change
from sigmahat.health.change import Series, largest_change

Array = NDArray[np.float64]

SEED = 65
LOGS = 365
LIMITS = (4.0, 4.5, 5.0, 5.5)
_NIGHTS = np.unique(np.geomspace(8, LOGS, 40).astype(int))


def _bad(rng: np.random.Generator) -> Array:
    return rng.standard_normal(LOGS) + 10.0 * (rng.random(LOGS) < 1 / 24)


def _heavy(rng: np.random.Generator) -> Array:
    return rng.standard_t(3, LOGS)


VALUES: Mapping[str, Callable[[np.random.Generator], Array]] = {"bad": _bad, "heavy": _heavy}


def largest_z(values: Array) -> float:
    """Returns the largest |z| of all nights."""
    index = np.arange(LOGS, dtype=np.float64)
    series = Series(index, values, np.ones(LOGS), np.zeros((LOGS, 0)))
    found = [largest_change(series.part(0, night)) for night in _NIGHTS]
    return max((abs(each.z) for each in found if each is not None), default=0.0)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--series", type=int, default=300)
    arguments = parser.parse_args()
    for kind, draw in VALUES.items():
        for part in (1, 2, 4, 8, LOGS):
            change._SHARE = part
            rng = np.random.default_rng(SEED)
            largest = np.array([largest_z(draw(rng)) for _ in range(arguments.series)])
            shares = ", ".join(f"{np.mean(largest > z):.2%} above {z:g}" for z in LIMITS)
            print(f"{kind}, 1 / {part} of the logs: {shares}", flush=True)


if __name__ == "__main__":
    main()
