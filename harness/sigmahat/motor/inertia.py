"""The inertia of the motor, as far as the configuration gives it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sigmahat.fmi.model import Value
from sigmahat.motor.log_view import LogView
from sigmahat.motor.quantities import WIDE, Quantity
from sigmahat.recording.configuration import Configuration

_NORMAL_95 = 1.96  # half the width of a 95 % interval divided by the standard deviation
_FAR = 5.0  # largest plausible error of a known B, in standard deviations
_ANOTHER = 0.5  # smallest relative error of B that suggests a wrong scale of the torque


def is_inertia_given(configuration: Configuration, parameters: Mapping[str, Value]) -> bool:
    """Returns whether the configuration gives B, and not with the wide prior of an unknown B.

    parameters  all parameters of the estimator
    """
    return "motor.B" in configuration.parameters and float(parameters["prior.B"]) < WIDE


@dataclass(frozen=True)
class KnownInertia:
    """The inertia B from the configuration, with its uncertainty."""

    value: float  # [kg.m2]
    std: float  # standard deviation of the relative error of B, > 0

    @staticmethod
    def of(view: LogView) -> KnownInertia | None:
        """Returns the inertia of a configuration, if it is given with a prior above 0."""
        std = float(view.parameters["prior.B"])
        if not is_inertia_given(view.configuration, view.parameters) or not std > 0:
            return None
        return KnownInertia(float(view.parameters["motor.B"]), std)

    @property
    def interval(self) -> tuple[float, float]:
        """Both ends of the 95 % interval of B [kg.m2]."""
        half_width = _NORMAL_95 * self.std
        return self.value * (1 - half_width), self.value * (1 + half_width)

    def contradicts(self, found: Quantity) -> bool:
        """Returns whether the error of B is so large that the scale of the torque may be wrong. A
        wrong torque constant or gear ratio changes B and the stiffness by the same factor.
        """
        most = self.value * max(_FAR * self.std, _ANOTHER)
        return abs(found.value - self.value) - found.half_width > most
