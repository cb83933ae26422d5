"""Scenarios as plain data: plant, inputs, estimators, duration."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sigmahat.cosimulation import Estimator, Plant
from sigmahat.slave import Value
from sigmahat.suggest import unknown

T = 1e-3
"""Sampling time [s], section VI.B."""

_LEAD = 0.0025 / (2 * math.pi)  # b of (30) [m/rad]


@dataclass(frozen=True)
class Sine:
    """amplitude sin(2 pi frequency t)."""

    amplitude: float
    """In the unit of the input."""
    frequency: float
    """[Hz]"""

    def __call__(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.amplitude * np.sin(2 * math.pi * self.frequency * t)


@dataclass(frozen=True)
class Scenario:
    """One run of a plant and its estimators."""

    name: str
    description: str
    """One line."""
    duration: float
    """Simulated time [s], a multiple of T."""
    plant: Plant
    estimators: Mapping[str, Estimator]
    """By modality; the performance indices compare each with the plant."""
    variants: Mapping[str, Estimator] = field(default_factory=dict)
    """Further estimators, for the figures only."""
    paper: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Indices that the paper gives for a modality: MSE [(N.m/rad)2], MSREP [%]."""

    @property
    def steps(self) -> int:
        """Number of sampling times T from the start to the end."""
        return round(self.duration / T)


def _awas(retraction: float) -> Plant:
    """The AwAS under the torques of section VI.B, its lever arm shortened at first [m]."""
    return Plant(
        fmu="AwasPlant",
        start={"initial.theta_c": retraction / _LEAD},
        inputs={"tau": Sine(0.3, 0.1), "tau_c": Sine(8.0, 0.1)},
        record=(
            "q_measured",
            "theta_measured",
            "theta_c_measured",
            "tau_measured",
            "tau_e_measured",
            "theta_dot",
            "phi",
            "r",
            "tau_e",
            "sigma",
        ),
    )


def _estimator(start: Mapping[str, Value], sensor: str = "tau_e_measured") -> Estimator:
    """The estimator with the start values of its FMU but those given."""
    return Estimator(
        fmu="StiffnessEstimator",
        start={"samplePeriod": T, **start},
        connections={
            "theta": "theta_measured",
            "q": "q_measured",
            "theta_c": "theta_c_measured",
            "tau": "tau_measured",
            "tau_e_sensor": sensor,
        },
        record=(
            "sigma",
            "tau_e",
            "tau_e_residual",
            "theta_dot",
            "phi",
            "setPoint",
            "a",
            "rho",
            "epsilon",
            "valid",
        ),
    )


def _modalities(start: Mapping[str, Value]) -> dict[str, Estimator]:
    """The three modalities of section VI.B, and the modality Model of the FMU.

    The MODEL of the paper is fed with (28) at the actual deformation (its footnote 1), like a
    sensor without noise. The modality Model of the FMU has only the measured positions.
    """
    return {
        "MODEL": _estimator({"modality": "Sensor", **start}, sensor="tau_e"),
        "SENSOR": _estimator({"modality": "Sensor", **start}),
        "RESIDUAL": _estimator({"modality": "Residual", **start}),
        "MODEL-measured": _estimator({"modality": "Model", **start}),
    }


def _constant_factors(start: Mapping[str, Value]) -> dict[str, Estimator]:
    """RESIDUAL with constant stability factors, one too small and one too large, for figure 8."""
    return {
        f"RESIDUAL, a = {a:g}": _estimator(
            {"modality": "Residual", "rls.kind": "ConstantFactor", "rls.a": a, **start}
        )
        for a in (1e-4, 1e-2)
    }


_TABLE_I = {"MODEL": (24.1365, 0.12), "SENSOR": (24.3630, 0.12), "RESIDUAL": (128.1614, 0.58)}

_AS_PRINTED: dict[str, Value] = {"filter.weighting": "AsPrinted"}

SCENARIOS = {
    s.name: s
    for s in (
        Scenario(
            name="table1",
            description="AwAS from r(0) = 70 mm for 15 s: the conditions that give Table I",
            duration=15.0,
            plant=_awas(retraction=0.030),
            estimators=_modalities({}),
            variants=_constant_factors({}),
            paper=_TABLE_I,
        ),
        Scenario(
            name="as-printed",
            description="AwAS from r(0) = 130 mm for 20 s, velocity weighting as printed in (11)",
            duration=20.0,
            plant=_awas(retraction=-0.030),
            estimators=_modalities(_AS_PRINTED),
            variants=_constant_factors(_AS_PRINTED),
            paper=_TABLE_I,
        ),
    )
}
"""All scenarios by name."""


def scenario(name: str) -> Scenario:
    """Returns the scenario of that name. Raises ValueError if there is none."""
    if name not in SCENARIOS:
        raise ValueError(unknown("scenario", name, SCENARIOS))
    return SCENARIOS[name]
