"""Draws the figure of a replay: the curve, and the stiffness and other signals over time."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from sigmahat.recording.gaps import refused, stretches
from sigmahat.result.curve_of_log import Answer, extremes
from sigmahat.result.log_panels import Reduced, curve_panels, quantity_panels, stiffness_panels
from sigmahat.result.replayed_log import DRAWN, Replay
from sigmahat.show.figure import draw as draw_panel
from sigmahat.show.figure import label_x
from sigmahat.show.panel import Panel

_MOST = 200  # stretches of ticks that the estimator skipped: only the longest are drawn


def draw(replay: Replay, answer: Answer) -> Figure:
    """Draws the curve, and below the curve panels over the time since the start of the log."""
    panels = _over_time(replay)
    figure = Figure(figsize=(8.4, 4.2 + 2.2 * len(panels)), layout="constrained")
    parts: Any = figure.subfigures(2, height_ratios=[4.0, 2.2 * len(panels) + 0.2])
    top, below = parts
    for axes, panel in zip(
        top.subplots(1, 2), curve_panels(answer.curve, answer.points), strict=False
    ):
        draw_panel(axes, panel, columns=2)
        label_x(axes, panel)
        axes.locator_params(axis="x", nbins=6)
    samples = replay.samples
    skipped = np.column_stack(stretches(refused(samples.values)))
    longest = np.argsort(skipped[:, 1] - skipped[:, 0])[::-1][:_MOST]
    skipped_times = samples.T * skipped[longest].astype(np.float64)
    every = below.subplots(len(panels), sharex=True, squeeze=False)[:, 0]
    for axes, panel in zip(every, panels, strict=True):
        for number, (begin, end) in enumerate(skipped_times.tolist()):
            legend = None if number else "skipped"
            axes.axvspan(begin, end, color="#cccccc", lw=0.5, label=legend)
        for number, change in enumerate(replay.changes.found):
            legend = None if number else "the stiffness changes"
            axes.axvline(change.t, color="black", linestyle=":", label=legend)
        draw_panel(axes, panel)
        axes.margins(x=0.01)
    every[-1].set_xlabel("time since the start of the log t [s]")
    return figure


def _over_time(replay: Replay) -> list[Panel]:
    """Creates the panels of the report from the minimum and maximum of each time interval."""
    statistics, samples = replay.statistics, replay.samples
    signals = {name: statistics.ends(name) for name in DRAWN}
    if replay.method != "FilteredRegression":
        del signals["sigma_std"]  # the method gives no interval
    if replay.parameters["modality"] == "Sensor":
        del signals["tau_e_residual"]
        sensor = samples.values[:, list(samples.names).index("tau_e_sensor")]
        signals["plant.tau_e_measured"] = extremes(sensor, statistics.bucket)
    step = samples.T * statistics.bucket
    t = np.repeat(step * np.arange(len(signals["sigma"]) // 2, dtype=np.float64), 2)
    reduced = Reduced(t, signals, statistics.bucket)
    stiffness = stiffness_panels(reduced, {"estimate": {"sigma": "sigma"}})
    return [*stiffness, *quantity_panels(reduced, "")]
