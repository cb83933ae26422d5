"""Creates the panels of a replay: the curve, the stiffness over time, and other signals."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.result import curve as joint
from sigmahat.result.curve_of_log import MeasuredPoints, extremes
from sigmahat.show.panel import COLORS, TRUE, Panel, Trace
from sigmahat.show.style import QUANTITIES, around, limits, plain_axis, with_margin

BUDGET = 400_000  # largest number of values of all signals, which take 2 MB of a report
_MOST = 20_000  # largest number of values of a signal; a browser draws longer lines too slowly


@dataclass(frozen=True)
class Reduced:
    """Signals at common times, reduced for a plot."""

    t: NDArray[np.float64]
    signals: dict[str, NDArray[Any]]  # signals, with the shape of t
    bucket: int
    """Number of samples from which minimum and maximum are kept; 1: every sample is kept."""
    whole: tuple[float, float] | None = None
    """Start and end of the time interval in which every sample is kept."""


def reduce(t: NDArray[Any], signals: Mapping[str, NDArray[Any]], budget: int = BUDGET) -> Reduced:
    """Reduces signals to about `budget` values in total, and at most 20000 values of each signal.

    From a longer signal, half of the kept values are all samples around the middle, where single
    encoder counts are visible. The other half are minimum and maximum of each bucket, at the first
    time of the bucket. Time t and the signals have the same shape (N,), N >= 1.
    """
    half = min(max(budget // max(len(signals), 1), 8), _MOST) // 2
    t = np.asarray(t, dtype=np.float64)
    if len(t) <= 2 * half:
        short = {name: np.asarray(signal, dtype=np.float32) for name, signal in signals.items()}
        return Reduced(t, short, 1)
    bucket = -(-2 * (len(t) - half) // half)
    first = (len(t) - half) // 2
    last = first + half
    reduced = {}
    for name, signal in signals.items():  # one signal at a time, to limit the memory
        x = np.asarray(signal, dtype=np.float32)
        parts = extremes(x[:first], bucket), x[first:last], extremes(x[last:], bucket)
        reduced[name] = np.concatenate(parts)
    before, after = (np.repeat(each[::bucket], 2) for each in (t[:first], t[last:]))
    times = np.concatenate([before, t[first:last], after])
    return Reduced(times, reduced, bucket, (float(t[first]), float(t[last - 1])))


_TIME = plain_axis("t")
_WIDE = 3.5  # line width of the truth, which stays visible under an estimate
_SIDES = ("", "_1", "_2")
"""Suffixes of the variables of the whole joint, and of both sides of an antagonistic pair."""


_QUANTITIES: Mapping[tuple[str, str], Mapping[str, str]] = {
    ("Flexibility torque", plain_axis("tau_e")): {
        "tau_e_residual{}": "by the motor data",
        "plant.tau_e_measured{}": "sensor",
        "plant.tau_e{}": "true",
        "tau_e{}": "fitted, f(θ_c, φ)",
    },
    ("Deformation", plain_axis("phi")): {
        "plant.phi{}": "true",
        "phi{}": "as the estimator sees it",
    },
    ("Motor velocity", plain_axis("theta_dot")): {
        "plant.theta_dot{}": "true",
        "theta_dot{}": "filtered",
    },
    ("Positions as measured", "position [rad]"): {
        "plant.theta_measured{}": "motor, θ",
        "plant.q_measured": "link, q",
    },
    ("Misfit of the model", "misfit [1]"): {"misfit{}": "1 where the model holds"},
    ("Set-point", plain_axis("setPoint")): {"setPoint{}": "set-point of the regression"},
}
"""Panels by title and axis; each panel has the labels of its signals by variable of the FMU.

In a name, {} stands for the side of an antagonistic pair. Noisy signals are drawn first.
"""


def stiffness_panels(
    reduced: Reduced, estimates: Mapping[str, Mapping[str, str]]
) -> Iterator[Panel]:
    """Yields panels of the stiffness, and of the relative error if the truth was recorded.

    estimates  names of the signals by variable (sigma, sigma_1, sigma_2), for each label
    """
    for side in _SIDES:
        labels = [label for label, names in estimates.items() if f"sigma{side}" in names]
        if not labels:
            continue
        lines = []
        for label, color in zip(labels, COLORS, strict=False):
            values = reduced.signals[estimates[label][f"sigma{side}"]]
            std = reduced.signals.get(f"sigma_std{side}")
            has_interval = std is not None and np.nanmax(std) > 0
            band = joint.interval(values, std) if has_interval else None
            lines.append(Trace(label, color, reduced.t, values, band=band))
        true = reduced.signals.get(f"plant.sigma{side}")
        truth = [] if true is None else [Trace("true", TRUE, reduced.t, true, width=_WIDE)]
        scale = lines[0].y[len(lines[0].y) // 20 :] if true is None else true
        yield Panel(
            f"Stiffness{_of_side(side)}",
            _TIME,
            plain_axis("sigma"),
            [*truth, *lines],
            y_range=_with_band(with_margin(*limits(scale), 0.2), lines),
            caption="band: 95 %" if any(line.band for line in lines) else "",
        )
        if true is not None:
            yield Panel(
                f"Relative error of the stiffness{_of_side(side)}",
                _TIME,
                "|error| [%]",
                [
                    Trace(line.label, line.color, reduced.t, _error(line.y, true), width=1.1)
                    for line in lines
                ],
                y_log=True,
                y_range=(1e-5, 2e2),
            )


def _with_band(shown: tuple[float, float], lines: Sequence[Trace]) -> tuple[float, float]:
    """Extends the limits of an axis so that the 95 % band at the end of the lines is visible."""
    ends = [float(end[-1]) for line in lines for end in line.band or () if np.isfinite(end[-1])]
    return min([shown[0], *ends]), max([shown[1], *ends])


def quantity_panels(reduced: Reduced, estimator: str) -> Iterator[Panel]:
    """Yields panels of all other quantities; titles contain `estimator` unless it is empty."""
    for (title, axis), labels in _QUANTITIES.items():
        measured = all("_measured" in variable for variable in labels)  # for all estimators
        whose = f", {estimator}" if estimator and not measured else ""
        for side in _sides(labels, reduced):
            curves = _curves(labels, side, reduced)
            if curves:
                full = f"{title}{_of_side(side)}{whose}"
                # limits() ignores single spikes, for example after a gap.
                low, high = zip(*(limits(curve.y) for curve in curves), strict=True)
                y_range = with_margin(min(low), max(high), 0.06)
                yield Panel(full, _TIME, axis, curves, y_range=y_range)


def sampling(reduced: Reduced) -> list[str]:
    """Describes for the user which samples the plots show."""
    if reduced.whole is None:  # the signals are short
        return ["Every sample is in the plots: zoom in until single counts of the encoders show."]
    ends = f"the least and the greatest of every {reduced.bucket} samples"
    first, last = reduced.whole
    return [
        f"Every sample is in the plots from {first:.6g} s to {last:.6g} s, the shaded part: zoom in"
        f" there until single counts of the encoders show. Elsewhere, plots have {ends}."
    ]


def _of_side(side: str) -> str:
    return f" of side {side[1:]}" if side else ""


def _sides(variables: Iterable[str], reduced: Reduced) -> Iterable[str]:
    """Returns the sides of an antagonistic pair that have a recorded signal."""
    of_sides = ((each, side) for each in variables if "{}" in each for side in _SIDES)
    return dict.fromkeys(side for each, side in of_sides if each.format(side) in reduced.signals)


def _curves(labels: Mapping[str, str], side: str, reduced: Reduced) -> list[Trace]:
    curves = []
    colors = iter(COLORS)
    for variable, label in labels.items():
        values = reduced.signals.get(variable.format(side))
        if values is None:
            continue
        if variable.startswith("plant.") and "_measured" not in variable:
            curves.append(Trace(label, TRUE, reduced.t, values, width=_WIDE))
        # A constant signal is not shown: the joint has no sensor or no set-point.
        elif np.nanmin(values) != np.nanmax(values):
            curves.append(Trace(label, next(colors), reduced.t, values, width=1.1))
    return curves


def _error(estimate: NDArray[Any], true: NDArray[Any]) -> NDArray[np.float32]:
    """Computes the relative error [%]; an error of 0 becomes nan for the logarithmic scale."""
    with np.errstate(divide="ignore", invalid="ignore"):
        error: NDArray[np.float32] = (100 * np.abs(estimate / true - 1)).astype(np.float32)
    error[~(error > 0) | ~np.isfinite(error)] = np.nan
    return error


def curve_panels(curve: joint.Curve, points: MeasuredPoints) -> Iterator[Panel]:
    """Yields panels of torque and stiffness against the deformation; none without data."""
    if not curve.branches:
        return
    settings = [branch.set_point for branch in curve.branches]
    of_branch = joint.nearest(settings, points.set_point)
    torques, stiffnesses = [], []
    for i, branch in enumerate(curve.branches):
        own = of_branch == i
        label = f"set-point {branch.set_point:.3g}" if len(settings) > 1 else "estimate"
        color = COLORS[i % len(COLORS)]
        behind = points.phi[own], points.tau_e[own]
        line = Trace(label, color, branch.phi, branch.sigma, within=branch.within, width=2.0)
        stiffnesses.append(replace(line, band=branch.stiffness_interval()))
        band = branch.torque_interval()
        torques.append(replace(line, y=branch.tau_e, band=band, behind=behind))
    for name, curves in (("tau_e", torques), ("sigma", stiffnesses)):
        words = QUANTITIES[name].words.capitalize()
        parts = ["points: measured"] if name == "tau_e" else []
        parts += ["band: 95 %"] if curve.claims else []
        yield Panel(
            f"{words} against deformation",
            plain_axis("phi"),
            plain_axis(name),
            curves,
            linked=False,
            caption="; ".join([*parts, "faded: outside of the data"]),
            y_range=_scale(curves),
        )


def _scale(curves: list[Trace]) -> tuple[float, float] | None:
    """Computes the range of the y axis from the data, without single outliers.

    A wide band is cut at the size of the curve, because the curve would appear flat otherwise.
    """
    shown = []
    for each in curves:
        y = each.y[each.within]
        room = np.max(np.abs(y), initial=0.0)
        shown += [y, *(np.clip(b[each.within], y - room, y + room) for b in each.band or ())]
        if each.behind is not None and len(each.behind[1]):
            shown.append(np.array(limits(each.behind[1])))
    return around(shown, 0.1)
