"""The symbols of the paper and the units, as figures and reports write them."""

from __future__ import annotations

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Quantity:
    """A quantity that has an axis or a row."""

    words: str
    math: str
    """Its symbol in the figures, which Matplotlib sets."""
    plain: str
    """The same in a page."""
    unit: str


QUANTITIES = {
    "sigma": Quantity("stiffness", r"\sigma", "\u03c3", "N.m/rad"),  # sigma
    "tau_e": Quantity("flexibility torque", r"\tau_e", "τₑ", "N.m"),
    "phi": Quantity("deformation", r"\phi", "φ", "rad"),
    "theta_dot": Quantity("motor velocity", r"\dot\theta", "θ̇", "rad/s"),
    "setPoint": Quantity("set-point", "s", "s", "1"),
    "t": Quantity("time", "t", "t", "s"),
}
"""By output of the estimator."""
_DIGITS = str.maketrans("23456789", "²³⁴⁵⁶⁷⁸⁹")


def math_axis(name: str) -> str:
    """Label of an axis in a figure: words, symbol and unit."""
    quantity = QUANTITIES[name]
    unit = quantity.unit.replace(".", r"$\cdot$")
    return f"{quantity.words} ${quantity.math}$ [{unit}]"


def plain_axis(name: str) -> str:
    """The same in a page."""
    quantity = QUANTITIES[name]
    return f"{quantity.words} {quantity.plain} [{plain_unit(quantity.unit)}]"


def plain_unit(unit: str) -> str:
    """A unit of the FMUs in a page: N·m for N.m, kg·m² for kg.m2."""
    powers = re.sub(r"(?<=[A-Za-z)])\d", lambda digit: digit[0].translate(_DIGITS), unit)
    return powers.replace(".", "·")


def plain_title(name: str, unit: str | None) -> str:
    """Title of a row or a column: symbol, or name, and unit."""
    symbol = QUANTITIES[name].plain if name in QUANTITIES else name
    return f"{symbol} [{plain_unit(unit)}]" if unit else symbol


def plain_text(text: str) -> str:
    """Words of the terminal in a page: symbols and powers as the paper writes them."""
    symbols = {name: q.plain for name, q in QUANTITIES.items() if len(name) > 1}
    symbols["setPoint"] = "set-point"
    text = re.sub(r"[A-Za-z_]+", lambda word: symbols.get(word[0], word[0]), text)
    text = re.sub(r"\^(\d)", lambda power: power[1].translate(_DIGITS), text)
    return text.replace("N.m", "N·m")
