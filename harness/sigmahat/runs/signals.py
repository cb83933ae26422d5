"""Signals of comparisons, "SOURCE.VARIABLE": their values, and the variables to record."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.master import Recording
from sigmahat.runs.scenario import Comparison

MOTION = ("phi", "theta_c")
"""Variables of the plant that have to be recorded."""
MODEL = "MODEL"
"""The estimator whose parameters model.* are the nominal data."""


def nominal_awas(recording: Recording) -> dict[str, NDArray[np.float64]]:
    """Lever arm r [m], flexibility torque tau_e [N.m] and stiffness sigma [N.m/rad].

    Each array has the shape (N + 1,) of the recording. The motion is the true motion of the plant,
    not the measured motion, because the estimate of MODEL is compared with the result.
    """
    data = recording.estimators[MODEL].parameters
    k_s, r_0, b = (float(data[f"model.{name}"]) for name in ("k_s", "r_0", "b"))
    phi, theta_c = (recording.plant[name] for name in MOTION)
    r = r_0 - b * theta_c  # (30)
    return {
        "r": r,
        "tau_e": k_s * r**2 * np.sin(2 * phi),  # (28)
        "sigma": 2 * k_s * r**2 * np.cos(2 * phi),  # (29)
    }


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
    """Variables that the comparisons need, by the plant or estimator that has the variables."""
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
