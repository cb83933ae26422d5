"""The curve of a joint in words: polynomial, and stiffness with intervals, over which range."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from sigmahat.files.tables import aligned
from sigmahat.joint.curve import Branch, Curve, characteristic
from sigmahat.joint.sheet import Polynomial
from sigmahat.joint.stored import Range

STIFFNESS_HEAD = ("phi [rad]", "sigma [N.m/rad]", "95 % interval")
FAMILY_HEAD = (
    "setPoint",
    "phi from [rad]",
    "to [rad]",
    "sigma half way down",
    "in the middle [N.m/rad]",
    "half way up",
)


def curve_text(curve: Curve) -> list[str]:
    """Lines for a terminal, at most 3 or 4 of many set-points; none without data."""
    if not curve.branches:
        return []
    lines = [
        f"the answer as a curve, {reach_in_words(curve)}:",
        f"  {polynomial_in_words(curve.polynomial)}",
    ]
    rows: list[Sequence[str]] = [STIFFNESS_HEAD, *stiffness_rows(curve)]
    if len(curve.branches) > 1:
        every = list(family_rows(curve))
        rows = [FAMILY_HEAD, *every[:: len(every) // 2]]
    lines += [f"  {line}" for line in aligned(rows, left=())]
    return lines


def reach_in_words(curve: Curve) -> str:
    """Over which range it holds."""
    low = min(branch.reach[0] for branch in curve.branches)
    high = max(branch.reach[1] for branch in curve.branches)
    text = f"for phi from {low:.4g} to {high:.4g} rad"
    if len(curve.branches) > 1:
        first, last = curve.branches[0].set_point, curve.branches[-1].set_point
        text += f" and setPoint from {first:.4g} to {last:.4g}, less at some set-points"
    return text


def polynomial_in_words(polynomial: Polynomial) -> str:
    """The torque as a polynomial, coefficients with six digits."""
    terms = [
        f"{_coefficient(row)}{_power(' phi', power)}"
        for row, power in zip(polynomial.eta, polynomial.powers_of_phi, strict=True)
        if any(row)
    ]
    symbols = "phi in rad" + (", s = setPoint" if polynomial.is_of_set_point else "")
    return f"tau_e [N.m] = {_sum(terms) or '0'}; {symbols}"


def _coefficient(row: Sequence[float]) -> str:
    """A number, or a polynomial in the set-point s in brackets."""
    terms = [f"{value:.6g}{_power(' s', j)}" for j, value in enumerate(row) if value]
    return terms[0] if len(terms) == 1 else f"({_sum(terms)})"


def _power(symbol: str, power: int) -> str:
    return "" if power == 0 else symbol if power == 1 else f"{symbol}^{power}"


def _sum(terms: Sequence[str]) -> str:
    return " + ".join(terms).replace("+ -", "- ")


def stiffness_rows(curve: Curve) -> Iterator[tuple[str, ...]]:
    """Cells of STIFFNESS_HEAD: the stiffness in the middle and half way to either end."""
    for branch in curve.branches:
        for phi in characteristic(branch.reach):
            yield f"{phi:.4g}", *_stiffness(branch, phi)


def family_rows(curve: Curve) -> Iterator[tuple[str, ...]]:
    """Cells of FAMILY_HEAD: the same for each set-point, in one row."""
    for branch in curve.branches:
        cells = [_stiffness(branch, phi) for phi in characteristic(branch.reach)]
        reach = (f"{end:.4g}" for end in branch.reach)
        stiffness = (f"{sigma} ({interval})" for sigma, interval in cells)
        yield f"{branch.set_point:.4g}", *reach, *stiffness


def stiffness_points(curve: Curve) -> list[dict[str, object]]:
    """The same as numbers, for JSON."""
    return [
        {
            "setPoint": branch.set_point,
            "phi [rad]": phi,
            "sigma [N.m/rad]": _at(branch, phi)[0],
            "interval [N.m/rad]": _at(branch, phi)[1],
            "data from and to [rad]": branch.reach,
        }
        for branch in curve.branches
        for phi in characteristic(branch.reach)
    ]


def _stiffness(branch: Branch, phi: float) -> tuple[str, str]:
    sigma, interval = _at(branch, phi)
    if interval is None:
        return f"{sigma:.4g}", "not claimed"
    return f"{sigma:.4g}", f"{interval[0]:.4g} to {interval[1]:.4g}"


def _at(branch: Branch, phi: float) -> tuple[float, Range | None]:
    """Stiffness and interval at one of the points of a branch."""
    at = int(np.argmin(np.abs(branch.phi - phi)))
    ends = branch.stiffness_interval()
    interval = None if ends is None else (float(ends[0][at]), float(ends[1][at]))
    return float(branch.sigma[at]), interval
