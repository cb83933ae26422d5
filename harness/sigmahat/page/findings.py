"""The panel of the checks: what contradicts the log, with buttons that take what is proposed."""

from __future__ import annotations

from functools import partial
from html import escape
from typing import TYPE_CHECKING

from bokeh.models import Button, Column, Div, Row, UIElement

from sigmahat.page.inputs import style
from sigmahat.page.setup import Setup

if TYPE_CHECKING:
    from sigmahat.checks.findings import Checked, Finding


class FindingsPanel:
    """What `sigmahat check` says."""

    def __init__(self, setup: Setup) -> None:
        self._setup = setup
        self._shown: tuple[object, ...] = ()
        self.root = Column(name="checks", sizing_mode="stretch_width")

    def show(self) -> None:
        """Shows the last check; it stays until there is another one."""
        setup = self._setup
        now = (setup.checked, setup.problem, tuple(setup.open_keys))
        if now == self._shown:
            return
        self._shown = now
        rows: list[UIElement] = []
        if setup.open_keys:
            rows.append(_words(f"Fill in: {', '.join(setup.open_keys)}.", "wrong"))
        elif setup.problem:
            rows.append(_words(f"Not checked: {setup.problem}.", "wrong"))
        if setup.checked is not None and not setup.open_keys:
            rows += self._findings(setup.checked)
        self.root.children = rows

    def _findings(self, checked: Checked) -> list[UIElement]:
        from sigmahat.checks.text import TITLES, nothing_found, sentence

        rows: list[UIElement] = []
        if not checked.is_wrong:
            rows.append(_words(nothing_found(checked), "fine"))
        for severity, title in TITLES.items():
            found = checked.of(severity)
            if found:
                kind = "wrong" if severity.value == "wrong" else ""
                rows.append(_words(title, f"title {kind}"))
                rows += [self._finding(each, sentence(each)) for each in found]
        return rows

    def _finding(self, finding: Finding, text: str) -> UIElement:
        """A sentence, and a button for each value that is proposed."""
        proposals = [(finding.key, finding.proposed), *finding.others]
        buttons = []
        for key, value in proposals:
            if value is None:
                continue
            shown = f"{value:.6g}" if isinstance(value, float) else value
            button = Button(
                label=f"Set {key} = {shown}", name=f"accept {key}", stylesheets=[style()]
            )
            button.on_click(partial(self._setup.set, key, value))
            buttons.append(button)
        if not buttons:
            return _words(text)
        flow: dict[str, str | None] = {"flex-wrap": "wrap"}
        return Column(
            _words(text),
            Row(*buttons, sizing_mode="stretch_width", styles=flow),
            sizing_mode="stretch_width",
        )


def _words(text: str, kind: str = "") -> Div:
    """A paragraph."""
    styles: dict[str, str | None] = {"color": "var(--ink)", "overflow-wrap": "anywhere"}
    if "title" in kind:
        styles["font-weight"] = "600"
    if "wrong" in kind:
        styles["color"] = "var(--wrong)"
    if "fine" in kind:
        styles["color"] = "var(--fine)"
    return Div(text=escape(text), sizing_mode="stretch_width", styles=styles, stylesheets=[style()])
