"""Titles of columns and axes: a name and its unit, such as "sigma [N.m/rad]"."""

from __future__ import annotations


def title(name: str, unit: str | None) -> str:
    """Name and unit as one text; a quantity without a unit is its name alone."""
    return f"{name} [{unit}]" if unit else name


def name_and_unit(title: str) -> tuple[str, str | None]:
    """What title() was made of."""
    name, bracket, unit = title.rpartition(" [")
    return (name, unit.removesuffix("]")) if bracket else (title, None)
