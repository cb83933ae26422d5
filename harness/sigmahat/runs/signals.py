"""Signals of comparisons, "SOURCE.VARIABLE": their values, and what to record for them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from typing import Any

from numpy.typing import NDArray

from sigmahat.fmi.master import Recording
from sigmahat.runs.nominal_awas import MODEL, MOTION, nominal_awas
from sigmahat.runs.scenario import Comparison

PLANT, NOMINAL = "plant", "nominal"


def source_and_variable(signal: str) -> tuple[str, str]:
    """The two parts of a signal."""
    source, _, variable = signal.rpartition(".")
    return source, variable


def signal_of(recording: Recording, signal: str) -> NDArray[Any]:
    """The values of a signal, shape (N + 1,). Raises KeyError if it was not recorded."""
    source, variable = source_and_variable(signal)
    if source == NOMINAL:
        return nominal_awas(recording)[variable]
    series = recording.plant if source == PLANT else recording.estimators[source]
    return series[variable]


def to_record(comparisons: Iterable[Comparison]) -> dict[str, set[str]]:
    """Variables that the comparisons need, by the plant or estimator that they are recorded of."""
    needed: dict[str, set[str]] = defaultdict(set)
    for each in comparisons:
        for signal in (each.estimate, each.reference, each.relative_to):
            if signal is None:
                continue
            source, variable = source_and_variable(signal)
            if source == NOMINAL:
                needed[PLANT].update(MOTION)
                needed.setdefault(MODEL, set())  # its parameters are the nominal data
            else:
                needed[source].add(variable)
    return needed
