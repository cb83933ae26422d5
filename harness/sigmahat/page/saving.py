"""The bar at the end of the page: writes the file, and says what is next."""

from __future__ import annotations

from html import escape

from bokeh.models import Button, Div, Row

from sigmahat.page.inputs import style
from sigmahat.page.setup import Setup


class SavingBar:
    """Button and message."""

    def __init__(self, setup: Setup) -> None:
        self._setup = setup
        self._write = Button(button_type="primary", name="write", width=220, stylesheets=[style()])
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
        self._overwrite.visible = setup.asks_to_overwrite
        self._words.text = escape(setup.message)
        self._words.visible = bool(setup.message)
