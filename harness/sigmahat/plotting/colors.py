"""Colours of Okabe and Ito, which differ for every kind of colour vision."""

from __future__ import annotations

BLUE, VERMILION, GREEN, ORANGE = "#0072B2", "#D55E00", "#009E73", "#E69F00"
SKY, PURPLE, BLACK = "#56B4E9", "#CC79A7", "#000000"

_CYCLE = (BLUE, VERMILION, GREEN, ORANGE, SKY, PURPLE, BLACK)  # neighbours are far apart


def cycle(count: int) -> list[str]:
    """Colours for so many lines; they begin again after the seventh."""
    return [_CYCLE[i % len(_CYCLE)] for i in range(count)]
