"""Notices on line that the stiffness of a joint has passed a limit."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sigmahat.estimator.estimator import Estimator
from sigmahat.health.logs import by_joint
from sigmahat.health.read import read_results
from sigmahat.health.reference import Reference
from sigmahat.live.events import LimitPassed
from sigmahat.recording.log import LogError
from sigmahat.result.curve_of_log import Reach
from sigmahat.result.stored import Range
from sigmahat.result.together import together

_EVERY = 10.0  # [s] between two comparisons
_SURE = 0.95  # probability from which the limit counts as passed


@dataclass(frozen=True)
class Limits:
    """A limit of the relative change of the stiffness since the first logs of each joint."""

    limit: float
    references: Mapping[str, Reference]  # by joint

    @staticmethod
    def read(results: Path, limit: float) -> "Limits":
        """Raises LogError for results that cannot be read, or are too few."""
        try:
            found = read_results([results])
            if found.unreadable:
                raise LogError(found.unreadable[0])
            joints = by_joint(found.results)
            return Limits(limit, {each.joint: Reference.of(each) for each in joints})
        except ValueError as error:
            raise LogError(str(error)) from error

    def of(self, name: str, place: Path) -> "LimitOnLine":
        """Raises LogError for a joint without results; place: the configuration."""
        if name not in self.references:
            known = ", ".join(self.references)
            raise LogError(f"{place}: joint {name!r} has no results for a limit; there are {known}")
        return LimitOnLine(self.references[name], self.limit)


class LimitOnLine:
    """Compares the estimate of one joint from time to time."""

    def __init__(self, reference: Reference, limit: float) -> None:
        self._reference, self._limit = reference, limit
        self._next = _EVERY
        self._has_passed = False

    def add(
        self, t: float, joint: str, estimator: Estimator, used: Mapping[str, Range | None]
    ) -> LimitPassed | None:
        """Compares if it is time to. Returns the event when the limit is passed, once.

        t     time of a confident tick since the begin [s]
        used  ranges of phi [rad] and setPoint [1] at the samples that the regression used
        """
        phi, set_point = used["phi"], used["setPoint"]
        if t < self._next or self._has_passed or phi is None or set_point is None:
            return None
        self._next = t + _EVERY
        found = together(estimator, [Reach(float(np.mean(set_point)), phi)])
        compared: Any = found and self._reference.compare(found, self._limit)
        if compared is None or compared[1] < _SURE:
            return None
        difference, probability = compared
        self._has_passed = True
        return LimitPassed(
            t=t,
            joint=joint,
            limit=self._limit,
            relative=float(np.expm1(difference.size)),
            half_width=difference.half_width() * float(np.exp(difference.size)),
            probability=probability,
        )
