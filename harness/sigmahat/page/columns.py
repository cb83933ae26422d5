"""The panel of the columns of the log: name, line, range, and the port that one feeds."""

from __future__ import annotations

from pathlib import Path

from bokeh.models import Div
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from sigmahat.logs.configuration import PORTS
from sigmahat.page.inputs import style
from sigmahat.page.look import HEIGHT, WIDTH
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
