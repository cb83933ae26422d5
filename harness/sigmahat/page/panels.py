"""The panels of the page: ports and parameters, the resulting curve, findings of the checks."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from html import escape
from typing import TYPE_CHECKING

from bokeh.models import Column, Row, UIElement

from sigmahat.logs.configuration import FILL_IN
from sigmahat.page import edits
from sigmahat.page.edits import BY_SCALE, CHOICES, OF_PORT, PARAMETERS, UNITS
from sigmahat.page.inputs import Choice, Number, button, in_grid, words
from sigmahat.page.setup import Setup

if TYPE_CHECKING:
    from sigmahat.checks.findings import Checked, Finding
    from sigmahat.report.plots import Plot

_NONE = ""


class PortPanel:
    """One port."""

    def __init__(self, setup: Setup, port: str) -> None:
        self._setup, self._port, self._where = setup, port, f"ports.{port}"
        names = [(name, name) for name in setup.log.columns]
        units = [*((unit, unit) for unit in UNITS[port]), (BY_SCALE, "a factor")]
        column, sign = f"{self._where}.column", f"{self._where}.sign"
        self._column = Choice(
            setup, "column", column, [(_NONE, "not used"), *names],
            current=self._name, chosen=lambda name: setup.set_column(port, name or None),
        )  # fmt: skip
        self._unit = Choice(setup, "unit", f"{self._where}.unit", units, current=self._unit_now)
        self._sign = Choice(
            setup, "sign", sign, (("1", "+1"), ("-1", "-1: turned round")),
            current=lambda: f"{setup.get(sign) or 1:g}",
            chosen=lambda item: setup.set(sign, int(item)),
        )  # fmt: skip
        times = [(_NONE, "common times"), *names]
        self._time = Choice(setup, "times", f"{self._where}.time", times)
        self._numbers = [Number(setup, f"{self._where}.{f.key}", f) for f in OF_PORT]
        self._notes = words(color="var(--soft)")
        numbers = [each.widget for each in self._numbers]
        grid = in_grid([self._unit.widget, self._sign.widget, *numbers, self._time.widget], "8rem")
        self._details = Column(grid, self._notes, sizing_mode="stretch_width")
        self.root = Column(
            self._column.widget, self._details, name=self._where, sizing_mode="stretch_width"
        )

    def show(self) -> None:
        """Shows the configuration as it is."""
        setup = self._setup
        self._column.widget.disabled = not setup.is_ready
        self._column.show()
        self._details.visible = self._name() != _NONE
        if not self._details.visible:
            return
        for each in (self._unit, self._sign, self._time):
            each.show()
        unit = self._unit_now()
        for number in self._numbers:
            field, key = number.field, f"{self._where}.{number.field.key}"
            fits = (not field.units or unit in field.units) and (
                not field.ports or self._port in field.ports
            )
            number.widget.visible = fits or setup.get(key) is not None
            number.show()
        self._time.widget.visible = len(set(setup.log.columns.values())) > 1
        self._notes.text = self._comments()
        self._notes.visible = bool(self._notes.text)

    def _name(self) -> str:
        """The column that is chosen."""
        name = self._setup.get(f"{self._where}.column")
        return _NONE if name in (None, FILL_IN) else str(name)

    def _unit_now(self) -> str:
        if self._setup.get(f"{self._where}.scale") is not None:
            return BY_SCALE
        return str(self._setup.get(f"{self._where}.unit") or UNITS[self._port][0])

    def _comments(self) -> str:
        """Comments on uncertain guesses."""
        comment = partial(edits.comment_of, self._setup.document)
        keys = ("unit", "sign", *(field.key for field in OF_PORT))
        found = ((key, comment(f"{self._where}.{key}")) for key in keys)
        said = ((key, text.removeprefix(f"{FILL_IN}: ")) for key, text in found if text)
        return "".join(f"<small>{escape(key)}: {escape(text)}</small><br>" for key, text in said)


class ParameterPanel:
    """The time, and the parameters of the estimator."""

    def __init__(self, setup: Setup) -> None:
        self._setup = setup
        columns = [(_NONE, "none: sample period"), *((name, name) for name in setup.log.columns)]
        units = [(unit, unit) for unit in ("s", "ms", "us", "ns", "min")]
        self._inputs: list[Choice | Number] = [
            Choice(setup, "time", "time.column", columns),
            Choice(setup, "unit of time", "time.unit", units, "s"),
        ]
        for name, items in CHOICES.items():
            choice = Choice(setup, name, name, [(each, each) for each in items], items[0])
            choice.widget.styles = {"grid-column": "1 / -1"}  # FilteredRegression needs the width
            self._inputs.append(choice)
        self._inputs += [Number(setup, field.key, field) for field in PARAMETERS]
        self.root = in_grid([each.widget for each in self._inputs], "8rem", name="parameters")

    def show(self) -> None:
        """Shows the configuration as it is."""
        for each in self._inputs:
            each.widget.disabled = not self._setup.is_ready
            each.show()


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

        rows = [] if checked.is_wrong else [_line(nothing_found(checked), "fine")]
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
