"""One picture for a scenario: stiffness and its relative error."""

from __future__ import annotations

from matplotlib.figure import Figure

from sigmahat.fmi.master import Recording
from sigmahat.paper.figures.panels import (
    STIFFNESS,
    TORQUE,
    TRUE,
    error_axes,
    error_line,
    error_lines,
    everything,
    legend_above,
    limit,
    line,
    stiffness_lines,
    time_panels,
)
from sigmahat.plotting.colors import BLUE, GREEN, VERMILION


def summary(recording: Recording) -> Figure:
    """Stiffness, true and estimated, and the relative error of each estimate."""
    figure, (above, below) = time_panels(2)
    stiffness_lines(above, recording, everything(recording.t))
    above.legend(ncols=2)
    error_lines(below, recording)
    return figure


def antagonistic(recording: Recording) -> Figure:
    """Torques of both transmissions, stiffness of the device and of its sides, relative errors."""
    t, plant, estimate = recording.t, recording.plant, recording.estimators["RESIDUAL"]
    figure, (torques, stiffnesses, errors) = time_panels(3)
    for i, color in ((1, GREEN), (2, VERMILION)):
        line(torques, t, plant[f"tau_e_{i}"], color=color, label=f"side {i}")
    total = plant["tau_e_1"] + plant["tau_e_2"]
    line(torques, t, total, color="black", linewidth=0.8, label="sum, which moves the link")
    torques.set_ylabel(TORQUE)
    legend_above(torques)

    for name, signal, color in (
        ("device", "sigma", BLUE),
        ("side 1", "sigma_1", GREEN),
        ("side 2", "sigma_2", VERMILION),
    ):
        line(stiffnesses, t, plant[signal], **TRUE)
        line(stiffnesses, t, estimate[signal], color=color, label=f"RESIDUAL, {name}")
        error_line(errors, t, plant[signal], estimate[signal], color=color, label=name)
    limit(stiffnesses, plant["sigma"])
    stiffnesses.set_ylabel(STIFFNESS)
    lines = stiffnesses.get_lines()  # true and estimate in turn; the true ones look the same
    stiffnesses.legend(handles=[lines[0], *lines[1::2]], ncols=4)
    error_axes(errors)
    return figure
