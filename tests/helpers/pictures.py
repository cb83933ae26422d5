"""What a figure shows, without its words."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure


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
