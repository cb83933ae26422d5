"""Figures 9 to 12: section VI.C, the AwAS that differs from its nominal data."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sigmahat.fmi.master import Recording
from sigmahat.paper.figures.panels import (
    TORQUE,
    TRUE,
    error_lines,
    everything,
    legend_above,
    line,
    stiffness_lines,
    time_panels,
    window,
)
from sigmahat.paper.figures.simulation import deformation_panel
from sigmahat.plotting.style import GREEN
from sigmahat.runs.scenario import nominal_awas

_NOMINAL: dict[str, Any] = {"color": "black", "linewidth": 0.8, "label": "nominal"}


def lever_arm(recording: Recording) -> Figure:
    """Figure 10: lever arm r, true and by the nominal data."""
    figure, (axes,) = time_panels(1)
    _lever_arm(axes, recording)
    return figure


def _lever_arm(axes: Axes, recording: Recording) -> None:
    line(axes, recording.t, recording.plant["r"], **TRUE)
    line(axes, recording.t, nominal_awas(recording)["r"], **_NOMINAL)
    axes.set_ylabel("lever arm $r$ [m]")
    axes.legend()


def nominal_torque(recording: Recording) -> Figure:
    """Figure 11: flexibility torque, by the nominal data and from the sensor.

    The second panel shows where the nominal data are most wrong.
    """
    figure, panels = time_panels(2)
    _nominal_torque(panels[0], recording, everything(recording.t))
    legend_above(panels[0])
    _nominal_torque_zoom(panels[1], recording)
    return figure


def _nominal_torque(axes: Axes, recording: Recording, shown: slice) -> None:
    for values, style in (
        (recording.plant["tau_e_measured"], {"color": GREEN, "label": "sensor"}),
        (recording.plant["tau_e"], {**TRUE, "linewidth": 1.5}),
        (nominal_awas(recording)["tau_e"], _NOMINAL),
    ):
        line(axes, recording.t[shown], values[shown], **style)
    axes.set_ylabel(TORQUE)


def _nominal_torque_zoom(axes: Axes, recording: Recording) -> None:
    error = np.abs(nominal_awas(recording)["tau_e"] - recording.plant["tau_e"])
    centre = float(recording.t[np.argmax(error)])
    _nominal_torque(axes, recording, window(recording.t, centre, 0.5))
    axes.set_title("where the nominal torque is most wrong", fontsize=9)


def stiffness(recording: Recording) -> Figure:
    """Figure 12: stiffness, true, by the nominal data, and estimated in the three modalities.

    The second panel shows the part with the largest stiffness.
    """
    t, true = recording.t, recording.plant["sigma"]
    figure, panels = time_panels(2)
    _stiffness(panels[0], recording, everything(t))
    panels[0].legend(ncols=5)
    shown = window(t, float(t[np.argmax(np.where(t > 1.0, true, 0.0))]), 2.0)
    _stiffness(panels[1], recording, shown)
    panels[1].set_ylim(0.95 * true[shown].min(), 1.2 * true[shown].max())
    panels[1].set_title("where the stiffness is largest", fontsize=9)
    return figure


def _stiffness(axes: Axes, recording: Recording, shown: slice) -> None:
    line(axes, recording.t[shown], nominal_awas(recording)["sigma"][shown], **_NOMINAL)
    stiffness_lines(axes, recording, shown)


def experiment(recording: Recording) -> Figure:
    """Figures 9 to 12 below each other, and the relative error of each estimate."""
    figure, panels = time_panels(5)
    deformation_panel(panels[0], recording)
    legend_above(panels[0])
    _lever_arm(panels[1], recording)
    _nominal_torque_zoom(panels[2], recording)
    legend_above(panels[2])
    _stiffness(panels[3], recording, everything(recording.t))
    panels[3].legend(ncols=5)
    error_lines(panels[4], recording)
    return figure
