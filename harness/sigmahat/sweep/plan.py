"""The plan of a sweep: which runs it has, and in which order. And the outcome of a run.

Data alone: nothing here needs a scenario, an FMU or a file.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

from sigmahat.fmi.instance import Value
from sigmahat.runs.metrics import Indices
from sigmahat.sweep.values import Drawn, Values


@dataclass(frozen=True)
class Run:
    """One co-simulation; all that another process or machine needs to do it."""

    number: int
    scenario: str
    modalities: tuple[str, ...]
    """Empty: all that the scenario compares."""
    seed: int
    parameters: Mapping[str, Value]
    """By name with owner, "plant.motor.B"."""


@dataclass(frozen=True)
class Outcome:
    """The result of a run, or why there is none."""

    number: int
    """Of the run."""
    indices: Mapping[str, Indices]
    """By comparison; empty if the run failed."""
    failure: str | None
    """Why it failed: an FMU refused a value, or an estimate is not finite."""


@dataclass(frozen=True)
class Plan:
    """All runs of a sweep: for each scenario, each combination of listed values, each seed."""

    scenarios: tuple[str, ...]
    seeds: int
    modalities: tuple[str, ...]
    """Empty: all that the scenarios compare."""
    parameters: Mapping[str, Values]
    """By name with owner."""

    def __len__(self) -> int:
        return self.count

    @property
    def count(self) -> int:
        """Number of runs, also where it is too large for len()."""
        return len(self.scenarios) * self.seeds * math.prod(map(len, self.listed.values()))

    @property
    def listed(self) -> dict[str, tuple[Value, ...]]:
        """The parameters that are not drawn."""
        return {name: v for name, v in self.parameters.items() if not isinstance(v, Drawn)}

    @cached_property
    def runs(self) -> tuple[Run, ...]:
        """The runs in their order."""
        return tuple(self._runs())

    def _runs(self) -> Iterator[Run]:
        points = list(itertools.product(*self.listed.values()))
        numbers = itertools.count()
        for scenario, point, seed in itertools.product(
            self.scenarios, points, range(1, self.seeds + 1)
        ):
            listed = dict(zip(self.listed, point, strict=True))
            yield Run(next(numbers), scenario, self.modalities, seed, self._values(listed, seed))

    def _values(self, listed: Mapping[str, Value], seed: int) -> dict[str, Value]:
        return {
            name: values.value(name, seed) if isinstance(values, Drawn) else listed[name]
            for name, values in self.parameters.items()
        }

    def samples(self) -> Iterator[Run]:
        """Few runs with every scenario and every listed value, for a check before the start.

        The first run of each scenario, and that run with each other listed value.
        """
        for scenario in self.scenarios:
            first = next(replace(self, scenarios=(scenario,))._runs())
            yield first
            for name, values in self.listed.items():
                for value in values[1:]:
                    yield replace(first, parameters={**first.parameters, name: value})
