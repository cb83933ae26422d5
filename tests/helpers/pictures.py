"""What a figure or a report shows, without its words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from sigmahat.report.contents import Panel


def of_figure(figure: Figure) -> list[Any]:
    """For each panel its scales, lines and areas."""
    return [
        (
            axes.get_xscale(),
            axes.get_yscale(),
            [
                (np.asarray(line.get_xydata()).tolist(), line.get_color(), line.get_linestyle())
                for line in axes.get_lines()
            ],
            [
                (np.asarray(patch.get_path().vertices).tolist(), patch.get_edgecolor())
                for patch in axes.patches
            ],
        )
        for axes in figure.axes
    ]


def of_report(panels: Sequence[Panel]) -> list[Any]:
    """For each panel its scales and curves."""
    return [
        (
            panel.x_log,
            panel.y_log,
            panel.linked,
            [
                (curve.x.tolist(), curve.y.tolist(), curve.kind, curve.color)
                for curve in panel.curves
            ],
        )
        for panel in panels
    ]
