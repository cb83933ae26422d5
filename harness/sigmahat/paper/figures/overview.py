"""One picture for a scenario: stiffness and its relative error."""

from __future__ import annotations

from matplotlib.figure import Figure

from sigmahat.fmi.master import Recording
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
