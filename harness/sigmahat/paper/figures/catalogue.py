"""The figures of the scenarios by their names."""

from __future__ import annotations

from collections.abc import Callable

from matplotlib.figure import Figure

from sigmahat.fmi.master import Recording
from sigmahat.paper.figures import curves, experiment, simulation
from sigmahat.paper.figures.panels import (
    error_lines,
    everything,
    stiffness_lines,
    time_panels,
)


def summary(recording: Recording) -> Figure:
    """Stiffness, true and estimated, and the relative error of each estimate."""
    figure, (above, below) = time_panels(2)
    stiffness_lines(above, recording, everything(recording.t))
    above.legend(ncols=2)
    error_lines(below, recording)
    return figure


FIGURES: dict[str, Callable[[Recording], Figure]] = {
    "fig3-deformation": simulation.deformation,
    "fig4-velocity": simulation.velocity,
    "fig5-flexibility-torque": simulation.flexibility_torque,
    "fig6-stiffness": simulation.stiffness,
    "fig7-stability-factor": simulation.stability_factor,
    "fig8-constant-factors": simulation.constant_factors,
    "fig9-deformation": simulation.deformation,
    "fig10-lever-arm": experiment.lever_arm,
    "fig11-flexibility-torque": experiment.nominal_torque,
    "fig12-stiffness": experiment.stiffness,
    "transmission": curves.transmission,
    "summary": summary,
    "experiment": experiment.experiment,
    "antagonistic": curves.antagonistic,
}
"""Functions from the recording of a scenario to a figure, which no window manager holds."""
