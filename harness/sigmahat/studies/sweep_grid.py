"""The grid of a sweep: parameters and their values, and the runs in their order.

docs/sweeps.md has the forms of the values of a parameter.
"""

import itertools
import math
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from zlib import crc32

import numpy as np

from sigmahat.fmi.model import Value

_CALL = re.compile(r"\s*(\w+)\s*\(([^()]*)\)\s*")
_FORMS = "values 1,2,3; a range first:last:count; uniform(low,high); normal(mean,deviation)"


@dataclass(frozen=True)
class Drawn:
    """A parameter value that is drawn at random and depends only on the seed of the run."""

    kind: str  # uniform or normal
    first: float  # lower end, or mean
    second: float  # upper end, or standard deviation

    def value(self, name: str, seed: int) -> float:
        """Draws the value of a parameter for a seed; values of different names are independent."""
        generator = np.random.default_rng([seed, crc32(name.encode())])
        draw = generator.uniform if self.kind == "uniform" else generator.normal
        return float(draw(self.first, self.second))


Values = tuple[Value, ...] | Drawn


def values(text: str) -> Values:
    """Reads the values of a parameter. Raises ValueError, which says what is expected."""
    call = _CALL.fullmatch(text)
    if call is not None:
        return _drawn(text, call[1], call[2].split(","))
    if text.count(":") == 2:
        return _range(text)
    if any(not part.strip() for part in text.split(",")) or "(" in text:
        raise ValueError(f"expected {_FORMS}, got {text!r}")
    items = tuple(_literal(part) for part in text.split(","))
    item, count = Counter(items).most_common(1)[0]
    if count > 1:
        raise ValueError(f"{item!r} is given twice")
    return items


def _drawn(text: str, kind: str, arguments: Sequence[str]) -> Drawn:
    with suppress(ValueError):
        first, second = map(_finite, arguments)
        if {"uniform": first < second, "normal": second > 0.0}.get(kind):
            return Drawn(kind, first, second)
    raise ValueError(f"expected {_FORMS}, got {text!r}")


def _range(text: str) -> tuple[Value, ...]:
    first, last, count = text.split(":")
    try:
        ends, number = (_finite(first), _finite(last)), int(count)
    except ValueError as error:
        raise ValueError(f"expected {_FORMS}, got {text!r}") from error
    if not 2 <= number <= 1_000_000 or ends[0] == ends[1]:
        raise ValueError(f"expected a range of 2 or more different values, got {text!r}")
    return tuple(np.linspace(*ends, number).tolist())


def _literal(text: str) -> Value:
    text = text.strip()
    if text in ("true", "false"):
        return text == "true"
    for kind in (int, _finite):
        with suppress(ValueError):
            return kind(text)
    return text


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(text)
    return value


@dataclass(frozen=True)
class Run:
    """One co-simulation run, with all data that another process or machine needs for the run."""

    number: int
    scenario: str
    modalities: tuple[str, ...]  # estimators to run; empty: all that the scenario compares
    seed: int
    parameters: Mapping[str, Value]  # values by name with owner, "plant.motor.B"


@dataclass(frozen=True)
class Grid:
    """All runs of a sweep: for each scenario, each combination of listed values, each seed."""

    scenarios: tuple[str, ...]
    seeds: int
    modalities: tuple[str, ...]  # as in Run
    parameters: Mapping[str, Values]  # values by name with owner

    @property
    def count(self) -> int:
        """Number of runs."""
        return len(self.scenarios) * self.seeds * math.prod(map(len, self.listed.values()))

    @property
    def listed(self) -> dict[str, tuple[Value, ...]]:
        """Listed values of the parameters that are not drawn at random, by name."""
        return {name: v for name, v in self.parameters.items() if not isinstance(v, Drawn)}

    @cached_property
    def runs(self) -> tuple[Run, ...]:
        return tuple(self._runs())

    def _runs(self) -> Iterator[Run]:
        points = list(itertools.product(*self.listed.values()))
        combinations = itertools.product(self.scenarios, points, range(1, self.seeds + 1))
        for number, (scenario, point, seed) in enumerate(combinations):
            listed = dict(zip(self.listed, point, strict=True))
            values = {
                name: given.value(name, seed) if isinstance(given, Drawn) else listed[name]
                for name, given in self.parameters.items()
            }
            yield Run(number, scenario, self.modalities, seed, values)

    def samples(self) -> Iterator[Run]:
        """Selects few runs with every scenario and every listed value, for a check at the start.

        The first run of each scenario, and the same run with each other listed value.
        """
        for scenario in self.scenarios:
            first = next(replace(self, scenarios=(scenario,))._runs())
            yield first
            for name, values in self.listed.items():
                for value in values[1:]:
                    yield replace(first, parameters={**first.parameters, name: value})


_MOST = 1_000_000


def read_grid(
    scenarios: Sequence[str],
    seeds: int = 1,
    modalities: Sequence[str] = (),
    settings: Sequence[str] = (),
) -> Grid:
    """Reads a grid from the command line.

    modalities  as in Run
    settings    parameters, each "NAME=VALUES"; of those with one name, the last

    Raises ValueError, which names the place, for text that does not fit. Whether the names and
    values fit the scenarios is checked by sigmahat.studies.sweep.check.
    """
    parameters = {}
    for setting in settings:
        name, equals, text = map(str.strip, setting.partition("="))
        if not equals:
            raise ValueError(f"--set {setting}: expected NAME=VALUES")
        try:
            parameters[name] = values(text)
        except ValueError as error:
            raise ValueError(f"{name}: {error}") from error
    grid = Grid(tuple(scenarios), seeds, tuple(modalities), parameters)
    if grid.count > _MOST:
        raise ValueError(f"expected at most {_MOST} runs, got {grid.count}")
    for names in (grid.scenarios, grid.modalities):
        if len(set(names)) < len(names):
            raise ValueError(f"{', '.join(names)}: expected each name once")
    return grid
