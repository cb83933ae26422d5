"""Defines common parts of figures: colours, symbols with units, and limits of an axis."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

BLUE, VERMILION, GREEN, ORANGE = "#0072B2", "#D55E00", "#009E73", "#E69F00"
SKY, PURPLE, BLACK = "#56B4E9", "#CC79A7", "#000000"

CYCLE = (BLUE, VERMILION, GREEN, ORANGE, SKY, PURPLE, BLACK)  # neighbours are far apart
PAGE = Path(__file__).with_name("page.css")  # colours of a page and of its plots, light and dark


@dataclass(frozen=True)
class AxisQuantity:
    """A quantity with symbol and unit, for an axis of a plot or a row of a table."""

    words: str
    plain: str  # symbol in figures and pages
    unit: str


QUANTITIES = {
    "sigma": AxisQuantity("stiffness", "\u03c3", "N.m/rad"),  # sigma
    "tau_e": AxisQuantity("flexibility torque", "τₑ", "N.m"),
    "phi": AxisQuantity("deformation", "φ", "rad"),
    "theta_dot": AxisQuantity("motor velocity", "θ̇", "rad/s"),
    "setPoint": AxisQuantity("set-point", "s", "1"),
    "t": AxisQuantity("time", "t", "s"),
}
"""Quantities by the output of the estimator that has their values."""
_DIGITS = str.maketrans("23456789", "²³⁴⁵⁶⁷⁸⁹")


def plain_axis(name: str) -> str:
    quantity = QUANTITIES[name]
    return f"{quantity.words} {quantity.plain} [{plain_unit(quantity.unit)}]"


def plain_unit(unit: str) -> str:
    """Formats a unit of the FMUs for a page: N·m for N.m, kg·m² for kg.m2."""
    powers = re.sub(r"(?<=[A-Za-z)])\d", lambda digit: digit[0].translate(_DIGITS), unit)
    return powers.replace(".", "·")


def plain_title(name: str, unit: str | None) -> str:
    """Formats the title of a row or a column: symbol or name, and unit."""
    symbol = QUANTITIES[name].plain if name in QUANTITIES else name
    return f"{symbol} [{plain_unit(unit)}]" if unit else symbol


def plain_text(text: str) -> str:
    """Replaces names of a terminal text by the symbols and powers of the paper."""
    symbols = {name: q.plain for name, q in QUANTITIES.items() if len(name) > 1}
    symbols["setPoint"] = "set-point"
    text = re.sub(r"[A-Za-z_]+", lambda word: symbols.get(word[0], word[0]), text)
    text = re.sub(r"\^(\d)", lambda power: power[1].translate(_DIGITS), text)
    return text.replace("N.m", "N·m")


_OUTER = 0.5  # percent of the values at either end
_FURTHER = 0.5
"""Largest distance of shown values from the inner values, relative to the range of the latter."""


def limits(values: NDArray[Any]) -> tuple[float, float]:
    """Computes the range of the values that a plot shows; (0, 1) without finite values.

    The outermost percent, for example a spike after a gap, is cut off where it is far away.
    """
    finite = values[np.isfinite(values)]
    if not len(finite):
        return 0.0, 1.0
    low, high = np.percentile(finite, [_OUTER, 100 - _OUTER]).tolist()
    least, greatest = float(finite.min()), float(finite.max())
    if not high > low:
        return least, greatest
    further = _FURTHER * (high - low)
    return max(least, low - further), min(greatest, high + further)


def with_margin(low: float, high: float, share: float) -> tuple[float, float]:
    """Extends the limits of an axis by a margin at both ends, relative to the span."""
    margin = share * ((high - low) or abs(high) or 1.0)
    return low - margin, high + margin


def around(parts: Iterable[NDArray[Any]], share: float) -> tuple[float, float] | None:
    """Computes limits with a margin around all finite values; None without finite values."""
    values = np.concatenate([np.empty(0), *parts])
    values = values[np.isfinite(values)]
    return with_margin(float(values.min()), float(values.max()), share) if len(values) else None
