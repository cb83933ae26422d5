"""Changes of the stiffness that the estimator detected: when, and how large."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.instance import Value
from sigmahat.joint.sheet import powers_of_phi


@dataclass(frozen=True)
class StiffnessChange:
    """A change, and its size at the deformation and set-point at which it was detected."""

    t: float  # time since the start of the log [s]
    relative: float | None
    """Relative difference between the last confident estimates before this change and before the
    next change [1]; None without both estimates."""

    @property
    def in_words(self) -> str:
        """A sentence."""
        if self.relative is None:
            return f"the stiffness changed at {self.t:.4g} s, by how much is not known"
        return f"the stiffness changed by {100 * self.relative:+.0f} % at {self.t:.4g} s"


def detected(
    age: NDArray[np.float64],
    confident: NDArray[np.bool_],
    before: float = -1.0,
    followed: bool = True,
) -> NDArray[np.intp]:
    """Indices at which a change was detected: where the output change_age starts again.

    The estimator may start again several times before it follows a change. So a further change
    counts only after a confident estimate since the last change.

    before    value of change_age before the first index [s]
    followed  whether no change was before, or an estimate was confident since the last change
    """
    last = np.concatenate([[before], age[:-1]])
    starts = np.flatnonzero((age >= 0) & ((age < last) | (last < 0)))
    count = np.cumsum(confident)[starts]
    return starts[np.diff(count, prepend=-1 if followed else 0) > 0]


class Changes:
    """Collects the changes from the outputs of a replay."""

    def __init__(self, every: Mapping[str, Value], T: float) -> None:
        """every  parameters of the estimator"""
        n, m = int(every["rls.n"]), int(every["rls.m"])
        self.names = [f"eta[{i},{j}]" for i in range(n) for j in range(m)]
        """Outputs that are needed besides change_age, confident, phi and setPoint."""
        self._powers = np.repeat(powers_of_phi(bool(every["rls.symmetric"]), n), m)
        self._powers_of_set_point = np.tile(np.arange(m), n)
        self._T, self._ticks, self._age, self._followed = T, 0, -1.0, True
        self._eta: NDArray[np.float64] | None = None  # of the last confident tick since a change
        self._at = 0.0, 0.0  # deformation and set-point of the last change
        self._before: float | None = None  # the stiffness at this point
        self.found: list[StiffnessChange] = []  # all changes until now

    def add(self, outputs: Mapping[str, NDArray[Any]]) -> None:
        """Adds the outputs of the next ticks."""
        age = outputs["change_age"]
        eta = np.column_stack([outputs[name] for name in self.names])
        confident = np.flatnonzero(outputs["confident"])
        new = detected(age, outputs["confident"], self._age, self._followed)
        for begin, end in pairwise([-1, *new.tolist(), len(age)]):
            if begin >= 0:
                self._at = float(outputs["phi"][begin]), float(outputs["setPoint"][begin])
                self._before = None if self._eta is None else self._stiffness(self._eta)
                self._eta, self._followed = None, False
                self.found.append(StiffnessChange(self._T * (self._ticks + begin), None))
            inside = confident[(confident >= begin) & (confident < end)]
            if len(inside):
                self._eta, self._followed = eta[inside[-1]], True
                if self._before is not None and self._before > 0:
                    relative = self._stiffness(self._eta) / self._before - 1
                    self.found[-1] = StiffnessChange(self.found[-1].t, relative)
        self._ticks, self._age = self._ticks + len(age), float(age[-1])

    def _stiffness(self, eta: NDArray[np.float64]) -> float:
        """The stiffness by (21) at the point of the last detected change [N.m/rad]."""
        (phi, set_point), p = self._at, self._powers
        slopes = p * np.power(phi, np.maximum(p - 1, 0))
        return float(eta @ (slopes * np.power(set_point, self._powers_of_set_point)))
