"""What a report shows, and its panels as Bokeh draws them.

The page gives the plots their switches and, through CSS, their colours.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from bokeh.models import (
    BoxAnnotation,
    BoxZoomTool,
    ColumnDataSource,
    GlyphRenderer,
    PanTool,
    Range1d,
    ResetTool,
    SaveTool,
    TeeHead,
    WheelZoomTool,
    Whisker,
)
from bokeh.plotting import figure
from numpy.typing import NDArray

_HEIGHT = 300
TRUE = "#8f8f8f"
COLORS = ("#1f83c4", "#12a37c", "#e06a1a", "#c9589b", "#b58900", "#56b4e9")
"""Okabe and Ito, shifted to be read on white and on black."""


@dataclass(frozen=True)
class Table:
    """Cells as text."""

    title: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]

    @property
    def words(self) -> list[bool]:
        """Of each column, whether it has words, which stand at the left."""
        columns = zip(*self.rows, strict=True)
        return [any(cell[:1].isalpha() and cell != "nan" for cell in column) for column in columns]


@dataclass(frozen=True)
class Trace:
    """A line, or points, in one colour and with one switch."""

    label: str
    color: str
    x: NDArray[Any]
    y: NDArray[Any]
    kind: str = "line"
    """line; points; means, points with intervals; steps, y between edges x (one x more)."""
    half: NDArray[Any] | None = None
    """Half widths of the intervals of means."""
    width: float = 1.4


@dataclass(frozen=True)
class Panel:
    """A plot."""

    title: str
    x_label: str
    y_label: str
    traces: Sequence[Trace]
    x_log: bool = False
    y_log: bool = False
    linked: bool = True
    """Its x axis moves with those of the other panels that are linked."""
    y_range: tuple[float, float] | None = None
    """What is seen at first, where an estimate jumps while it learns."""


@dataclass(frozen=True)
class Contents:
    """All of a report."""

    title: str
    lines: Sequence[str]
    """Below the title."""
    tables: Sequence[Table]
    panels: Sequence[Panel]
    every: tuple[float, float] | None = None
    """Where every sample is drawn, if not everywhere."""


@dataclass(frozen=True)
class Plot:
    """A panel as Bokeh draws it."""

    panel: Panel
    figure: figure
    switches: Sequence[tuple[Trace, str]]
    """Each trace and the name that all its models have."""


def plots(panels: Sequence[Panel], every: tuple[float, float] | None) -> list[Plot]:
    """The plots of panels; every is shaded in those that are linked."""
    sources: dict[int, ColumnDataSource] = {}
    linked = _time_range(panels)
    made = []
    for i, panel in enumerate(panels):
        plot = _figure(panel, linked)
        if every is not None and panel.linked:
            plot.add_layout(
                BoxAnnotation(left=every[0], right=every[1], fill_color="#888888", fill_alpha=0.12)
            )
        switches = []
        for j, trace in enumerate(panel.traces):
            name = f"trace-{i}-{j}"
            _draw(plot, trace, name, sources)
            switches.append((trace, name))
        made.append(Plot(panel, plot, switches))
    return made


def _time_range(panels: Sequence[Panel]) -> Range1d:
    """One object for all linked panels: they zoom together."""
    times = [trace.x for panel in panels if panel.linked for trace in panel.traces]
    if not times:
        return Range1d()
    return Range1d(float(times[0][0]), float(times[0][-1]))


def _x_range(panel: Panel) -> Range1d:
    return Range1d(*_limits([trace.x for trace in panel.traces], panel.x_log))


def _y_limits(panel: Panel) -> tuple[float, float]:
    # Found here, because Bokeh would build a search tree of every trace for it.
    values = [trace.y for trace in panel.traces]
    for trace in panel.traces:
        if trace.half is not None:
            values += [_low(trace), trace.y + trace.half]
    if any(trace.kind == "steps" for trace in panel.traces):
        values.append(np.zeros(1))
    return _limits(values, panel.y_log)


def _limits(values: Sequence[NDArray[Any]], log: bool) -> tuple[float, float]:
    """Least and greatest with a margin; of positive values only on a logarithmic scale."""
    every = np.concatenate([np.asarray(v, dtype=np.float64) for v in values])
    every = every[np.isfinite(every) & ((every > 0) | (not log))]
    if not len(every):
        return (0.1, 1.0) if log else (0.0, 1.0)
    low, high = float(every.min()), float(every.max())
    if log:
        ratio = (high / low) ** 0.06 if high > low else 2.0
        return low / ratio, high * ratio
    margin = 0.06 * ((high - low) or abs(high) or 1.0)
    return low - margin, high + margin


def _low(trace: Trace) -> NDArray[Any]:
    """Lower ends of intervals; the scale has no place for 0."""
    assert trace.half is not None
    low: NDArray[Any] = np.maximum(trace.y - trace.half, 0.1 * trace.y)
    return low


def _figure(panel: Panel, linked: Range1d) -> figure:
    plot = figure(
        height=_HEIGHT,
        sizing_mode="stretch_width",
        x_axis_label=panel.x_label,
        y_axis_label=panel.y_label,
        x_axis_type="log" if panel.x_log else "linear",
        y_axis_type="log" if panel.y_log else "linear",
        x_range=linked if panel.linked else _x_range(panel),
        y_range=Range1d(*(panel.y_range or _y_limits(panel))),
        tools=[PanTool(), BoxZoomTool(), WheelZoomTool(), ResetTool(), SaveTool()],
        active_drag="auto",
        output_backend="canvas",
    )
    plot.toolbar.active_drag = plot.select_one(BoxZoomTool)
    plot.toolbar.logo = None
    plot.axis.axis_label_text_font_style = "normal"
    plot.yaxis.axis_label_standoff = 4
    plot.min_border_left = 62  # the plots stand in one line
    return plot


def _draw(
    plot: figure, trace: Trace, name: str, sources: dict[int, ColumnDataSource]
) -> GlyphRenderer[object]:
    if trace.kind == "steps":
        some = trace.y > 0
        return plot.quad(
            left=trace.x[:-1][some], right=trace.x[1:][some], top=trace.y[some], bottom=0,
            fill_color=trace.color, fill_alpha=0.3, line_color=trace.color, name=name,
        )  # fmt: skip
    # Signals over the same times are in one source, which holds the times once.
    source = sources.setdefault(id(trace.x), ColumnDataSource({"x": trace.x}))
    source.data[name] = trace.y
    if trace.kind == "line":
        return plot.line(
            "x", name, source=source, color=trace.color, line_width=trace.width, name=name
        )
    if trace.kind == "points":
        return plot.scatter("x", name, source=source, color=trace.color, alpha=0.6, name=name)
    assert trace.half is not None
    source.data[f"{name}-low"] = _low(trace)
    source.data[f"{name}-high"] = trace.y + trace.half
    plot.add_layout(
        Whisker(
            base="x", lower=f"{name}-low", upper=f"{name}-high", source=source, name=name,
            line_color=trace.color, upper_head=TeeHead(size=8, line_color=trace.color),
            lower_head=TeeHead(size=8, line_color=trace.color),
        )
    )  # fmt: skip
    plot.line("x", name, source=source, color=trace.color, name=name)
    return plot.scatter("x", name, source=source, color=trace.color, size=7, name=name)
