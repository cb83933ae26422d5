"""The document of one window: panels that show the setup."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from bokeh.core.templates import get_env
from bokeh.document import Document
from bokeh.events import DocumentReady
from bokeh.models import Column, Row, Select, UIElement

from sigmahat.files.templates import environment
from sigmahat.guess.template import MEANINGS
from sigmahat.recording.configuration import FILL_IN, PORTS
from sigmahat.setup_page import edits
from sigmahat.setup_page.edits import BY_SCALE, OF_PORT, PARAMETERS, SIGN, UNITS, Field
from sigmahat.setup_page.inputs import Input, button, in_grid, style, words
from sigmahat.setup_page.setup import Setup
from sigmahat.show.style import PAGE

if TYPE_CHECKING:
    from sigmahat.checks.findings import Checked, Finding

_NONE = ""
_TEMPLATES = environment(Path(__file__).parent)


class PortPanel:
    def __init__(self, setup: Setup, port: str) -> None:
        self._setup, self._port, self._where = setup, port, f"ports.{port}"
        columns, units = edits.items(setup.log.columns), edits.items(UNITS[port])
        column, *others = (
            Input(setup, f"{self._where}.{field.key}", field)
            for field in (
                Field("column", "column", items=[(_NONE, "not used"), *columns], kind=str),
                Field("unit", "unit", UNITS[port][0], [*units, (BY_SCALE, "a factor")], str),
                SIGN,
                *OF_PORT,
                Field("time", "times", items=[(_NONE, "common times"), *columns], kind=str),
            )
        )
        self._column, self._others = column, others
        self._notes = words(color="var(--soft)")
        grid = in_grid([each.widget for each in others], "8rem")
        self._details = Column(grid, self._notes, sizing_mode="stretch_width")
        self.root = Column(
            column.widget, self._details, name=self._where, sizing_mode="stretch_width"
        )

    def show(self) -> None:
        setup = self._setup
        self._column.widget.disabled = not setup.is_ready
        self._column.show()
        self._details.visible = setup.get(self._column.key) is not None
        if not self._details.visible:
            return
        unit = setup.get(f"{self._where}.unit") or UNITS[self._port][0]
        notes = []  # on uncertain guesses
        for each in self._others:
            each.show()
            field = each.field
            fits = (not field.units or unit in field.units) and (
                not field.ports or self._port in field.ports
            )
            if field.key == "time":
                fits = len(set(setup.log.columns.values())) > 1
            each.widget.visible = fits or setup.get(each.key) is not None
            if said := edits.comment_of(setup.document, each.key):
                notes.append(escape(f"{field.key}: {said.removeprefix(f'{FILL_IN}: ')}"))
        self._notes.text = "".join(f"<small>{each}</small><br>" for each in notes)
        self._notes.visible = bool(notes)


class ParameterPanel:
    def __init__(self, setup: Setup) -> None:
        self._setup = setup
        columns = [(_NONE, "none: sample period"), *edits.items(setup.log.columns)]
        fields = (Field("time.column", "time", items=columns, kind=str), *PARAMETERS)
        self._inputs = [Input(setup, field.key, field) for field in fields]
        for each in self._inputs:
            if each.key in ("modality", "method"):  # FilteredRegression needs the width
                each.widget.styles = {"grid-column": "1 / -1"}
        self.root = in_grid([each.widget for each in self._inputs], "8rem", name="parameters")

    def show(self) -> None:
        for each in self._inputs:
            each.widget.disabled = not self._setup.is_ready
            each.show()


class ResultPanel:
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
        from sigmahat.result.curve import curve_text
        from sigmahat.result.log_panels import curve_panels
        from sigmahat.show.plots import plots

        assert self._setup.answer is not None
        curve, points = self._setup.answer.curve, self._setup.answer.points
        if not curve.branches:
            return [words("No curve: the log did not change the estimate.")]
        panels = list(curve_panels(curve, points))
        # The colours once for both plots, and what band and points are.
        legend = "".join(
            f'<span style="color:{each.color}">&#9632;</span> {escape(each.label)} &nbsp; '
            for each in panels[0].curves
        )
        # Before identify has chosen its order, the polynomial has more powers than the spring.
        text = "\n".join(curve_text(curve, self._setup.get("rls.n") is not None))
        return [
            words(f"{legend}<small>{escape(panels[0].caption)}</small>", overflow_x="auto"),
            in_grid(plots(panels), "30rem"),
            words(f"<pre>{escape(text)}</pre>", overflow_x="auto"),
        ]


class FindingsPanel:
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

        kind = "fine" if checked.fits else "ink"
        rows = [] if checked.is_wrong else [_line(nothing_found(checked), kind)]
        for severity, title in TITLES.items():
            found = checked.of(severity)
            if found:
                kind = "wrong" if severity.value == "wrong" else "ink"
                rows.append(_line(title, kind, weight="600"))
                rows += [self._finding(each, sentence(each)) for each in found]
        return rows

    def _finding(self, finding: Finding, text: str) -> UIElement:
        """Shows the sentence of a finding, and a button for each proposed value."""
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
    """Creates a paragraph; kind is a colour of the page."""
    return words(escape(text), color=f"var(--{kind})", font_weight=weight)


class SavingBar:
    def __init__(self, setup: Setup, estimate: Callable[[], object]) -> None:
        self._setup = setup
        self._estimate = button(
            "estimate", lambda: setup.write(overwrite=False, then=estimate),
            "Identify and estimate", button_type="primary", width=220,
        )  # fmt: skip
        self._write = button("write", lambda: setup.write(overwrite=False), width=180)
        self._overwrite = button(
            "overwrite", lambda: setup.write(overwrite=True), "Overwrite it", width=130
        )
        self._words = words(name="message", min_width="14rem")
        # The button Write keeps its place when other elements appear.
        self.root = Row(
            self._estimate, self._write, self._overwrite, self._words,
            name="bar", sizing_mode="stretch_width", styles={"flex-wrap": "wrap-reverse"},
        )  # fmt: skip

    def show(self) -> None:
        setup = self._setup
        self._write.label = f"Write {setup.path.name}"
        self._write.disabled = not setup.is_ready
        self._estimate.disabled = not setup.is_ready or bool(setup.open_keys or setup.problem)
        self._overwrite.visible = setup.asks_to_overwrite
        self._words.text = escape(setup.message)
        self._words.visible = bool(setup.message)


class Window:
    def __init__(
        self,
        setup: Setup,
        document: Document,
        ready: Callable[[], object],
        estimate: Callable[[], object],
    ) -> None:
        """ready is called when the browser has drawn the page, estimate by the button."""
        self._setup, self._document, self._is_due = setup, document, False
        self._joint = Select(
            title="joint", name="joint", sizing_mode="stretch_width", stylesheets=[style()]
        )
        self._joint.on_change("value", lambda _attribute, _old, name: setup.set_joint(name))
        self._columns = words(name="columns")
        self._headline = words(name="headline", font_weight="700", font_size="1.15rem")
        self._file = words(name="file", overflow_x="auto")
        panels: Sequence[ParameterPanel | PortPanel | FindingsPanel | ResultPanel | SavingBar] = (
            *(PortPanel(setup, port) for port in UNITS),
            *(kind(setup) for kind in (ParameterPanel, FindingsPanel, ResultPanel)),
            SavingBar(setup, estimate),
        )
        self._panels = panels
        texts = (self._columns, self._headline, self._file, self._joint)
        for root in (*texts, *(panel.root for panel in panels)):
            document.add_root(root)
        text = Path(__file__).with_name("page.html").read_text(encoding="utf-8")
        document.template = get_env().from_string(text)
        document.template_variables.update(
            log=setup.log.path.name,
            ports={port: MEANINGS[port] for port in UNITS},
            style=PAGE.read_text(encoding="utf-8"),
        )
        document.title = f"sigmahat: {setup.log.path.name}"
        self._show()
        document.on_event(DocumentReady, lambda _: ready())
        setup.windows.add(self._later)
        document.on_session_destroyed(lambda _: setup.windows.discard(self._later))

    def _later(self) -> None:
        """Shows the setup as soon as the document may be changed; once for many changes."""
        if not self._is_due:
            self._is_due = True
            self._document.add_next_tick_callback(self._show)

    def _show(self) -> None:
        from sigmahat.checks.findings import Severity
        from sigmahat.checks.text import sentence
        from sigmahat.result.headline import headline

        self._is_due = False
        setup, answer = self._setup, self._setup.answer
        self._joint.visible = len(setup.joints) > 1
        if setup.joints:
            self._joint.options, self._joint.value = list(setup.joints), setup.joint
        for panel in self._panels:
            panel.show()
        uses = {setup.get(f"ports.{port}.column"): port for port in PORTS}
        uses[setup.get("time.column")] = "time"
        self._columns.text = _TEMPLATES.get_template("columns.html").render(
            columns=setup.log.columns, looks=setup.looks, uses=uses
        )
        # The last result is dimmed while another result is computed.
        opacity = "0.45" if setup.busy else "1"
        self._headline.styles = {**self._headline.styles, "opacity": opacity}
        text = ""
        if answer is not None:
            text = escape(headline(answer.curve, answer.confidence, answer.changes))
        wrong = [] if setup.checked is None else setup.checked.of(Severity.WRONG)
        if wrong:  # the result means nothing before this is mended
            text += f'<br><small style="color: var(--wrong)">{escape(sentence(wrong[0]))}</small>'
        self._headline.text = text
        self._file.text = f"<pre>{escape(setup.text)}</pre>"
