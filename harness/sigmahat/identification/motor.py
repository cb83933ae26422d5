"""Motor data with their intervals, from several fits of the motor equation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sigmahat.identification.orders import Orders, choose
from sigmahat.identification.quantities import Quantity
from sigmahat.identification.regression import Fit, Signals, equations, fit

_UNITS = {"B": "kg.m2", "D_theta": "N.m.s/rad", "tau_coulomb": "N.m"}
_WIDEST = 0.1
"""Of the sampling frequency: highest low pass of the velocity in the Coulomb friction."""
_RELATIVE = 0.1
"""Half width of the interval over the value, up to which the value is determined."""
_NEGLIGIBLE = 0.005
"""The same for Coulomb friction, over the torque: it may be determined to be zero."""
_SAMPLING = {"B": 0.015, "tau_coulomb": 0.015, "D_theta": 0.001}
"""Relative error without any noise, at a period of 1 ms: reversals fall between samples."""
_N, _M = 4, 4  # highest orders of the polynomial that are tried


@dataclass(frozen=True)
class MotorFit:
    """Fit of the motor equation to the stretches of a log."""

    found: Fit
    """Coefficients; their intervals hold for other filters too."""
    orders: Orders
    """Of the polynomial."""
    torque: float
    """Standard deviation of the torque of the motor [N.m]."""

    def quantity(self, name: str) -> Quantity:
        """B, D_theta or tau_coulomb."""
        negligible = _NEGLIGIBLE * self.torque if name == "tau_coulomb" else 0.0
        found = self.found
        return _quantity(found.value[name], found.half_width[name], _UNITS[name], negligible)

    def torque_constant(self, nominal: float) -> Quantity:
        """K_t, if the pieces have the torque of a sensor and the current times a nominal K_t."""
        value, half_width = self.found.value["gain"], self.found.half_width["gain"]
        return _quantity(value * nominal, half_width * nominal, "N.m/A", 0.0)


def fit_motor(
    pieces: Sequence[Signals], T: float, gamma: float, symmetric: bool, f_0: float
) -> MotorFit:
    """Fits the motor equation with the orders of the polynomial that suit the pieces.

    T      time between samples [s]
    gamma  gear ratio
    f_0    low pass of the equations [Hz]
    """
    longest = max(pieces, key=lambda piece: len(piece.theta))
    m_most = _M if np.ptp(longest.set_point) > 0 else 1
    wide = min(2.5 * f_0, _WIDEST / T)
    without_sensor = [replace(piece, tau_e=None) for piece in pieces]
    best, smallest = choose(
        equations(without_sensor, T, gamma, _N, m_most, symmetric, f_0, wide), _N, m_most
    )
    fits = [
        fit(equations(pieces, T, gamma, *best, symmetric, *filters))
        for filters in ((f_0, wide), (f_0, min(2 * wide, 2 * _WIDEST / T)), (0.6 * f_0, wide))
    ]
    torque = float(np.std(np.concatenate([piece.tau for piece in pieces])))
    return MotorFit(_with_spread(fits), smallest, torque)


def _with_spread(fits: Sequence[Fit]) -> Fit:
    """The first fit, its intervals widened by two errors that a single fit does not show.

    The first is the distance of the other fits, which have other filters: where rounding matters
    they differ by more than chance. The second is _SAMPLING, which is the same for all filters.
    """
    first = fits[0]
    half_width = {
        name: half
        + max(abs(other.value[name] - first.value[name]) for other in fits[1:])
        + _SAMPLING.get(name, 0.0) * abs(first.value[name])
        for name, half in first.half_width.items()
    }
    return replace(first, half_width=half_width)


def _quantity(value: float, half_width: float, unit: str, negligible: float) -> Quantity:
    """negligible  half width below which any value is determined, be it zero"""
    determined = value > -negligible and half_width <= max(_RELATIVE * value, negligible)
    return Quantity(value, half_width, unit, bool(determined))
