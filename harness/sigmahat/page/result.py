"""The panels of the results: torque and stiffness against deformation; findings of the checks."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from html import escape
from typing import TYPE_CHECKING

from bokeh.models import Column, Row, UIElement

from sigmahat.page.inputs import button, in_grid, words
from sigmahat.page.setup import Setup

if TYPE_CHECKING:
    from sigmahat.checks.findings import Checked, Finding
    from sigmahat.report.plots import Plot


class ResultPanel:
    """Results of `sigmahat estimate`."""

    def __init__(self, setup: Setup) -> None:
        self._setup = setup
        self._shown: object = self
        self._busy = words(name="busy", color="var(--soft)")
        self._plots = Column(name="plots", sizing_mode="stretch_width")
        self.root = Column(self._busy, self._plots, name="curve", sizing_mode="stretch_width")

    def show(self) -> None:
        """Shows the last curve, dimmed while another curve is computed."""
        setup = self._setup
        self._busy.text = escape(setup.busy)
        self._plots.styles = {"opacity": "0.45" if setup.busy else "1"}
        if setup.answer is self._shown:
            return
        self._shown = setup.answer
        self._plots.children = [] if setup.answer is None else self._panels()

    def _panels(self) -> list[UIElement]:
        from sigmahat.joint.curve import curve_text
        from sigmahat.logs.panels import curve_panels
        from sigmahat.report.plots import plots

        assert self._setup.answer is not None
        curve, points = self._setup.answer.curve, self._setup.answer.points
        if not curve.branches:
            return [words("No curve: the estimator learned nothing from the log.")]
        made = plots(list(curve_panels(curve, points)), None)
        # Before identify has chosen its order, the polynomial has more powers than the spring.
        text = "\n".join(curve_text(curve, self._setup.get("rls.n") is not None))
        return [
            words(_legend(made), overflow_x="auto"),
            in_grid([plot.figure for plot in made], "30rem"),
            words(f"<pre>{escape(text)}</pre>", overflow_x="auto"),
        ]


def _legend(made: Sequence[Plot]) -> str:
    """The colours, once for both plots, and what band and points are."""
    labels = "".join(
        f'<span style="color:{curve.color}">&#9632;</span> {escape(curve.label)} &nbsp; '
        for curve in made[0].panel.curves
    )
    return f"{labels}<small>{escape(made[0].panel.caption)}</small>"


class FindingsPanel:
    """Findings of `sigmahat check`."""

    def __init__(self, setup: Setup) -> None:
        self._setup = setup
        self._shown: tuple[object, ...] = ()
        self.root = Column(name="checks", sizing_mode="stretch_width")

    def show(self) -> None:
        """Shows the last check, until another check is complete."""
        setup = self._setup
        now = (setup.checked, setup.problem, tuple(setup.open_keys))
        if now == self._shown:
            return
        self._shown = now
        rows: list[UIElement] = []
        if setup.open_keys:
            rows.append(_line(f"Fill in: {', '.join(setup.open_keys)}.", "wrong"))
        elif setup.problem:
            rows.append(_line(f"Not checked: {setup.problem}.", "wrong"))
        if setup.checked is not None and not setup.open_keys:
            rows += self._findings(setup.checked)
        self.root.children = rows

    def _findings(self, checked: Checked) -> list[UIElement]:
        from sigmahat.checks.text import TITLES, nothing_found, sentence

        rows: list[UIElement] = []
        if not checked.is_wrong:
            rows.append(_line(nothing_found(checked), "fine"))
        for severity, title in TITLES.items():
            found = checked.of(severity)
            if found:
                kind = "wrong" if severity.value == "wrong" else "ink"
                rows.append(_line(title, kind, weight="600"))
                rows += [self._finding(each, sentence(each)) for each in found]
        return rows

    def _finding(self, finding: Finding, text: str) -> UIElement:
        """A sentence, and a button for each value that is proposed."""
        buttons = []
        for key, value in [(finding.key, finding.proposed), *finding.others]:
            if value is not None:
                shown = f"{value:.6g}" if isinstance(value, float) else value
                accept = partial(self._setup.set, key, value)
                buttons.append(button(f"accept {key}", accept, f"Set {key} = {shown}"))
        if not buttons:
            return _line(text)
        row = Row(*buttons, sizing_mode="stretch_width", styles={"flex-wrap": "wrap"})
        return Column(_line(text), row, sizing_mode="stretch_width")


def _line(text: str, kind: str = "ink", weight: str | None = None) -> UIElement:
    """A paragraph; kind is a colour of the page."""
    return words(escape(text), color=f"var(--{kind})", font_weight=weight)
