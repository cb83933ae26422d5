"""Scenarios as plain data: a plant, its inputs, estimators, and comparisons of their signals."""

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.master import EstimatorFmu, Plant, Recording

T = 1e-3  # sampling time of the paper [s], section VI.B


@dataclass(frozen=True)
class Sine:
    """amplitude sin(2 pi frequency t + phase)."""

    amplitude: float  #: Amplitude in the unit of the input.
    frequency: float  #: [Hz]
    phase: float = 0.0  #: [rad]

    def __call__(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.amplitude * np.sin(2 * math.pi * self.frequency * t + self.phase)


@dataclass(frozen=True)
class Sines:
    """Constant plus sines."""

    offset: float  #: Constant in the unit of the input.
    terms: Sequence[Sine]  #: Any number of sines.

    def __call__(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.offset + sum((term(t) for term in self.terms), np.zeros_like(t))


@dataclass(frozen=True)
class Comparison:
    """A comparison of two stiffnesses.

    A signal is `"SOURCE.VARIABLE"`: the source is "plant", an estimator, or "nominal", the AwAS
    as its nominal data describe it.
    """

    name: str  #: Row of the table.
    estimate: str  #: Signal that is judged.
    reference: str  #: Signal with which the estimate is compared.
    relative_to: str | None = None  #: Signal for relative errors; the reference if not given.


@dataclass(frozen=True)
class Scenario:
    """A simulation of a plant and its estimators."""

    name: str  #: Name for `sigmahat reproduce --scenario`, and for folders.
    description: str  #: One line.
    duration: float  #: Simulated time [s], a multiple of T.
    plant: Plant  #: The joint whose stiffness is estimated.
    estimators: Mapping[str, EstimatorFmu]  #: Estimators by modality.
    comparisons: Sequence[Comparison]
    """Rows of the table. The estimators in them are not variants."""
    figures: Sequence[str]  #: Names in sigmahat.paper.figures.FIGURES.
    variants: Mapping[str, EstimatorFmu] = field(default_factory=dict)
    """Further estimators, for the figures only."""
    paper: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Indices that the paper gives for a comparison: MSE [(N.m/rad)2], MSREP [%]."""
    settled: float = 1.0  #: Time after which an estimate is judged without its start-up [s].
    tables: Sequence[Sequence[str]] = (("mse", "msrep", "msrep_settled"),)
    """Columns of each printed table, fields of sigmahat.Indices."""
    T: float = T  #: Time between samples [s].

    @property
    def steps(self) -> int:
        """Number of sampling times T from the start to the end."""
        return round(self.duration / self.T)

    @property
    def fmus(self) -> list[str]:
        """The FMUs of plant and estimators, each once, in the order of their names."""
        of_estimators = (str(each.fmu) for each in self.estimators.values())
        return sorted({str(self.plant.fmu), *of_estimators})


MOTION = ("phi", "theta_c")  # variables of the plant that have to be recorded
MODEL = "MODEL"  # the estimator whose parameters model.* are the nominal data


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
    """Splits the name of a signal into source and variable."""
    source, _, variable = signal.rpartition(".")
    return source, variable


def signal_of(recording: Recording, signal: str) -> NDArray[Any]:
    """Returns the values of a signal, shape (N + 1,). Raises KeyError for an unrecorded signal."""
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
                needed.setdefault(MODEL, set())  # parameters of MODEL are the nominal data
            else:
                needed[source].add(variable)
    return needed
