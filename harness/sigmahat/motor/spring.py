"""Analyses the spring in a fit of the motor equation: zero and largest torque of the polynomial.

The module also finds springs that are no polynomial: a spring that changes during the log, and a
spring with a sudden change of slope, as in harmonic drives.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations

import numpy as np

from sigmahat.estimator.powers import powers_of_phi
from sigmahat.motor import equation, signals
from sigmahat.motor.equation import CONSTANT, Equations, Fit, Form
from sigmahat.motor.signals import Signals
from sigmahat.recording.log import Array

_USUAL = (0.005, 0.995)  # quantiles of the deformation between which the polynomial is valid
_OF_COVERED = 0.05
"""Smallest relevant error of the zero, and largest half width of a known zero, relative to the
range of the deformation."""


def covered(pieces: Sequence[Signals]) -> float:
    """Computes the range of the deformation in a log [rad]."""
    return float(np.ptp(np.concatenate([piece.phi for piece in pieces])))


def is_narrow(half_width: float, covered: float) -> bool:
    """Returns whether the interval of a zero is short compared with the range `covered` [rad]."""
    return half_width < _OF_COVERED * covered


def is_off(zero: float, half_width: float, covered: float) -> bool:
    """Returns whether the zero of the deformation is known, and is relevantly different from 0.

    zero, half_width  deformation without torque, and half of its 95 % interval [rad]
    covered           range of the deformation in the log [rad]
    """
    is_relevant = abs(zero) > max(half_width, _OF_COVERED * covered)
    return is_narrow(half_width, covered) and is_relevant


@dataclass(frozen=True)
class SpringFit:
    """Motor torque that balances the spring: the polynomial in a fit to stretches of a log."""

    form: Form
    fit: Fit
    pieces: Sequence[Signals]

    @cached_property
    def units(self) -> tuple[float, float]:
        """Divisors of deformation and set-point in the polynomial [rad, 1], as in Equations."""
        return signals.units(self.pieces)

    @property
    def covered(self) -> float:
        """Range of the deformation in the log [rad]."""
        return covered(self.pieces)

    def zero(self) -> float:
        """Computes the deformation at which spring and constant torque cancel [rad], else nan.

        Of several zeros, the nearest to the mean deformation is returned, at the mean set-point.
        """
        if self.form.symmetric:
            return self._zero_of_odd_powers()
        polynomial = np.zeros(self._exponents[-1] + 1)
        polynomial[self._exponents] = self._coefficients
        polynomial[0] += self.fit.value.get(CONSTANT, 0.0)
        if not np.all(np.isfinite(polynomial)):
            return math.nan
        roots = np.polynomial.polynomial.polyroots(np.trim_zeros(polynomial, "b"))
        real = np.real(roots[np.abs(np.imag(roots)) < 1e-9])
        if not len(real):
            return math.nan
        middle = np.mean([np.mean(piece.phi) for piece in self.pieces]) / self.units[0]
        return float(real[np.argmin(np.abs(real - middle))]) * self.units[0]

    def _zero_of_odd_powers(self) -> float:
        """Computes the zero from the constant torque of a fit with odd powers.

        To first order, a spring with its zero at z has the torque p(phi) - z p'(phi). The slope p'
        has even powers only, which the fit does not have: the constant is -z times the constant
        part of the slope. The slope of a spring that hardens is larger on average than at 0.
        """
        return -self.fit.value[CONSTANT] / self._constant_slope

    @cached_property
    def _constant_slope(self) -> float:
        """The constant in a fit of constant and odd powers to the slope of the spring, over the
        deformations of the log [N.m/rad]."""
        x = np.concatenate([piece.phi for piece in self.pieces]) / self.units[0]
        e = self._exponents
        slope = (e * x[:, None] ** np.maximum(e - 1, 0)) @ self._coefficients / self.units[0]
        columns = np.column_stack([np.ones_like(x), x[:, None] ** e])
        return float(np.linalg.lstsq(columns, slope, rcond=None)[0][0])

    def half_width(self, zero: float) -> float:
        """Computes half of the 95 % interval of the zero [rad], by linear error propagation."""
        if self.form.symmetric:
            return self.fit.half_width[CONSTANT] / abs(self._constant_slope)
        x = zero / self.units[0]
        by_eta = np.outer(x**self._exponents, self._of_set_point(self._set_point)).ravel()
        names = list(self.fit.value)
        gradient = np.zeros(len(names))
        gradient[-len(by_eta) :] = by_eta
        if CONSTANT in names:
            gradient[names.index(CONSTANT)] = 1.0
        slope = self.slope(zero)
        if not abs(slope) > 0:
            return math.inf
        variance = float(gradient @ self.fit.covariance @ gradient)
        return self.fit.quantile * math.sqrt(variance) / abs(slope)

    def slope(self, phi: float) -> float:
        """Computes the derivative of the motor torque with respect to the deformation [N.m/rad], at
        the mean set-point: the negative stiffness divided by the gear ratio."""
        e, x = self._exponents, phi / self.units[0]
        return float(np.sum(e * x ** np.maximum(e - 1, 0) * self._coefficients)) / self.units[0]

    def largest(self, gamma: float) -> float:
        """Computes the largest spring torque in the log at the gear output [N.m], nan if unknown.

        A rare deformation, as by an impact, may be outside of the range of the fit. For such a
        deformation the torque is assumed to be proportional to the deformation.
        """
        if "gain" in self.fit.value:
            return math.nan
        largest = 0.0
        for piece in self.pieces:
            usual = np.clip(piece.phi, *np.quantile(piece.phi, _USUAL))
            x = (usual / self.units[0])[:, None] ** self._exponents
            y = self._of_set_point(piece.set_point)
            torque = np.sum((x @ self._eta) * y, axis=1) + self.fit.value.get(CONSTANT, 0.0)
            most = float(np.max(np.abs(usual)))
            beyond = float(np.max(np.abs(piece.phi))) / most if most > 0 else 1.0
            largest = max(largest, beyond * gamma * float(np.max(np.abs(torque))))
        return largest

    @property
    def _exponents(self) -> Array:
        return np.array(powers_of_phi(self.form.symmetric, self.form.n))

    @cached_property
    def _set_point(self) -> float:
        return float(np.mean(np.concatenate([piece.set_point for piece in self.pieces])))

    def _of_set_point(self, set_point: Array | float) -> Array:
        """Computes the powers of the set-point; the last axis has the size m."""
        return (np.asarray(set_point) / self.units[1])[..., None] ** np.arange(self.form.m)

    @property
    def _eta(self) -> Array:
        """Coefficients of the polynomial [size: n, m]."""
        n, m = self.form.n, self.form.m
        return np.array([[self.fit.value[f"eta[{i},{j}]"] for j in range(m)] for i in range(n)])

    @property
    def _coefficients(self) -> Array:
        """Coefficients of the powers of the deformation at the mean set-point, [size: n]."""
        return self._eta @ self._of_set_point(self._set_point)


_PLACES = 16  # factor by which the step of the search for the time of a change is refined
_EXPLAINED = 0.3
"""Largest ratio of the squared errors with two springs and with one. After a change by a fifth, the
ratio is 0.04. Without a change, the ratio was 0.6 or more on 38 logs with unmodelled effects."""
_ORDER = 4  # powers of the torque of each of the two springs


def plain_equations(pieces: Sequence[Signals], T: float, gamma: float, f_0: float) -> Equations:
    """Computes equations with one spring of all powers, without set-point, else as fit_motor()."""
    form = Form.of_low_pass(f_0, T, n=_ORDER, symmetric=False)
    return equation.equations(pieces, T, gamma, form)


def change_of_spring(system: Equations, pieces: Sequence[Signals]) -> int | None:
    """Finds the sample after which another spring explains the log far better; None without such a
    sample, or with a set-point. With one spring, a change would falsify inertia and friction.

    Samples are counted over all stretches. The argument system is from plain_equations().
    """
    if signals.set_point_moves(pieces):
        return None
    scale = system.scale
    R = system.R / np.append(np.where(scale > 0, scale, 1.0), 1.0)
    spring = [system.names.index(name) for name in equation.eta(_ORDER, 1)]

    def error(place: int) -> float:
        """Computes the sum of squared errors with another spring from the block `place` on."""
        before, later = (
            equation.factor(part.reshape(-1, R.shape[2])) for part in (R[:place], R[place:])
        )
        one, other = np.concatenate([before, later]), np.concatenate([0 * before, later])
        both, y = np.column_stack([one[:, :-1], other[:, spring]]), one[:, -1]
        left = y - both @ np.linalg.lstsq(both, y, rcond=1e-10)[0]
        return float(left @ left)

    blocks = step = len(system.rows)
    best = 0
    while step > 1:
        step = max(1, step // _PLACES)
        near = range(best - _PLACES * step, best + _PLACES * step + 1, step)
        best = min((n for n in near if 0 < n < blocks), key=error)
    if not error(best) < _EXPLAINED * error(blocks):
        return None
    return int(system.rows[:best].sum())


def with_two_springs(pieces: Sequence[Signals], first: int) -> list[Signals]:
    """Adds regressors for a change of the spring torque, which are 0 before the sample `first`."""
    unit = signals.units(pieces)[0]
    begin = 0
    changed = []
    for piece in pieces:
        later = np.arange(begin, begin + len(piece.phi)) >= first
        powers: Array = np.vander(piece.phi / unit, _ORDER, increasing=True)
        changed.append(replace(piece, extra=powers * later[:, None]))
        begin += len(piece.phi)
    return changed


_SHARES = np.linspace(0.1, 0.9, 17)  # tried places of a knee, divided by the usual deformation
_NOT_RARE = 0.995  # quantile that defines the usual deformation
_FINER = np.linspace(-0.04, 0.04, 9)  # offsets of further tried places from the best place
_KNEES_APART = 0.1  # least distance of two knees, divided by the usual deformation
_LEAST_CHANGE = 0.25  # least ratio of the changes of slope at two knees
_MOST = 100_000  # largest number of samples that are used to find knees


def knees(
    pieces: Sequence[Signals], T: float, gamma: float, form: Form, zero: float
) -> tuple[float, ...]:
    """Finds up to two knees of the spring [rad from the zero], in increasing order.

    The motor equation gets a regressor max(|phi| - k, 0) sign(phi) for each knee k. The equation
    is linear in the coefficients. Therefore regressors of many places are filtered only once, and
    the equations are solved for each place and each pair of places. The equation also has the
    polynomial and the load friction of the estimator, which make the places more exact.

    T      time between samples [s]
    gamma  gear ratio
    form   polynomial of the estimator, and filters
    zero   deformation at which the spring has no torque [rad]
    """
    used, form = _first(pieces), replace(form, load_friction=True)
    phi = np.abs(np.concatenate([piece.phi for piece in used]) - zero)
    usual = float(np.quantile(phi, _NOT_RARE))

    def beyond(shares: Array) -> Equations:
        places, phis = shares * usual, [piece.phi[:, None] - zero for piece in used]
        columns = [phi - np.clip(phi, -places, places) for phi in phis]
        with_knees = [replace(p, extra=extra) for p, extra in zip(used, columns, strict=True)]
        return equation.equations(with_knees, T, gamma, form)

    coarse = beyond(_SHARES)
    best, fit = _least(coarse, _SHARES, 0)
    for number in (1, 2):
        near, _ = _least(coarse, _SHARES, number)
        shares = np.unique(np.add.outer(near, _FINER))
        better, other = _least(beyond(shares), shares, number)
        changes = [abs(x) for name, x in other.value.items() if name.startswith("extra")]
        # A second knee with a small change may only correct the place of the first knee.
        if not equation.is_worse(fit, other) or min(changes) < _LEAST_CHANGE * max(changes):
            break
        best, fit = better, other
    return tuple((best * usual).tolist())


def _least(e: Equations, shares: Array, number: int) -> tuple[Array, Fit]:
    """Finds the given number of knees with the least error; returns their places and the fit."""
    without_knees = e.names[: len(e.names) - len(shares)]

    def fitted(chosen: Sequence[int]) -> tuple[Array, Fit]:
        names = [*without_knees, *map(equation.extra, chosen)]
        return shares[list(chosen)], equation.fit(e.only(names))

    def error(places_and_fit: tuple[Array, Fit]) -> float:
        return float(np.nan_to_num(places_and_fit[1].error, nan=math.inf))

    tried = combinations(range(len(shares)), number)
    apart = (c for c in tried if np.all(np.diff(shares[list(c)]) >= _KNEES_APART))
    return min(map(fitted, apart), key=error)


def _first(pieces: Sequence[Signals]) -> list[Signals]:
    """Selects the first samples of a log, because more samples do not make the knees more exact.
    The sensor torque is removed, because the equation would have no polynomial otherwise."""
    used, left = [], _MOST
    for piece in pieces:
        if left > 0:
            used.append(replace(piece, tau_e=None)[:left])
            left -= len(piece.theta)
    return used
