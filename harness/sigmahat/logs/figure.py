"""The figure of a replay: stiffness, torque, deformation and set-point over time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sigmahat.logs.log import Array
from sigmahat.logs.resampling import stretches
from sigmahat.logs.sampling import Samples
from sigmahat.logs.statistics import ReplayStatistics

_BLUE, _SKY, _VERMILION = "#0072B2", "#56B4E9", "#D55E00"
_SETTLED = 0.05  # part of the log that is left out when the scale is chosen: the estimate learns
_OUTER = 1.0  # percent of the stiffness left out at either end of its range, for the same reason
_MARGIN = 0.3


@dataclass(frozen=True)
class Replay:
    """The data of the figure."""

    samples: Samples
    statistics: ReplayStatistics
    modality: str
    """Modality of the estimator: the source of its torque."""
    method: str
    """Method of the estimator."""


def draw(replay: Replay) -> Figure:
    """Panels above each other, over the time since the start of the log."""
    panels = [
        (r"stiffness $\sigma$ [N$\cdot$m/rad]", [("sigma", r"estimate $\hat\sigma$", _BLUE)]),
        (
            r"flexibility torque $\tau_e$ [N$\cdot$m]",
            [
                ("tau_e_residual", r"residual $\gamma r_e$", _SKY),
                ("tau_e", r"fitted, $f(\theta_c, \phi)$", _VERMILION),
            ],
        ),
        (r"deformation $\phi$ [rad]", [("phi", r"deformation $\phi = q - \theta$", _BLUE)]),
    ]
    if "theta_c" in replay.samples.names:
        panels.append(("set-point [1]", [("setPoint", "set-point", _BLUE)]))
    figure = Figure(figsize=(7.2, 1.2 + 2.1 * len(panels)), layout="constrained")
    every = figure.subplots(len(panels), sharex=True, squeeze=False)[:, 0]
    for axes, (label, lines) in zip(every, panels, strict=True):
        limits = []
        for name, title, color in lines:
            ends = replay.statistics.ends(name)
            if name == "tau_e_residual" and replay.modality == "Sensor":
                ends, title = _sensor(replay), "sensor"
            elif name == "tau_e_residual" and replay.method == "MatchedFilter":
                title = "by the motor data, with friction"
            t = replay.samples.T * replay.statistics.bucket * np.arange(len(ends))
            axes.plot(np.repeat(t, 2), ends.ravel(), color=color, label=title)
            settled = ends[int(_SETTLED * len(ends)) :]
            outer = _OUTER if name == "sigma" else 0.0
            limits += np.nanpercentile(settled, [outer, 100 - outer]).tolist()
        if lines[0][0] == "sigma" and replay.method == "MatchedFilter":
            _interval(axes, replay)
        _scale(axes, min(limits), max(limits))
        _skipped(axes, replay.samples)
        axes.set_ylabel(label)
        axes.margins(x=0.01)
        axes.legend(loc="upper right", ncols=3)
    every[-1].set_xlabel("time since the start of the log $t$ [s]")
    return figure


def _sensor(replay: Replay) -> Array:
    """Torque of the sensor in the form of ReplayStatistics.ends."""
    samples = replay.samples
    values = samples.values[:, list(samples.names).index("tau_e_sensor")]
    starts = np.arange(0, len(values), replay.statistics.bucket)
    ends: Array = np.column_stack(
        [np.fmin.reduceat(values, starts), np.fmax.reduceat(values, starts)]
    )
    return ends


def _interval(axes: Axes, replay: Replay) -> None:
    """A band of 1.96 standard deviations on both sides of the estimate."""
    sigma, std = replay.statistics.ends("sigma"), replay.statistics.ends("sigma_std")[:, 1]
    axes.fill_between(
        replay.samples.T * replay.statistics.bucket * np.arange(len(sigma)),
        sigma[:, 0] - 1.96 * std,
        sigma[:, 1] + 1.96 * std,
        color=_SKY,
        alpha=0.4,
        linewidth=0,
        label=r"$\pm$ 1.96 standard deviations",
    )


def _scale(axes: Axes, low: float, high: float) -> None:
    span = (high - low) or abs(high) or 1.0
    axes.set_ylim(low - 0.1 * span, high + _MARGIN * span)


def _skipped(axes: Axes, samples: Samples) -> None:
    """Grey areas where the estimator skipped ticks."""
    first, last = stretches(np.isnan(samples.values).any(axis=1))
    longest = np.argsort(last - first)[::-1][:200]
    for i, (a, b) in enumerate(zip(first[longest], last[longest], strict=True)):
        axes.axvspan(
            a * samples.T, b * samples.T, color="#cccccc", lw=0.5, label=None if i else "skipped"
        )
