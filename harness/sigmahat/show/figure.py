"""Figures with Matplotlib: panels that are drawn, and files in one style."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from sigmahat.show.panel import FigureRows, Panel, Trace, TraceKind

_LETTERS, _HANDLE = 110, 7
"""Letters of a legend in the width of a figure, and letters that a line and its gaps need."""


def stacked(panels: Sequence[Panel]) -> Figure:
    """Draws panels one below the other, each with its own axis."""
    return in_rows([[panel] for panel in panels])


def in_rows(rows: FigureRows) -> Figure:
    """Draws rows of panels from the top down; the panels of a row share its width."""
    figure = Figure(figsize=(7.2, 0.8 + 2.8 * len(rows)), layout="constrained")
    grid = figure.add_gridspec(len(rows), 1)
    for row, panels in enumerate(rows):
        cells = grid[row].subgridspec(1, len(panels))
        for column, panel in enumerate(panels):
            axes = figure.add_subplot(cells[column])
            most = 5 if len(panels) == 1 else 2
            draw(axes, panel, columns=max(1, min(most, _fitting(panel, len(panels)))))
            label_x(axes, panel)
            if len(panels) > 1 and not panel.x_log:
                axes.locator_params(axis="x", nbins=5)
    return figure


def _fitting(panel: Panel, shares: int) -> int:
    """How many labels of a panel fit side by side into its share of the width of a figure."""
    longest = max((len(curve.label) for curve in panel.curves), default=0)
    return int(_LETTERS / shares / (longest + _HANDLE))


def draw(axes: Axes, panel: Panel, columns: int = 3) -> None:
    """Draws a panel without the label of its x axis.

    The legend is above the panel at the right, because an offset of the scale is at the left.
    """
    for curve in panel.curves:
        first = curve is panel.curves[0]
        if curve.kind is TraceKind.STEPS:
            axes.stairs(curve.y, curve.x, fill=True, alpha=0.25, color=curve.color)
            axes.stairs(curve.y, curve.x, color=curve.color, linewidth=1.2, label=curve.label)
        elif curve.kind is TraceKind.POINTS:
            style: Any = {"color": curve.color, "markersize": 4, "alpha": 0.6}
            axes.plot(curve.x, curve.y, ".", label=curve.label, **style)
        elif curve.kind is TraceKind.MEANS and curve.band is not None:
            ends = np.array([curve.y - curve.band[0], curve.band[1] - curve.y])
            axes.errorbar(
                curve.x, curve.y, ends, color=curve.color, marker="o", markersize=4, capsize=3,
                linewidth=1.2, label=curve.label,
            )  # fmt: skip
        else:
            _line(axes, curve, first)
    axes.set_xscale("log" if panel.x_log else "linear")
    axes.set_yscale("log" if panel.y_log else "linear")
    axes.set_ylabel(panel.y_label)
    if panel.y_range is not None:
        axes.set_ylim(*panel.y_range)
    if panel.curves:
        place: Any = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0)}
        axes.legend(ncols=columns, frameon=False, borderaxespad=0.2, **place)


def label_x(axes: Axes, panel: Panel) -> None:
    axes.set_xlabel(f"{panel.x_label}\n{panel.caption}" if panel.caption else panel.x_label)


def _line(axes: Axes, curve: Trace, first: bool) -> None:
    """Draws a line and its band, paler outside of the data, in front of the measured points."""
    color, within = curve.color, curve.within
    if curve.behind is not None:
        style: Any = {"color": color, "marker": "o", "linestyle": "", "markeredgewidth": 0}
        x, y = curve.behind
        axes.plot(x, y, markersize=2, alpha=0.1, zorder=0.5, rasterized=True, **style)
    shown = np.ones(len(curve.x), np.bool_) if within is None else within
    dashes: Any = (0, curve.dash) if curve.dash else "-"
    axes.plot(
        curve.x[shown], curve.y[shown], color=color, linewidth=curve.width, linestyle=dashes,
        label=curve.label,
    )  # fmt: skip
    if within is not None:
        axes.plot(curve.x, curve.y, color=color, alpha=0.35, linestyle="--")
    if curve.band is not None:
        low, high = curve.band
        axes.fill_between(
            curve.x, low, high, where=shown.tolist(), color=color, alpha=0.22, linewidth=0,
            label="95 % band" if first else None,
        )  # fmt: skip
        if within is not None:
            axes.fill_between(curve.x, low, high, color=color, alpha=0.08, linewidth=0)


Source = TypeVar("Source")  # data of a figure

_STYLE: Any = {
    "font.size": 9,
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "legend.fontsize": 8,
    "lines.linewidth": 1.0,
    "savefig.dpi": 150,
    "path.simplify_threshold": 0.5,  # [pixels]: noise of a long signal in a small file
    "svg.hashsalt": "sigmahat",  # the same picture gives the same file
}


def save(draw: Callable[[Source], Figure], source: Source, path: Path) -> None:
    """Draws a figure into <path>.png and <path>.svg. The same source gives the same SVG."""
    with matplotlib.rc_context(_STYLE):
        figure = draw(source)
        figure.savefig(path.with_suffix(".svg"), metadata={"Date": None})
        figure.set_layout_engine("none")  # the layout is kept, because it takes long to compute
        figure.set_dpi(_STYLE["savefig.dpi"])
        canvas: Any = FigureCanvasAgg(figure)  # Matplotlib has no types for it
        canvas.draw()
    # 256 colours look the same in a third of the bytes.
    pixels = canvas.get_width_height(), canvas.buffer_rgba(), "raw", "RGBA", 0, 1
    image = Image.frombuffer("RGBA", *pixels).convert("RGB")
    image.quantize(256, method=Image.Quantize.FASTOCTREE).save(path.with_suffix(".png"))
