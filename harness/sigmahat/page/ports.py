"""The panels of ports and parameters: a port has its column, unit, sign, and other fields."""

from __future__ import annotations

from functools import partial
from html import escape

from bokeh.models import Column

from sigmahat.logs.configuration import FILL_IN
from sigmahat.page import edits
from sigmahat.page.edits import BY_SCALE, CHOICES, OF_PORT, PARAMETERS, UNITS
from sigmahat.page.inputs import Choice, Number, in_grid, words
from sigmahat.page.setup import Setup

_NONE = ""
_SIGNS = (("1", "+1"), ("-1", "-1: turned round"))


class PortPanel:
    """One port."""

    def __init__(self, setup: Setup, port: str) -> None:
        self._setup, self._port, self._where = setup, port, f"ports.{port}"
        names = [(name, name) for name in setup.log.columns]
        units = [*((unit, unit) for unit in UNITS[port]), (BY_SCALE, "a factor")]
        sign = f"{self._where}.sign"
        self._column = Choice(
            setup,
            "column",
            f"{self._where}.column",
            [(_NONE, "not used"), *names],
            current=self._name,
            chosen=lambda name: setup.set_column(port, name or None),
        )
        self._unit = Choice(setup, "unit", f"{self._where}.unit", units, current=self._unit_now)
        self._sign = Choice(
            setup,
            "sign",
            sign,
            _SIGNS,
            current=lambda: f"{setup.get(sign) or 1:g}",
            chosen=lambda item: setup.set(sign, int(item)),
        )
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
