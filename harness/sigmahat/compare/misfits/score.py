"""Accuracy of an estimate, and of its standard deviation sigma_std, here called the claim."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

SETTLED = 2.0
"""Time after the start of the torque from which an estimate is judged [s]."""
DANGEROUS_ERROR, DANGEROUS_CLAIM = 0.1, 0.02
"""Limits of a dangerous instant: error above, and sigma_std / estimate below its limit [1]."""
WRONG = 0.2
"""Error above which a confident estimate is wrong [1]."""
_LARGEST = 10.0  # a larger relative error or claim counts as this value


@dataclass(frozen=True)
class Score:
    """Sums over instants. Error and claim are relative to the true stiffness."""

    instants: int = 0
    error2: float = 0.0
    """Squares of the error [1]."""
    claim2: float = 0.0
    """Squares of sigma_std divided by the true stiffness [1]."""
    inside: int = 0
    """Instants with an error of at most 1.96 sigma_std."""
    dangerous_instants: int = 0
    confident_instants: int = 0
    wrong_instants: int = 0
    """Instants that are confident, with an error above WRONG."""

    def __add__(self, other: Score) -> Score:
        return Score(
            *(a + b for a, b in zip(vars(self).values(), vars(other).values(), strict=True))
        )

    @property
    def figures(self) -> dict[str, float]:
        """Root mean squares of error and claim; percentages of instants that have the truth within
        1.96 sigma_std, are dangerous, confident, confident and wrong [%]; nan without instants.
        """
        count = self.instants or math.nan
        squares = {"error": self.error2, "claim": self.claim2}
        counts = {
            "coverage": self.inside,
            "dangerous": self.dangerous_instants,
            "confident": self.confident_instants,
            "wrong": self.wrong_instants,
        }
        roots = {name: 100 * math.sqrt(total / count) for name, total in squares.items()}
        return roots | {name: 100 * (total / count) for name, total in counts.items()}


def score(
    true: NDArray[np.float64],
    sigma: NDArray[np.float64],
    sigma_std: NDArray[np.float64],
    confident: NDArray[np.bool_],
) -> Score:
    """The score of an estimate; arguments [N.m/rad] and flags of shape (N,).

    Instants with a true stiffness of 0 are left out: the spring is in its dead zone.
    """
    engaged = true != 0
    true, sigma, sigma_std, confident = (a[engaged] for a in (true, sigma, sigma_std, confident))
    error = np.abs(sigma / true - 1)
    claim = sigma_std / np.abs(true)
    dangerous = (error > DANGEROUS_ERROR) & (sigma_std < DANGEROUS_CLAIM * np.abs(sigma))
    return Score(
        instants=len(true),
        error2=float(np.sum(np.minimum(error, _LARGEST) ** 2)),
        claim2=float(np.sum(np.minimum(claim, _LARGEST) ** 2)),
        inside=int(np.sum(np.abs(sigma - true) <= 1.96 * sigma_std)),
        dangerous_instants=int(np.sum(dangerous)),
        confident_instants=int(np.sum(confident)),
        wrong_instants=int(np.sum(confident & (error > WRONG))),
    )
