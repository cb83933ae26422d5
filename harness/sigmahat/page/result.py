"""The panel of the answer: torque and stiffness over the deformation, with their bands."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING

from bokeh.models import Column, Div, UIElement

from sigmahat.page.inputs import in_grid, style
from sigmahat.page.setup import Setup

if TYPE_CHECKING:
    from sigmahat.report.plots import Plot


class ResultPanel:
    """What `sigmahat estimate` finds."""

    def __init__(self, setup: Setup) -> None:
        self._setup = setup
        self._shown: object = self
        self._busy = Div(name="busy", styles={"color": "var(--soft)"}, stylesheets=[style()])
        self._plots = Column(name="plots", sizing_mode="stretch_width")
        self.root = Column(self._busy, self._plots, name="curve", sizing_mode="stretch_width")

    def show(self) -> None:
        """Shows the last curve, faded while another one is computed."""
        setup = self._setup
        self._busy.text = escape(setup.busy)
        self._plots.styles = {"opacity": "0.45" if setup.busy else "1"}
        if setup.answer is self._shown:
            return
        self._shown = setup.answer
        self._plots.children = [] if setup.answer is None else self._panels()

    def _panels(self) -> list[UIElement]:
        from sigmahat.joint.curve_text import curve_text
        from sigmahat.report.curve_panels import curve_panels
        from sigmahat.report.plots import plots

        assert self._setup.answer is not None
        curve, points = self._setup.answer.curve, self._setup.answer.points
        if not curve.branches:
            nothing = "No curve: the estimator learned nothing from the log."
            return [_words(nothing)]
        made = plots(list(curve_panels(curve, points)), None)
        text = "\n".join(curve_text(curve))
        return [
            _words(_legend(made)),
            in_grid([plot.figure for plot in made], "30rem"),
            _words(f"<pre>{escape(text)}</pre>"),
        ]


def _legend(made: Sequence[Plot]) -> str:
    """The colours, once for both plots, and what band and points are."""
    labels = "".join(
        f'<span style="color:{curve.color}">&#9632;</span> {escape(curve.label)} &nbsp; '
        for curve in made[0].panel.curves
    )
    return f"{labels}<small>{escape(made[0].panel.caption)}</small>"


def _words(html: str) -> Div:
    styles: dict[str, str | None] = {"color": "var(--ink)", "overflow-x": "auto"}
    return Div(text=html, sizing_mode="stretch_width", styles=styles, stylesheets=[style()])
