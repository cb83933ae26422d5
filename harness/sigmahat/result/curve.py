"""Defines the curve of a joint: torque and stiffness by deformation, with 95 % intervals.

`curve_of_log.py` computes the curve. This module writes and reads the table `estimate.curve.csv`.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from sigmahat.files.tables import aligned, numeric_columns, read_csv, title, write_csv
from sigmahat.result.sheet import Array, Polynomial
from sigmahat.result.stored import Range

NORMAL_95 = 1.96  # half the width of a 95 % interval divided by the standard deviation
_NEAR = 0.25
"""Points belong to a set-point up to this fraction of the distance to the next set-point."""


@dataclass(frozen=True)
class Branch:
    """The curve at one set-point. Arrays are of one size, in the order of the deformation."""

    set_point: float  #: [1]
    reach: Range
    """Range of the measured deformation at this set-point [rad]; beyond, data are extrapolated."""
    phi: Array  #: Deformation [rad], from below this range to above this range.
    tau_e: Array  #: Flexibility torque [N.m]
    tau_e_std: Array | None
    """Standard deviation of tau_e [N.m], from the estimator; None if the method has none."""
    sigma: Array  #: Stiffness [N.m/rad]
    sigma_std: Array | None
    """Standard deviation of the stiffness [N.m/rad], or None like tau_e_std."""

    @property
    def within(self) -> NDArray[np.bool_]:
        """Whether each point of the branch is in the range of the data."""
        return (self.phi >= self.reach[0]) & (self.phi <= self.reach[1])

    def torque_interval(self) -> tuple[Array, Array] | None:
        """Computes lower and upper end of the 95 % interval of the torque [N.m]."""
        return interval(self.tau_e, self.tau_e_std)

    def stiffness_interval(self) -> tuple[Array, Array] | None:
        """Computes lower and upper end of the 95 % interval of the stiffness [N.m/rad]."""
        return interval(self.sigma, self.sigma_std)


@dataclass(frozen=True)
class Curve:
    """Torque and stiffness that an estimator has found from a log."""

    polynomial: Polynomial  #: Polynomial of the torque.
    branches: Sequence[Branch]
    """A branch per set-point, in increasing order; one for a fixed spring; empty: no data."""

    @property
    def claims(self) -> bool:
        """Whether the curve has intervals."""
        return any(branch.sigma_std is not None for branch in self.branches)


def interval(value: Array, std: Array | None) -> tuple[Array, Array] | None:
    """Computes lower and upper end of the 95 % interval; None without a standard deviation."""
    if std is None:
        return None
    return value - NORMAL_95 * std, value + NORMAL_95 * std


def characteristic(reach: Range) -> tuple[float, float, float]:
    """Returns deformations at which the stiffness is printed [rad]: the middle, which is 0 if the
    range contains 0, and half way to both ends."""
    low, high = reach
    middle = 0.0 if low <= 0 <= high else (low + high) / 2
    return (low + middle) / 2, middle, (high + middle) / 2


def nearest(settings: Sequence[float], set_points: Array) -> NDArray[np.intp]:
    """Returns for each point the index of the nearest setting; -1 for a point far from all
    settings. The settings are in increasing order."""
    if len(settings) == 1:
        return np.zeros(len(set_points), np.intp)
    levels = np.asarray(settings, np.float64)
    steps = np.diff(levels)
    width = _NEAR * np.minimum(np.append(steps, np.inf), np.insert(steps, 0, np.inf))
    found: NDArray[np.intp] = np.abs(set_points[:, None] - levels).argmin(axis=1)
    found[np.abs(set_points - levels[found]) > width[found]] = -1
    return found


CURVE = "estimate.curve.csv"  # name of the file in the folder of results
_UNITS = {
    "setPoint": "1",
    "phi": "rad",
    **dict.fromkeys(("tau_e", "tau_e_std", "tau_e low", "tau_e high"), "N.m"),
    **dict.fromkeys(("sigma", "sigma_std", "sigma low", "sigma high"), "N.m/rad"),
    "in the data": None,
}


def write_curve(curve: Curve, path: Path) -> None:
    """Writes a curve as CSV, one row per point; fields of missing intervals are empty."""
    rows: list[tuple[object, ...]] = []
    for branch in curve.branches:
        columns = (
            np.full_like(branch.phi, branch.set_point),
            branch.phi,
            *(branch.tau_e, branch.tau_e_std, *(branch.torque_interval() or (None, None))),
            *(branch.sigma, branch.sigma_std, *(branch.stiffness_interval() or (None, None))),
            np.where(branch.within, "true", "false"),
        )
        empty = [None] * len(branch.phi)
        rows += zip(*(empty if x is None else x.tolist() for x in columns), strict=True)
    write_csv(path, [title(name, unit) for name, unit in _UNITS.items()], rows)


def read_curve(path: Path, polynomial: Polynomial) -> Curve:
    """Reads the table of a curve; the polynomial is in the data sheet, not in the table.

    Raises ValueError with a remedy for a file that is not the table of a curve.
    """
    again = "run `sigmahat estimate` again"
    try:
        table = read_csv(path)
    except OSError as error:
        raise ValueError(f"{path}: {error.strerror}; {again}") from error
    if [name.partition(" [")[0] for name in table.column_names] != list(_UNITS):
        raise ValueError(f"{path}: expected a stiffness curve of `sigmahat estimate`; {again}")
    if not table.num_rows:
        return Curve(polynomial, ())
    empty = [name for name in table.column_names if pa.types.is_null(table[name].type)]
    columns = numeric_columns(table.drop_columns(empty))
    if missing := set(_UNITS) - set(columns) - {name.partition(" [")[0] for name in empty}:
        raise ValueError(f"{path}: column {min(missing)!r} has no numbers; {again}")
    branches = []
    for setting in np.unique(columns["setPoint"]):
        own = {name: x[columns["setPoint"] == setting] for name, x in columns.items()}
        within = own["phi"][own["in the data"] == 1]
        reach = float(within.min()), float(within.max())
        torque, stiffness = ((own[x], own.get(f"{x}_std")) for x in ("tau_e", "sigma"))
        branches.append(Branch(float(setting), reach, own["phi"], *torque, *stiffness))
    return Curve(polynomial, branches)


_STIFFNESS_HEAD = ("phi [rad]", "sigma [N.m/rad]", "95 % interval")
_INVISIBLE = 1e-6  # share of the largest term of a polynomial
_FAMILY_HEAD = (
    *("setPoint", "phi from [rad]", "to [rad]"),
    *("sigma half way down", "in the middle [N.m/rad]", "half way up"),
)


def is_told(branch: Branch) -> bool:
    """Returns whether the interval of the stiffness in the middle of the data excludes 0."""
    _, sigma, interval = stiffness_in_the_middle(branch)
    return interval is None or (interval[1] - interval[0]) / 2 < abs(sigma)


def stiffness_in_the_middle(branch: Branch) -> tuple[float, float, Range | None]:
    """Returns the deformation in the middle [rad], and stiffness and interval there [N.m/rad]."""
    phi = characteristic(branch.reach)[1]
    return phi, *_at(branch, phi)


def curve_text(curve: Curve, polynomial: bool = True) -> list[str]:
    """Formats a curve for a terminal, with 3 or 4 of many set-points; no lines without data."""
    if not curve.branches:
        return []
    lines = [f"the stiffness as a curve, {reach_in_words(curve)}:"]
    if polynomial:
        lines.append(f"  {polynomial_in_words(curve.polynomial)}")
    head, *rows = stiffness_table(curve)
    if len(curve.branches) > 1:
        rows = rows[:: len(rows) // 2]
    lines += [f"  {line}" for line in aligned([head, *rows], left=())]
    return lines


def reach_in_words(curve: Curve) -> str:
    """Describes the range of deformation and set-point in which the curve is valid."""
    low = min(branch.reach[0] for branch in curve.branches)
    high = max(branch.reach[1] for branch in curve.branches)
    text = f"for phi from {low:.4g} to {high:.4g} rad"
    if len(curve.branches) > 1:
        first, last = curve.branches[0].set_point, curve.branches[-1].set_point
        text += f" and setPoint from {first:.4g} to {last:.4g}, less at some set-points"
    return text


def polynomial_in_words(polynomial: Polynomial) -> str:
    """Formats the torque as a polynomial, with six digits of each coefficient.

    Terms are left out that are too small in the range of the data to change these digits.
    """
    eta = _visible(polynomial)
    terms = [
        f"{_coefficient(row)}{_power(' phi', power)}"
        for row, power in zip(eta, polynomial.powers_of_phi, strict=True)
        if any(row)
    ]
    symbols = "phi in rad" + (", s = setPoint" if polynomial.is_of_set_point else "")
    return f"tau_e [N.m] = {_sum(terms) or '0'}; {symbols}"


def _visible(polynomial: Polynomial) -> list[list[float]]:
    """Returns the coefficients, with 0 for terms that are invisible in the range of the data."""
    phi = max(map(abs, polynomial.phi or (1.0, 1.0)))
    set_point = max(map(abs, polynomial.set_point or (1.0, 1.0)))
    of_phi = phi ** np.array(polynomial.powers_of_phi, dtype=float)
    of_set_point = set_point ** np.array(polynomial.powers_of_set_point, dtype=float)
    sizes = np.abs(polynomial.eta) * np.outer(of_phi, of_set_point)
    visible: list[list[float]] = np.where(
        sizes > _INVISIBLE * sizes.max(initial=0.0), polynomial.eta, 0.0
    ).tolist()
    return visible


def _coefficient(row: Sequence[float]) -> str:
    """Formats a coefficient as a number, or as a polynomial in the set-point s in brackets."""
    terms = [f"{value:.6g}{_power(' s', j)}" for j, value in enumerate(row) if value]
    return terms[0] if len(terms) == 1 else f"({_sum(terms)})"


def _power(symbol: str, power: int) -> str:
    return "" if power == 0 else symbol if power == 1 else f"{symbol}^{power}"


def _sum(terms: Sequence[str]) -> str:
    return " + ".join(terms).replace("+ -", "- ")


def stiffness_table(curve: Curve) -> Iterator[tuple[str, ...]]:
    """Yields the cells of a table: a header, and one row for each characteristic deformation; with
    several set-points, one row for each set-point."""
    several = len(curve.branches) > 1
    yield _FAMILY_HEAD if several else _STIFFNESS_HEAD
    for branch in curve.branches:
        rows: list[tuple[str, ...]] = []
        for phi in characteristic(branch.reach):
            sigma, ends = _at(branch, phi)
            interval = f"{ends[0]:.4g} to {ends[1]:.4g}" if ends else "not claimed"
            rows.append((f"{phi:.4g}", f"{sigma:.4g}", interval))
        if several:
            reach = (f"{end:.4g}" for end in branch.reach)
            stiffness = (f"{sigma} ({interval})" for _, sigma, interval in rows)
            rows = [(f"{branch.set_point:.4g}", *reach, *stiffness)]
        yield from rows


def stiffness_points(curve: Curve) -> list[dict[str, object]]:
    """Returns stiffnesses at characteristic deformations as numbers, for JSON.

    phi is in rad, sigma and its 95 % interval in N.m/rad; the data reach from and to `reach` [rad].
    """
    return [
        {
            "setPoint": branch.set_point,
            "phi": phi,
            "sigma": _at(branch, phi)[0],
            "interval": _at(branch, phi)[1],
            "reach": branch.reach,
        }
        for branch in curve.branches
        for phi in characteristic(branch.reach)
    ]


def _at(branch: Branch, phi: float) -> tuple[float, Range | None]:
    """Returns stiffness and interval at the point of a branch that is nearest to phi."""
    at = int(np.argmin(np.abs(branch.phi - phi)))
    ends = branch.stiffness_interval()
    interval = None if ends is None else (float(ends[0][at]), float(ends[1][at]))
    return float(branch.sigma[at]), interval
