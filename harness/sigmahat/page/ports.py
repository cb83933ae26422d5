"""The panels of a port: its column, unit, sign, and what else they need."""

from __future__ import annotations

from html import escape

from bokeh.models import Column, Div

from sigmahat.logs.configuration import FILL_IN
from sigmahat.page import edits
from sigmahat.page.edits import BY_SCALE, CHOICES, OF_PORT, PARAMETERS, UNITS
from sigmahat.page.inputs import Choice, Number, in_grid, style
from sigmahat.page.setup import Setup

_NONE = ""
_SIGNS = (("1", "+1"), ("-1", "-1: turned round"))


class PortPanel:
    """One port."""

    def __init__(self, setup: Setup, port: str) -> None:
        self._setup, self._port, self._where = setup, port, f"ports.{port}"
        columns = [(_NONE, "not used"), *((name, name) for name in setup.log.columns)]
        units = [*((unit, unit) for unit in UNITS[port]), (BY_SCALE, "a factor")]
        self._column = Choice("column", f"{self._where}.column", columns, self._name, self._named)
        self._unit = Choice(
            "unit",
            f"{self._where}.unit",
            units,
            self._unit_now,
            lambda unit: setup.set(f"{self._where}.unit", unit),
        )
        self._sign = Choice(
            "sign",
            f"{self._where}.sign",
            _SIGNS,
            lambda: f"{setup.get(f'{self._where}.sign') or 1:g}",
            lambda sign: setup.set(f"{self._where}.sign", int(sign)),
        )
        self._time = Choice(
            "its times",
            f"{self._where}.time",
            [(_NONE, "those of all"), *columns[1:]],
            lambda: setup.get(f"{self._where}.time") or _NONE,
            lambda name: setup.set(f"{self._where}.time", name or None),
        )
        self._numbers = [Number(setup, f"{self._where}.{f.key}", f) for f in OF_PORT]
        self._notes = Div(
            sizing_mode="stretch_width",
            styles={"color": "var(--soft)"},
            stylesheets=[style()],
        )
        self._details = Column(
            in_grid(
                [
                    self._unit.widget,
                    self._sign.widget,
                    *(each.widget for each in self._numbers),
                    self._time.widget,
                ],
                "8rem",
            ),
            self._notes,
            sizing_mode="stretch_width",
        )
        self.root = Column(
            self._column.widget, self._details, name=self._where, sizing_mode="stretch_width"
        )

    def show(self) -> None:
        """Shows the configuration as it is."""
        setup = self._setup
        self._column.widget.disabled = not setup.is_ready
        self._column.show()
        is_used = self._name() != _NONE
        self._details.visible = is_used
        if not is_used:
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

    def _named(self, name: str) -> None:
        self._setup.set_column(self._port, name or None)

    def _unit_now(self) -> str:
        if self._setup.get(f"{self._where}.scale") is not None:
            return BY_SCALE
        return str(self._setup.get(f"{self._where}.unit") or UNITS[self._port][0])

    def _comments(self) -> str:
        """What the guess is not sure of."""
        keys = ("unit", "sign", *(field.key for field in OF_PORT))
        found = (
            (key, edits.comment_of(self._setup.document, f"{self._where}.{key}")) for key in keys
        )
        said = ((key, comment.removeprefix(f"{FILL_IN}: ")) for key, comment in found if comment)
        return "".join(f"<small>{escape(key)}: {escape(words)}</small><br>" for key, words in said)


class ParameterPanel:
    """The time, and the parameters of the estimator."""

    def __init__(self, setup: Setup) -> None:
        self._setup = setup
        columns = [(_NONE, "none: sample period"), *((name, name) for name in setup.log.columns)]
        units = [(unit, unit) for unit in ("s", "ms", "us", "ns", "min")]
        self._choices = [
            Choice(
                "time",
                "time.column",
                columns,
                lambda: setup.get("time.column") or _NONE,
                lambda name: setup.set("time.column", name or None),
            ),
            Choice(
                "unit of time",
                "time.unit",
                units,
                lambda: setup.get("time.unit") or "s",
                lambda unit: setup.set("time.unit", unit),
            ),
            *(self._parameter(name) for name in CHOICES),
        ]
        self._numbers = [Number(setup, field.key, field) for field in PARAMETERS]
        self._widgets = [
            *(each.widget for each in self._choices),
            *(each.widget for each in self._numbers),
        ]
        self.root = in_grid(self._widgets, "8rem", name="parameters")

    def _parameter(self, name: str) -> Choice:
        options = [(item, item) for item in CHOICES[name]]
        choice = Choice(
            name,
            name,
            options,
            lambda: str(self._setup.get(name) or CHOICES[name][0]),
            lambda item: self._setup.set(name, item),
        )
        choice.widget.styles = {"grid-column": "1 / -1"}  # FilteredRegression needs the width
        return choice

    def show(self) -> None:
        """Shows the configuration as it is."""
        for widget in self._widgets:
            widget.disabled = not self._setup.is_ready
        for choice in self._choices:
            choice.show()
        for number in self._numbers:
            number.show()
