"""The result of a whole log in one line: the stiffness, its changes, and whether it is trusted."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sigmahat.result.curve import Branch, Curve, is_told, stiffness_in_the_middle

_MOST = 0.5  # least fraction of the second half in which a trusted estimate was confident
_MOST_SETTINGS = 5  # largest number of set-points in a headline
_CURVED = 0.01  # a smaller relative change of the stiffness is not printed
_CONFIDENT = "None"  # item of the output `doubt` of a confident estimator


@dataclass(frozen=True)
class StiffnessChange:
    """A detected change of the stiffness, with time and relative size."""

    t: float  # time since the start of the log [s]
    relative: float | None
    """Relative difference between the last confident estimates before this change and before the
    next change [1], at the detected deformation and set-point; None without both estimates."""

    @property
    def in_words(self) -> str:
        """Sentence about the change for the user."""
        if self.relative is None:
            return f"the stiffness changed at {self.t:.4g} s, by how much is not known"
        return f"the stiffness changed by {100 * self.relative:+.0f} % at {self.t:.4g} s"


@dataclass(frozen=True)
class Confidence:
    """How far the estimator trusted its estimate, over a log.

    An estimate is trusted if the estimator was confident at the end, and for most of the second
    half of the log: the last sample alone may be confident by chance.
    """

    at_end: str  # item of the output `doubt` at the last tick; "None": confident
    shares: Mapping[str, float]
    """Fraction of the ticks in the second half, by item of the output `doubt`."""

    @property
    def doubt(self) -> str | None:
        """The reason why the estimate is not trusted, an item of `doubt`; None if it is trusted."""
        if self.at_end != _CONFIDENT:
            return self.at_end
        if self.shares.get(_CONFIDENT, 0.0) >= _MOST:
            return None
        reasons = {item: share for item, share in self.shares.items() if item != _CONFIDENT}
        return max(reasons, key=reasons.__getitem__)

    @property
    def in_words(self) -> str:
        if self.doubt is None:
            return "confident"
        if self.at_end != _CONFIDENT:
            return f"not confident ({self.doubt})"
        doubted = 1 - self.shares.get(_CONFIDENT, 0.0)
        return f"not confident for {100 * doubted:.3g} % of the second half ({self.doubt})"


def headline(curve: Curve, confidence: Confidence, changes: Sequence[StiffnessChange] = ()) -> str:
    """Formats stiffness and 95 % interval in one line, for each setting of a variable stiffness."""
    if not curve.branches:
        return "no stiffness: the estimator used no sample of the log"
    every = len(curve.branches) - 1
    count = min(every + 1, _MOST_SETTINGS)
    chosen = [curve.branches[every * i // max(count - 1, 1)] for i in range(count)]
    if every:
        text = ", ".join(f"{_plus_minus(each)} at {each.set_point:.4g}" for each in chosen)
        text += " (N.m/rad at set-points)"
    else:
        text = _in_one_line(chosen[0], confidence.doubt is None)
    if curve.claims:
        text += f", {confidence.in_words}"
    return "; ".join([text, *(change.in_words for change in told(changes, curve))])


def told(changes: Sequence[StiffnessChange], curve: Curve) -> Sequence[StiffnessChange]:
    """Returns the changes that may be called changes of the stiffness.

    Where no stiffness is known, neither before a change nor at the end, the log has changed, but
    by what is not known: a dead encoder does that, too.
    """
    if any(map(is_told, curve.branches)):
        return changes
    return [each for each in changes if each.relative is not None]


def _plus_minus(branch: Branch) -> str:
    """Formats the stiffness in the middle of the data with half of its interval, without unit."""
    _, sigma, interval = stiffness_in_the_middle(branch)
    if interval is None:
        return f"{sigma:.4g}"
    half = (interval[1] - interval[0]) / 2
    text = f"{sigma:.4g} +- {half:.3g}"
    return text if is_told(branch) else f"cannot tell ({text})"


def _in_one_line(branch: Branch, is_confident: bool) -> str:
    """Formats the stiffness in the middle of the data, and its range if wider than the interval.

    If the middle is in a dead zone, the confidence is that of the spring beyond the dead zone: then
    the stiffness is that of the deformation at which it is known best.
    """
    phi, sigma, interval = stiffness_in_the_middle(branch)
    if is_confident and not is_told(branch) and (known := _best_known(branch)):
        return f"{known}, cannot tell at {phi:.3g} rad"
    half = 0.0 if interval is None else (interval[1] - interval[0]) / 2
    text = f"{_plus_minus(branch)} N.m/rad at {phi:.3g} rad"
    within = branch.sigma[branch.within]
    if len(within) and np.ptp(within) > max(half, _CURVED * abs(sigma)):
        low, high = branch.reach
        text += f" ({within.min():.4g} to {within.max():.4g} from {low:.3g} to {high:.3g} rad)"
    return text


def _best_known(branch: Branch) -> str | None:
    """Formats the stiffness whose relative interval is narrowest; None if none excludes 0."""
    ends = branch.stiffness_interval()
    if ends is None:
        return None
    half = (ends[1] - ends[0]) / 2
    is_known = branch.within & (half < np.abs(branch.sigma))
    if not np.any(is_known):
        return None
    at = min(np.flatnonzero(is_known), key=lambda i: half[i] / abs(branch.sigma[i]))
    return f"{branch.sigma[at]:.4g} +- {half[at]:.3g} N.m/rad at {branch.phi[at]:.3g} rad"
