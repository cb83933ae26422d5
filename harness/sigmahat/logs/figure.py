"""The figure of a replay: the curve, and stiffness, torque, deformation, set-point over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sigmahat.joint.curve import NORMAL_95, Branch, Curve, nearest
from sigmahat.logs.curve import Answer
from sigmahat.logs.job import Replay
from sigmahat.logs.log import Array
from sigmahat.logs.measured import MeasuredPoints
from sigmahat.logs.resampling import stretches
from sigmahat.logs.sampling import Samples
from sigmahat.plotting.style import BLUE, SKY, VERMILION, around, cycle, math_axis
from sigmahat.plotting.style import limits as shown_range

_FADED = 0.35


def draw_curve(torque: Axes, stiffness: Axes, curve: Curve, points: MeasuredPoints) -> None:
    """Both panels; the measured points stand behind the torque, faintly."""
    several = len(curve.branches) > 1
    colors = cycle(len(curve.branches)) if several else [BLUE] * len(curve.branches)
    measured: list[Array] = []
    band = None if several else "95 % band"
    for i, (branch, color) in enumerate(zip(curve.branches, colors, strict=True)):
        measured.append(_points(torque, curve, i, points, color))
        label = f"{branch.set_point:.3g}" if several else r"fitted $f(\theta_c, \phi)$"
        _branch(torque, branch, branch.tau_e, branch.torque_interval(), color, label, band)
        label = f"{branch.set_point:.3g}" if several else r"estimate $\hat\sigma$"
        _branch(stiffness, branch, branch.sigma, branch.stiffness_interval(), color, label, band)
    _scale(torque, [*measured, *(_shown(b, b.tau_e, b.torque_interval()) for b in curve.branches)])
    _scale(stiffness, [_shown(b, b.sigma, b.stiffness_interval()) for b in curve.branches])
    torque.set_ylabel(math_axis("tau_e"))
    stiffness.set_ylabel(math_axis("sigma"))
    for axes in (torque, stiffness):
        axes.set_xlabel(math_axis("phi"))
        axes.locator_params(axis="x", nbins=6)
        axes.ticklabel_format(axis="x", scilimits=(-2, 3))
    _legends(torque, stiffness, curve)


def _legends(torque: Axes, stiffness: Axes, curve: Curve) -> None:
    """The set-points once, beside the stiffness; else what is drawn."""
    band = ["with 95 % band"] if curve.claims else []
    if len(curve.branches) > 1:
        title = "\n".join(["set-point $s$", *band])
        stiffness.legend(title=title, loc="center left", bbox_to_anchor=(1.0, 0.5), reverse=True)
        return
    for axes in (torque, stiffness) if curve.branches else ():
        axes.legend(loc="upper left")
        bottom, top = axes.get_ylim()
        axes.set_ylim(bottom, top + 0.2 * (top - bottom))


def _branch(
    axes: Axes,
    branch: Branch,
    values: Array,
    interval: tuple[Array, Array] | None,
    color: str,
    label: str,
    band: str | None,
) -> None:
    """A line with its band, both faded beyond the data."""
    within = branch.within
    axes.plot(branch.phi[within], values[within], color=color, label=label, linewidth=1.4)
    axes.plot(branch.phi, values, color=color, alpha=_FADED, linestyle="--")
    if interval is None:
        return
    low, high = interval
    style: Any = {"color": color, "linewidth": 0}
    axes.fill_between(branch.phi, low, high, alpha=0.08, **style)
    axes.fill_between(branch.phi, low, high, where=within.tolist(), alpha=0.22, label=band, **style)


def _points(axes: Axes, curve: Curve, branch: int, points: MeasuredPoints, color: str) -> Array:
    """The points that belong to a branch. Returns the torques that the scale is to show."""
    settings = [each.set_point for each in curve.branches]
    own = np.flatnonzero(nearest(settings, points.set_point) == branch)
    style: Any = {"color": color, "linestyle": "", "marker": "o", "markeredgewidth": 0}
    axes.plot(
        points.phi[own],
        points.tau_e[own],
        markersize=2,
        alpha=0.1,
        zorder=0.5,
        rasterized=True,
        **style,
    )
    if len(curve.branches) == 1:
        axes.plot([], [], markersize=4, alpha=0.4, label="measured", **style)
    return np.array(shown_range(points.tau_e[own])) if len(own) else np.empty(0)


def _shown(branch: Branch, values: Array, interval: tuple[Array, Array] | None) -> Array:
    """Values that the scale is to show: those where the data reach."""
    every = [values, *(interval or ())]
    return np.concatenate([each[branch.within] for each in every])


def _scale(axes: Axes, shown: list[Array]) -> None:
    found = around(shown, 0.15)
    if found is not None:
        axes.set_ylim(*found)


_SETTLED = 0.05  # part of the log that is left out when the scale is chosen: the estimate learns
_OUTER = 1.0  # percent of the stiffness left out at either end of its range, for the same reason
_MARGIN = 0.3


class _Line(NamedTuple):
    """An output over time."""

    label: str
    color: str
    ends: Array
    """Minimum and maximum in each interval, [size: intervals x 2]."""
    outer: float = 0.0
    """Percent at either end that the scale does not show; 0: only what is far away."""


def draw(replay: Replay, answer: Answer) -> Figure:
    """The curve, and below it panels over the time since the start of the log."""
    panels = _panels(replay)
    figure = Figure(figsize=(8.4, 3.6 + 2.0 * len(panels)), layout="constrained")
    parts: Any = figure.subfigures(2, height_ratios=[3.4, 2.0 * len(panels) + 0.2])
    top, below = parts
    torque, stiffness = top.subplots(1, 2)
    draw_curve(torque, stiffness, answer.curve, answer.points)
    skipped = _skipped(replay.samples)
    every = below.subplots(len(panels), sharex=True, squeeze=False)[:, 0]
    for axes, (label, lines) in zip(every, panels.items(), strict=True):
        limits: list[float] = []
        for line in lines:
            axes.plot(
                np.repeat(_times(replay, line.ends), 2),
                line.ends.ravel(),
                color=line.color,
                label=line.label,
            )
            settled = line.ends[int(_SETTLED * len(line.ends)) :]
            limits += _limits(settled, line.outer)
        if axes is every[0] and replay.method == "FilteredRegression":
            limits += _interval(axes, replay)
        _set_limits(axes, min(limits), max(limits))
        _shade(axes, skipped)
        for number, tick in enumerate(replay.statistics.changes):
            legend = None if number else "the stiffness changes"
            axes.axvline(replay.samples.T * tick, color="black", linestyle=":", label=legend)
        axes.set_ylabel(label)
        axes.margins(x=0.01)
        axes.legend(loc="upper right", ncols=3)
    every[-1].set_xlabel("time since the start of the log $t$ [s]")
    return figure


def _limits(values: Array, outer: float) -> Sequence[float]:
    if not outer:
        return shown_range(values)
    ends: list[float] = np.nanpercentile(values, [outer, 100 - outer]).tolist()
    return ends


def _panels(replay: Replay) -> dict[str, list[_Line]]:
    """Lines by the label of their axis; the stiffness is first."""
    ends = replay.statistics.ends
    torque = _Line(r"residual $\gamma r_e$", SKY, ends("tau_e_residual"))
    if replay.every["modality"] == "Sensor":
        torque = _Line("sensor", SKY, _sensor(replay))
    elif replay.method == "FilteredRegression":
        torque = torque._replace(label="by the motor data, with friction")
    panels = {
        math_axis("sigma"): [_Line(r"estimate $\hat\sigma$", BLUE, ends("sigma"), _OUTER)],
        math_axis("tau_e"): [
            torque,
            _Line(r"fitted, $f(\theta_c, \phi)$", VERMILION, ends("tau_e")),
        ],
        math_axis("phi"): [_Line(r"deformation $\phi = q - \theta$", BLUE, ends("phi"))],
    }
    if "theta_c" in replay.samples.names:
        panels[math_axis("setPoint")] = [_Line("set-point $s$", BLUE, ends("setPoint"))]
    return panels


def _times(replay: Replay, ends: Array) -> Array:
    """Start of each interval [s]."""
    return replay.samples.T * replay.statistics.bucket * np.arange(len(ends), dtype=np.float64)


def _sensor(replay: Replay) -> Array:
    """Torque of the sensor in the form of ReplayStatistics.ends."""
    samples = replay.samples
    values = samples.values[:, list(samples.names).index("tau_e_sensor")]
    starts = np.arange(0, len(values), replay.statistics.bucket)
    ends: Array = np.column_stack(
        [np.fmin.reduceat(values, starts), np.fmax.reduceat(values, starts)]
    )
    return ends


def _interval(axes: Axes, replay: Replay) -> tuple[float, float]:
    """The 95 % band of the estimate.

    Returns its limits at the end, which the scale is to show.
    """
    sigma, std = replay.statistics.ends("sigma"), replay.statistics.ends("sigma_std")[:, 1]
    low, high = sigma[:, 0] - NORMAL_95 * std, sigma[:, 1] + NORMAL_95 * std
    axes.fill_between(
        _times(replay, sigma),
        low,
        high,
        color=SKY,
        alpha=0.4,
        linewidth=0,
        label="95 % band",
    )
    return float(low[-1]), float(high[-1])


def _set_limits(axes: Axes, low: float, high: float) -> None:
    span = (high - low) or abs(high) or 1.0
    axes.set_ylim(low - 0.1 * span, high + _MARGIN * span)


def _skipped(samples: Samples) -> Array:
    """Begin and end of the longest stretches of ticks that the estimator skipped [s]."""
    both = np.column_stack(stretches(np.isnan(samples.values).any(axis=1)))
    longest = np.argsort(both[:, 1] - both[:, 0])[::-1][:200]
    times: Array = samples.T * both[longest].astype(np.float64)
    return times


def _shade(axes: Axes, skipped: Array) -> None:
    """Grey areas where the estimator skipped ticks."""
    for i, (begin, end) in enumerate(skipped.tolist()):
        axes.axvspan(begin, end, color="#cccccc", lw=0.5, label=None if i else "skipped")
