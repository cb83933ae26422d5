"""A log or a robot may measure the deformation in place of a position: phi = q - theta."""

from collections.abc import Iterable, Mapping
from typing import TypeVar

from sigmahat.recording.log import Array

_Values = TypeVar("_Values", float, Array)


def missing_position(ports: Iterable[str]) -> str | None:
    """Returns the position that follows from phi, theta or q; None without phi."""
    given = set(ports)
    if "phi" not in given:
        return None
    return "q" if "theta" in given else "theta"


def with_positions(values: Mapping[str, _Values]) -> dict[str, _Values]:
    """Replaces the deformation by the position that follows from it, at its place.

    values  of the ports [rad, N.m], in which phi is allowed
    """
    missing = missing_position(values)
    if missing is None:
        return dict(values)
    found = {}
    for name, value in values.items():
        if name != "phi":
            found[name] = value
        elif missing == "q":
            found["q"] = values["theta"] + value
        elif "q" in values:
            found["theta"] = values["q"] - value
    return found
