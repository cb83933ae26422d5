"""The polynomial of the spring in a fit: where it is zero, and its largest torque."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sigmahat.identification.regression import CONSTANT, Fit, Form, Signals
from sigmahat.joint.sheet import powers_of_phi
from sigmahat.logs.log import Array

_USUAL = (0.005, 0.995)  # quantiles of the deformation, between which the polynomial is known


@dataclass(frozen=True)
class Spring:
    """Torque of the motor that balances the spring, as a polynomial of the fitted equations."""

    form: Form
    units: tuple[float, float]  # as in Equations

    def zero(self, fit: Fit, pieces: Sequence[Signals]) -> float:
        """Deformation at which spring and constant torque cancel [rad]; nan if there is none.

        It is the one nearest to the middle of the covered deformation, at the mean set-point.
        """
        polynomial = np.zeros(self._exponents[-1] + 1)
        polynomial[self._exponents] = self._at(_mean_set_point(pieces), fit)
        polynomial[0] += fit.value.get(CONSTANT, 0.0)
        if not np.all(np.isfinite(polynomial)):
            return math.nan
        roots = np.polynomial.polynomial.polyroots(np.trim_zeros(polynomial, "b"))
        real = np.real(roots[np.abs(np.imag(roots)) < 1e-9])
        if not len(real):
            return math.nan
        middle = np.mean([np.mean(piece.phi) for piece in pieces]) / self.units[0]
        return float(real[np.argmin(np.abs(real - middle))]) * self.units[0]

    def half_width(self, fit: Fit, zero: float, pieces: Sequence[Signals]) -> float:
        """Half of the 95 % interval of the zero [rad], to first order in the coefficients."""
        set_point, x = _mean_set_point(pieces), zero / self.units[0]
        by_eta = np.outer(x**self._exponents, self._of_set_point(set_point)).ravel()
        names = list(fit.value)
        gradient = np.zeros(len(names))
        gradient[-len(by_eta) :] = by_eta
        if CONSTANT in names:
            gradient[names.index(CONSTANT)] = 1.0
        slope = self.slope(fit, zero, pieces)
        if not abs(slope) > 0:
            return math.inf
        variance = float(gradient @ fit.covariance @ gradient)
        return fit.quantile * math.sqrt(variance) / abs(slope)

    def slope(self, fit: Fit, phi: float, pieces: Sequence[Signals]) -> float:
        """Slope of the motor torque over the deformation [N.m/rad], at the mean set-point.

        It is the stiffness over the gear ratio, with the other sign.
        """
        e, x = self._exponents, phi / self.units[0]
        coefficients = self._at(_mean_set_point(pieces), fit)
        return float(np.sum(e * x ** np.maximum(e - 1, 0) * coefficients)) / self.units[0]

    def largest(self, fit: Fit, pieces: Sequence[Signals], gamma: float) -> float:
        """Largest torque of the spring in the log, behind the gear [N.m]; nan if not known.

        A rare deformation, such as a blow, may be beyond what the polynomial was fitted to. There
        the torque is taken as proportional to the deformation.
        """
        if "gain" in fit.value:
            return math.nan
        eta, constant = self._eta(fit), fit.value.get(CONSTANT, 0.0)
        largest = 0.0
        for piece in pieces:
            usual = np.clip(piece.phi, *np.quantile(piece.phi, _USUAL))
            x = (usual / self.units[0])[:, None] ** self._exponents
            y = self._of_set_point(piece.set_point)
            torque = np.sum((x @ eta) * y, axis=1) + constant
            most = float(np.max(np.abs(usual)))
            beyond = float(np.max(np.abs(piece.phi))) / most if most > 0 else 1.0
            largest = max(largest, beyond * gamma * float(np.max(np.abs(torque))))
        return largest

    @property
    def _exponents(self) -> Array:
        return np.array(powers_of_phi(self.form.symmetric, self.form.n))

    def _of_set_point(self, set_point: Array | float) -> Array:
        """Powers of the set-point, the last axis of size m."""
        y: Array = (np.asarray(set_point) / self.units[1])[..., None] ** np.arange(self.form.m)
        return y

    def _eta(self, fit: Fit) -> Array:
        """[size: n, m]"""
        n, m = self.form.n, self.form.m
        return np.array([[fit.value[f"eta[{i},{j}]"] for j in range(m)] for i in range(n)])

    def _at(self, set_point: float, fit: Fit) -> Array:
        """Coefficients of the powers of the deformation at a set-point, [size: n]."""
        coefficients: Array = self._eta(fit) @ self._of_set_point(set_point)
        return coefficients


def _mean_set_point(pieces: Sequence[Signals]) -> float:
    return float(np.mean(np.concatenate([piece.set_point for piece in pieces])))
