"""Draws the panels of a report with Bokeh.

The page gives the plots their switches and, through CSS, their colours.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from bokeh.models import BoxAnnotation, ColumnDataSource, Range1d, Span, TeeHead, Whisker
from bokeh.plotting import figure
from numpy.typing import NDArray

from sigmahat.show.panel import Panel, Trace, TraceKind
from sigmahat.show.style import around

_HEIGHT, _GREY = 300, "#888888"


def plots(
    panels: Sequence[Panel],
    marks: Sequence[float] = (),
    whole: tuple[float, float] | None = None,
) -> list[figure]:
    """The plots of panels; linked plots have dotted lines at `marks`, and `whole` shaded.

    All models of curve j of panel i have the name trace-i-j: page.html switches them by it.
    """
    sources: dict[int, ColumnDataSource] = {}
    times = [curve.x for panel in panels if panel.linked for curve in panel.curves]
    # All linked panels share one range object, so that the panels zoom together.
    linked = Range1d(float(times[0][0]), float(times[0][-1])) if times else Range1d()
    made = []
    for i, panel in enumerate(panels):
        plot = _figure(panel, linked)
        if panel.linked and whole is not None:
            low, high = whole
            plot.add_layout(BoxAnnotation(left=low, right=high, fill_color=_GREY, fill_alpha=0.12))
        for mark in marks if panel.linked else ():
            style = {"line_dash": "dotted", "line_color": _GREY}
            plot.add_layout(Span(location=mark, dimension="height", **style))
        for j, curve in enumerate(panel.curves):
            _draw(plot, curve, f"trace-{i}-{j}", sources)
        made.append(plot)
    return made


def _y_limits(panel: Panel) -> tuple[float, float]:
    # Computed here, because Bokeh would build a search tree of every curve.
    values = [curve.y for curve in panel.curves]
    for curve in panel.curves:
        if curve.kind is TraceKind.MEANS and curve.band is not None:
            values += curve.band
    if any(curve.kind is TraceKind.STEPS for curve in panel.curves):
        values.append(np.zeros(1))
    return _limits(values, panel.y_log)


def _limits(values: Sequence[NDArray[Any]], log: bool) -> tuple[float, float]:
    """Computes limits of an axis with a margin; a logarithmic scale uses positive values only."""
    if not log:
        return around(values, 0.06) or (0.0, 1.0)
    positive = np.concatenate([v[np.isfinite(v) & (v > 0)] for v in values])
    if not len(positive):
        return 0.1, 1.0
    low, high = float(positive.min()), float(positive.max())
    ratio = (high / low) ** 0.06 if high > low else 2.0
    return low / ratio, high * ratio


def _figure(panel: Panel, linked: Range1d) -> figure:
    xs = [curve.x for curve in panel.curves]
    plot = figure(
        height=_HEIGHT,
        sizing_mode="stretch_width",
        x_axis_label=panel.x_label,
        y_axis_label=panel.y_label,
        x_axis_type="log" if panel.x_log else "linear",
        y_axis_type="log" if panel.y_log else "linear",
        x_range=linked if panel.linked else Range1d(*_limits(xs, panel.x_log)),
        y_range=Range1d(*(panel.y_range or _y_limits(panel))),
        tools="pan,box_zoom,wheel_zoom,reset,save",
        active_drag="box_zoom",
        output_backend="canvas",
    )
    plot.toolbar.logo = None
    plot.axis.axis_label_text_font_style = "normal"
    plot.yaxis.axis_label_standoff = 4
    plot.min_border_left = 62  # the plots stand in one line
    return plot


def _draw(plot: figure, curve: Trace, name: str, sources: dict[int, ColumnDataSource]) -> None:
    if curve.kind is TraceKind.STEPS:
        some = curve.y > 0
        plot.quad(
            left=curve.x[:-1][some], right=curve.x[1:][some], top=curve.y[some], bottom=0,
            fill_color=curve.color, fill_alpha=0.3, line_color=curve.color, name=name,
        )  # fmt: skip
        return
    # Signals with the same times share one source, which has the times once.
    source = sources.setdefault(id(curve.x), ColumnDataSource({"x": curve.x}))
    source.data[name] = curve.y
    if curve.kind is TraceKind.LINE:
        _draw_line(plot, curve, name, source)
    elif curve.kind is TraceKind.POINTS:
        plot.scatter(
            "x", name, source=source, color=curve.color, alpha=0.6, size=3 * curve.width, name=name
        )
    else:
        _draw_means(plot, curve, name, source)


def _draw_line(plot: figure, curve: Trace, name: str, source: ColumnDataSource) -> None:
    """Draws a line in front of its band and its measured points; all parts have one name."""
    if curve.behind is not None:
        x, y = curve.behind
        style = {"color": curve.color, "alpha": 0.12, "line_color": None, "size": 3}
        plot.scatter(np.float32(x), np.float32(y), name=name, **style)
    dash = [round(curve.width * each) for each in curve.dash] or "solid"
    parts: list[Any] = [(np.ones(len(curve.x), np.bool_), 0.22, 1.0, dash)]
    if curve.within is not None:
        parts = [(parts[0][0], 0.08, 0.4, "dashed"), (curve.within, 0.18, 1.0, "solid")]
    for shown, of_band, of_line, dash in parts:
        own = source if shown.all() else ColumnDataSource({"x": curve.x[shown]})
        own.data[name] = curve.y[shown]
        if curve.band is not None:
            own.data[f"{name}-low"], own.data[f"{name}-high"] = (end[shown] for end in curve.band)
            plot.varea(
                "x", f"{name}-low", f"{name}-high", source=own,
                fill_color=curve.color, fill_alpha=of_band, name=name,
            )  # fmt: skip
        plot.line(
            "x", name, source=own, color=curve.color, line_width=curve.width, line_alpha=of_line,
            line_dash=dash, name=name,
        )  # fmt: skip


def _draw_means(plot: figure, curve: Trace, name: str, source: ColumnDataSource) -> None:
    """Whiskers, a line and points; all parts have one name, so that one switch is for all."""
    assert curve.band is not None
    source.data[f"{name}-low"], source.data[f"{name}-high"] = curve.band
    plot.add_layout(
        Whisker(
            base="x", lower=f"{name}-low", upper=f"{name}-high", source=source, name=name,
            line_color=curve.color, upper_head=TeeHead(size=8, line_color=curve.color),
            lower_head=TeeHead(size=8, line_color=curve.color),
        )
    )  # fmt: skip
    plot.line("x", name, source=source, color=curve.color, name=name)
    plot.scatter("x", name, source=source, color=curve.color, size=7, name=name)
