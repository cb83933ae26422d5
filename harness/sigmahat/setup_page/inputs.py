"""Parts of the page: texts, buttons, and inputs that are bound to keys of the configuration."""

import math
from collections.abc import Callable, Sequence
from typing import Any

from bokeh.models import Button, Div, InlineStyleSheet, Row, Select, TextInput, UIElement

from sigmahat.recording.configuration import FILL_IN
from sigmahat.setup_page.edits import GAMMA, Field
from sigmahat.setup_page.setup import Setup

STYLE = """
:host { --background-color: var(--box); --color: var(--ink); --border-color: var(--line);
  --inverted-color: var(--ink); --placeholder-color: var(--soft);
  --default: var(--box); --default-border: var(--line); --default-hover: var(--line);
  --default-hover-border: var(--line); --bokeh-font-size: 14px; min-width: 0; }
label { color: var(--soft); white-space: normal; }
.bk-input, .bk-btn { color: var(--ink); }
.bk-btn { white-space: normal; text-align: left; height: auto; }
.bk-btn-primary { color: #ffffff; }
select.bk-input { background-image: url('data:image/svg+xml;utf8,<svg version="1.1"\
 viewBox="0 0 25 20" xmlns="http://www.w3.org/2000/svg"><path d="M 0,0 25,0 12.5,20 Z"\
 fill="gray" /></svg>') !important; text-overflow: ellipsis; }
:host(.open) .bk-input { border-color: #e06a1a; box-shadow: inset 0 0 0 1px #e06a1a; }
"""
"""Style of the widgets in the colours of the page, by CSS variables of the page."""
_OPEN = "open"  # class of an input that has to be filled in


def style() -> InlineStyleSheet:
    return InlineStyleSheet(css=STYLE)


def words(html: str = "", name: str | None = None, **styles: str | None) -> Div:
    """Creates a text in HTML; `styles` are CSS properties, with "_" for "-"."""
    css: dict[str, str | None] = {"color": "var(--ink)", "overflow-wrap": "anywhere"}
    css |= {key.replace("_", "-"): value for key, value in styles.items()}
    return Div(text=html, name=name, sizing_mode="stretch_width", styles=css, stylesheets=[style()])


def button(name: str, clicked: Callable[[], object], label: str = "", **more: Any) -> Button:
    made = Button(label=label, name=name, stylesheets=[style()], **more)
    made.on_click(lambda: clicked())
    return made


def in_grid(children: Sequence[UIElement], least: str, name: str | None = None) -> Row:
    """Arranges elements in rows, as many as fit; a hidden element leaves no gap.

    least  width of a child, in CSS
    """
    columns = f"repeat(auto-fit, minmax(min(100%, {least}), 1fr))"
    css = f":host {{ display: grid; align-items: end; grid-template-columns: {columns}; }}"
    sheets = [InlineStyleSheet(css=css)]
    return Row(*children, name=name, sizing_mode="stretch_width", stylesheets=sheets)


class Input:
    """An input that is bound to a key of the configuration; text that is no number is refused."""

    def __init__(self, setup: Setup, key: str, field: Field) -> None:
        """Values that are not among the items of the field are added when they are shown."""
        self.field, self.key = field, key
        self._setup = setup
        self._shown = ""
        kind = Select if field.items else TextInput
        self.widget = kind(
            title=field.title, name=key, sizing_mode="stretch_width", stylesheets=[style()]
        )
        if field.items:
            self.widget.options = [*field.items]
        self.widget.on_change("value", self._changed)

    def show(self) -> None:
        value = self._setup.get(self.key)
        text = f"{value:.10g}" if isinstance(value, float) else str(value)
        if self.field.items:
            is_open = self.key in self._setup.open_keys and not self.key.endswith(".column")
            self._shown = self.field.default if value is None else text
            options = [*self.field.items]
            if is_open:
                self._shown = FILL_IN
                options.insert(0, (FILL_IN, "choose"))
            elif self._shown not in (each for each, _ in options):
                options.append((text, text))
            self.widget.options = options
            self.widget.css_classes = [_OPEN] if is_open else []
        else:
            is_open = self.key in self._setup.open_keys
            is_default = value is None or (value == 0 and self.key == GAMMA)
            self._shown = "" if is_default or is_open else text
            self.widget.placeholder = "fill in" if is_open else self.field.default
            self.widget.css_classes = [_OPEN] if is_open else []
        self.widget.value = self._shown

    def _changed(self, _attribute: str, _old: Any, new: str) -> None:
        text = new.strip()
        if text == self._shown:
            return
        try:
            value = self.field.kind(text) if text else None
        except ValueError:
            value = math.nan
        if isinstance(value, float) and not math.isfinite(value):
            self._setup.message = f"{self.key}: expected a number, got {text!r}"
            self._setup.show()
        else:
            self._setup.set(self.key, value)
