"""Notes of `sigmahat identify` on what a log shows of the motor, as data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from sigmahat.recording.notes import Note


@dataclass(frozen=True, kw_only=True)
class SpringChanges(Note):
    """The stiffness changes within the log."""

    kind: Literal["spring_changes"] = "spring_changes"
    t: float  # time of the change since the start of the log [s]

    @property
    def in_words(self) -> str:
        return (
            f"the stiffness changes after {self.t:.4g} s of the log: identified with one spring "
            "before, and another one after it"
        )


@dataclass(frozen=True, kw_only=True)
class NoTorque(Note):
    """The torque of the motor is only noise."""

    kind: Literal["no_torque"] = "no_torque"

    @property
    def in_words(self) -> str:
        return (
            "the torque of the motor is only noise: such a log does not show its inertia and "
            "friction, and they have to be known for the stiffness; record with the motor on"
        )


@dataclass(frozen=True, kw_only=True)
class HiddenInertia(Note):
    """The log does not tell the inertia of the motor from the inertia of the load."""

    kind: Literal["hidden_inertia"] = "hidden_inertia"

    @property
    def in_words(self) -> str:
        return (
            "the deformation is proportional to the acceleration of the motor, but for the "
            "rounding of the encoders: the log cannot tell the inertia of the motor from the "
            "inertia of the load; record more frequencies, or give motor.B and prior.B"
        )


@dataclass(frozen=True, kw_only=True)
class ContradictedInertia(Note):
    """The log shows another inertia of the motor than the configuration, beyond its prior."""

    kind: Literal["contradicted_inertia"] = "contradicted_inertia"
    found: float  # by the log [kg.m2]
    configured: float  # motor.B [kg.m2]
    prior: float  # prior.B, relative standard deviation of motor.B [1]

    @property
    def in_words(self) -> str:
        return (
            f"the log shows B = {self.found:.3g} kg.m2 where motor.B is {self.configured:.3g}, "
            f"known to {100 * self.prior:.3g} %: it is not written, as the torque may have another "
            "scale than the configuration says; check torque_constant, unit and gear_ratio of tau, "
            "and motor.gamma, or remove motor.B"
        )
