"""The result of an identification."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

WIDE = 1.0
"""Relative prior of motor data that the log does not determine. FilteredRegression would take a
prior of 0, the start value of prior.B, as exact; with 1 it accepts up to 4 times the value."""


@dataclass(frozen=True)
class Quantity:
    """One identified parameter with its 95 % interval, value +- half_width."""

    value: float
    """In its unit."""
    half_width: float
    """Half the width of the interval, in the same unit; inf if the motion does not show it."""
    unit: str
    """kg.m2 for B, N.m.s/rad for D_theta, N.m for tau_coulomb, rad for zero, N.m/A for
    torque_constant."""
    determined: bool
    """Whether the interval is narrow enough to use the value: within 10 % of it on either side, or
    for tau_coulomb within 0.5 % of the torque, for zero within 5 % of the covered deformation."""

    @property
    def interval(self) -> tuple[float, float]:
        """Both ends of the interval, in the same unit."""
        return self.value - self.half_width, self.value + self.half_width

    @property
    def told(self) -> bool:
        """The name of `determined` up to version 0.1."""
        warnings.warn("Quantity.told is now .determined", DeprecationWarning, stacklevel=2)
        return self.determined


@dataclass(frozen=True)
class Motion:
    """Sines of the motor, after its gear, that are added."""

    sines: Sequence[tuple[float, float]]
    """Amplitude [rad] and frequency [Hz] of each."""
    duration: float
    """[s]"""
    torque: float
    """Peak of the torque on the axis of the motor [N.m]."""
    reversals: int
    """Number of reversals of the motor."""


@dataclass(frozen=True)
class Advice:
    """What to record for a quantity that is not well known."""

    name: str
    """B, D_theta, tau_coulomb or stiffness."""
    known_to: float
    """Half of the 95 % interval over the value [1]; inf or nan if the log does not show it."""
    motion: Motion | None
    """None: no candidate makes it known, or the log does not show the spring at all."""
    would_be: float
    """The same as known_to after the motion, alone [1]."""


@dataclass(frozen=True)
class Identified:
    """Motor data, polynomial orders and noise, identified from a log."""

    quantities: Mapping[str, Quantity]
    """B, D_theta, tau_coulomb, zero of the deformation, and torque_constant if it was asked for."""
    n: int
    """For rls.n, see m."""
    m: int
    """For rls.m. The orders are the smallest whose error, in a cross-validation, is not
    significantly above that of the best ones."""
    tau_variance: float
    """Variance of the noise of the torque [(N.m)2]."""
    theta_variance: float
    """Variance of the noise of the motor position, rounding included [rad2]."""
    bandwidth: float
    """Bandwidth of a filter that balances both noises, or up to which the deformation is coherent
    with the torque, if that is lower [rad/s]."""
    coherent: float
    """Frequency above which the deformation is noise [Hz]; inf if there is none."""
    V_a: float
    """For filter.V_a [rad2/s4]."""
    phi: float
    """Largest magnitude of the deformation, from its zero [rad]."""
    zero: float
    """Deformation at which the spring has no torque [rad], where it is surely not 0; else 0."""
    set_point: float
    """Largest magnitude of the set-point [1]."""
    torque: float
    """Largest magnitude of the torque of the motor after its gear, or of the spring [N.m]."""
    B: float
    """That of the configuration [kg.m2]."""
    D_theta: float
    """That of the configuration [N.m.s/rad]."""
    notes: Sequence[str]
    """What had to be done to the samples of the log, in sentences."""
    advice: Sequence[Advice] = ()
    """What to record next, for each quantity that the log does not determine."""
