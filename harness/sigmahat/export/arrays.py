"""Arrays among the variables of a model description: elements are named ``eta[i,j]``, from 0."""

import re
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Array:
    """An array, or a variable alone, which has no dimensions."""

    name: str
    first: int
    """Place of its first element among the variables."""
    dimensions: tuple[int, ...]
    length: int
    """Number of its elements, which follow each other with the last index running fastest."""


def arrays(names: Sequence[str]) -> list[Array]:
    """The arrays that variables of these names form, in their order.

    Raises ``ValueError`` for elements that are missing, apart or in another order.
    """
    found: list[Array] = []
    place = 0
    while place < len(names):
        element = re.fullmatch(r"(.+)\[0(,0)*\]", names[place])
        if element is None:
            if names[place].endswith("]"):
                raise ValueError(f"{names[place]}: expected the elements before it in front of it")
            found.append(Array(names[place], place, (), 1))
        else:
            found.append(_array(element[1], place, names))
        place += found[-1].length
    return found


def _array(name: str, first: int, names: Sequence[str]) -> Array:
    indices = []
    for element in names[first:]:
        match = re.fullmatch(rf"{re.escape(name)}\[([\d,]+)\]", element)
        if match is None:
            break
        indices.append(tuple(int(i) for i in match[1].split(",")))
    dimensions = tuple(i + 1 for i in indices[-1])
    expected: list[tuple[int, ...]] = [()]
    for size in dimensions:
        expected = [(*index, i) for index in expected for i in range(size)]
    if indices != expected:
        raise ValueError(f"{name}: expected {len(expected)} elements in their order, got {indices}")
    return Array(name, first, dimensions, len(indices))
