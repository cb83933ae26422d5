"""The document of one window: the panels, and how they follow the setup."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from html import escape
from pathlib import Path
from typing import Protocol

from bokeh.core.templates import get_env
from bokeh.document import Document
from bokeh.events import DocumentReady
from bokeh.models import Button, Div, Row, UIElement
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from sigmahat.logs.configuration import PORTS
from sigmahat.page.edits import TITLES
from sigmahat.page.inputs import Choice, style
from sigmahat.page.look import HEIGHT, WIDTH
from sigmahat.page.ports import ParameterPanel, PortPanel
from sigmahat.page.result import FindingsPanel, ResultPanel
from sigmahat.page.setup import Setup

_TEMPLATES = Environment(
    loader=FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=StrictUndefined
)


class ColumnsPanel:
    """All columns."""

    def __init__(self, setup: Setup) -> None:
        self._setup = setup
        self.root = Div(name="columns", sizing_mode="stretch_width", stylesheets=[style()])

    def show(self) -> None:
        """Shows what is known of them."""
        setup = self._setup
        uses = {setup.get(f"ports.{port}.column"): port for port in PORTS}
        uses[setup.get("time.column")] = "time"
        self.root.text = _TEMPLATES.get_template("columns.html").render(
            columns=setup.log.columns, looks=setup.looks, uses=uses, width=WIDTH, height=HEIGHT
        )


class Headline:
    """The result in one line, on the first screen."""

    def __init__(self, setup: Setup) -> None:
        self._setup = setup
        styles: dict[str, str | None] = {"color": "var(--ink)", "font-weight": "700"}
        styles |= {"font-size": "1.15rem", "overflow-wrap": "anywhere"}
        self.root = Div(
            name="headline", sizing_mode="stretch_width", styles=styles, stylesheets=[style()]
        )

    def show(self) -> None:
        """Shows the last result, faded while another one is computed."""
        from sigmahat.joint.curve import headline

        setup = self._setup
        found = setup.answer
        self.root.text = "" if found is None else escape(headline(found.curve, found.doubt))
        self.root.styles = {**self.root.styles, "opacity": "0.45" if setup.busy else "1"}


class SavingBar:
    """Button and message."""

    def __init__(self, setup: Setup, estimate: Callable[[], object]) -> None:
        self._setup = setup
        self._estimate = Button(
            label="Identify and estimate",
            button_type="primary",
            name="estimate",
            width=220,
            stylesheets=[style()],
        )
        self._write = Button(name="write", width=180, stylesheets=[style()])
        self._estimate.on_click(lambda: setup.write(overwrite=False, then=estimate))
        self._overwrite = Button(
            label="Overwrite it", name="overwrite", width=130, stylesheets=[style()]
        )
        self._write.on_click(lambda: setup.write(overwrite=False))
        self._overwrite.on_click(lambda: setup.write(overwrite=True))
        self._words = Div(
            name="message",
            sizing_mode="stretch_width",
            styles={"color": "var(--ink)", "overflow-wrap": "anywhere", "min-width": "14rem"},
            stylesheets=[style()],
        )
        # Write stays where it is when the others come.
        flow: dict[str, str | None] = {"flex-wrap": "wrap-reverse"}
        self.root = Row(
            self._estimate,
            self._write,
            self._overwrite,
            self._words,
            name="bar",
            sizing_mode="stretch_width",
            styles=flow,
        )

    def show(self) -> None:
        """Shows whether there is something to write."""
        setup = self._setup
        self._write.label = f"Write {setup.path.name}"
        self._write.disabled = not setup.is_ready
        self._estimate.disabled = not setup.is_ready or bool(setup.open_keys or setup.problem)
        self._overwrite.visible = setup.asks_to_overwrite
        self._words.text = escape(setup.message)
        self._words.visible = bool(setup.message)


class Panel(Protocol):
    """A part of the page."""

    @property
    def root(self) -> UIElement:
        """Its model."""

    def show(self) -> None:
        """Follows the setup."""


class Window:
    """Shows a setup in a document."""

    def __init__(
        self,
        setup: Setup,
        document: Document,
        ready: Callable[[], object],
        estimate: Callable[[], object],
    ) -> None:
        """ready is called when the browser has drawn the page, estimate by the button."""
        self._setup, self._document = setup, document
        self._is_due = False
        self._joint = Choice("joint", "joint", [], lambda: setup.joint, setup.set_joint)
        self._file = Div(
            name="file", sizing_mode="stretch_width", stylesheets=[style()],
            styles={"color": "var(--ink)", "overflow-x": "auto"},
        )  # fmt: skip
        self._panels: Sequence[Panel] = (
            ColumnsPanel(setup),
            *(PortPanel(setup, port) for port in TITLES),
            ParameterPanel(setup),
            FindingsPanel(setup),
            ResultPanel(setup),
            SavingBar(setup, estimate),
            Headline(setup),
        )
        for panel in self._panels:
            document.add_root(panel.root)
        document.add_root(self._joint.widget)
        document.add_root(self._file)
        text = Path(__file__).with_name("page.html").read_text(encoding="utf-8")
        document.template = get_env().from_string(text)
        document.template_variables.update(log=setup.log.path.name, ports=TITLES)
        document.title = f"sigmahat: {setup.log.path.name}"
        self._show()
        document.on_event(DocumentReady, lambda _: ready())
        setup.subscribe(self._later)
        document.on_session_destroyed(lambda _: setup.unsubscribe(self._later))

    def _later(self) -> None:
        """Shows the setup as soon as the document may be changed; once for many changes."""
        if not self._is_due:
            self._is_due = True
            self._document.add_next_tick_callback(self._show)

    def _show(self) -> None:
        self._is_due = False
        setup = self._setup
        self._joint.widget.visible = len(setup.joints) > 1
        if setup.joints:
            self._joint.offer(list(setup.joints))
            self._joint.show()
        for panel in self._panels:
            panel.show()
        self._file.text = f"<pre>{escape(setup.text)}</pre>"
