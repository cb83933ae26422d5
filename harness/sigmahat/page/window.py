"""The document of one window: panels that show the setup."""

from collections.abc import Callable, Sequence
from html import escape
from pathlib import Path

from bokeh.core.templates import get_env
from bokeh.document import Document
from bokeh.events import DocumentReady
from bokeh.models import Row
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from sigmahat.logs.configuration import PORTS
from sigmahat.page.edits import TITLES
from sigmahat.page.inputs import Choice, button, words
from sigmahat.page.panels import FindingsPanel, ParameterPanel, PortPanel, ResultPanel
from sigmahat.page.setup import Setup

_TEMPLATES = Environment(
    loader=FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=StrictUndefined
)


class SavingBar:
    """Buttons and a message."""

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
        """Updates the buttons and the message."""
        setup = self._setup
        self._write.label = f"Write {setup.path.name}"
        self._write.disabled = not setup.is_ready
        self._estimate.disabled = not setup.is_ready or bool(setup.open_keys or setup.problem)
        self._overwrite.visible = setup.asks_to_overwrite
        self._words.text = escape(setup.message)
        self._words.visible = bool(setup.message)


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
        self._setup, self._document, self._is_due = setup, document, False
        self._joint = Choice(
            setup, "joint", "joint", [], current=lambda: setup.joint, chosen=setup.set_joint
        )
        self._columns = words(name="columns")
        self._headline = words(name="headline", font_weight="700", font_size="1.15rem")
        self._file = words(name="file", overflow_x="auto")
        panels: Sequence[ParameterPanel | PortPanel | FindingsPanel | ResultPanel | SavingBar] = (
            *(PortPanel(setup, port) for port in TITLES),
            *(kind(setup) for kind in (ParameterPanel, FindingsPanel, ResultPanel)),
            SavingBar(setup, estimate),
        )
        self._panels = panels
        texts = (self._columns, self._headline, self._file, self._joint.widget)
        for root in (*texts, *(panel.root for panel in panels)):
            document.add_root(root)
        text = Path(__file__).with_name("page.html").read_text(encoding="utf-8")
        document.template = get_env().from_string(text)
        document.template_variables.update(log=setup.log.path.name, ports=TITLES)
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
        from sigmahat.joint.curve import headline

        self._is_due = False
        setup, answer = self._setup, self._setup.answer
        self._joint.widget.visible = len(setup.joints) > 1
        if setup.joints:
            self._joint.offer(list(setup.joints))
            self._joint.show()
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
        text = "" if answer is None else escape(headline(answer.curve, answer.doubt))
        wrong = [] if setup.checked is None else setup.checked.of(Severity.WRONG)
        if wrong:  # the result means nothing before this is mended
            text += f'<br><small style="color: var(--wrong)">{escape(sentence(wrong[0]))}</small>'
        self._headline.text = text
        self._file.text = f"<pre>{escape(setup.text)}</pre>"
