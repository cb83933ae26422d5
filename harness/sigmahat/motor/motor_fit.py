"""Computes motor data with 95 % intervals, from several fits of the motor equation."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sigmahat.motor import equation
from sigmahat.motor.equation import MOTOR, Choice, Fit, Form
from sigmahat.motor.friction import frictions, slower, with_all_columns
from sigmahat.motor.inertia import KnownInertia
from sigmahat.motor.quantities import Quantity
from sigmahat.motor.signals import Signals, set_point_moves
from sigmahat.motor.spring import SpringFit, is_narrow

_UNITS = {"B": "kg.m2", "D_theta": "N.m.s/rad", "tau_coulomb": "N.m"}
_RELATIVE = 0.1  # largest half width of a determined value, relative to the value
_NEGLIGIBLE = 0.005  # largest half width of the Coulomb friction, relative to the torque
_POWERS = 4
"""Value of rls.n for every joint. FilteredRegression adds powers or knees if necessary. With 6, the
interval of the stiffness is a quarter wider; with 3, the interval contains fewer true curves."""
_SAMPLING = {"B": 0.015, "tau_coulomb": 0.015, "D_theta": 0.001}
"""Relative errors without noise, because reversals happen between samples of period 1 ms."""
_N, _M = 4, 4  # highest orders of the polynomial that are tried


@dataclass(frozen=True)
class MotorFit:
    """Fit of the motor equation to the stretches of a log."""

    quantities: dict[str, Quantity]
    """B, D_theta and tau_coulomb, and the zero of the deformation if it exists."""
    gain: tuple[float, float]  # gain of a measured torque, half of its 95 % interval
    contradicted: bool
    """Whether the B of the log contradicts the known B. In this case B counts as not determined,
    and the other quantities are identified with the known B."""
    polynomial: Form  # orders and symmetry of the polynomial for the estimator
    spring: float  # largest torque of the spring in the log [N.m]

    def torque_constant(self, nominal: float) -> Quantity:
        """Computes K_t from the gain of the sensor torque relative to nominal K_t times current."""
        value, half_width = self.gain
        return _quantity(value * nominal, half_width * nominal, "N.m/A", 0.0)


def fit_motor(
    pieces: Sequence[Signals],
    T: float,
    gamma: float,
    symmetric: bool,
    f_0: float,
    inertia: KnownInertia | None,
) -> MotorFit:
    """Fits the motor equation, and chooses the orders of the polynomial.

    T        time between samples [s]
    gamma    gear ratio
    f_0      low pass of the equations [Hz]
    inertia  known B: if the log does not determine B, the other quantities are identified with
             the known value
    """
    form = Form.of_low_pass(f_0, T, n=_N, m=_M if set_point_moves(pieces) else 1)
    without_sensor = [replace(piece, tau_e=None) for piece in pieces]
    form, polynomial = _with_spring(without_sensor, T, gamma, form, symmetric)
    torque = float(np.std(np.concatenate([piece.tau for piece in pieces])))
    fits, with_inertia = _variants(pieces, T, gamma, form, inertia)
    quantities = {name: _motor_quantity(name, fits, torque) for name in MOTOR}
    contradicted = inertia is not None and inertia.contradicts(quantities["B"])
    if contradicted:
        quantities["B"] = replace(quantities["B"], determined=False)
    if with_inertia is not None and not quantities["B"].determined:
        fits = with_inertia
        quantities |= {name: _motor_quantity(name, fits, torque) for name in MOTOR[1:]}
    spring = SpringFit(form, fits.first, pieces)
    if "gain" not in fits.first.value:
        quantities["zero"] = _zero(spring, fits, T, gamma)
    gain = fits.first.value.get("gain", math.nan), _half_width("gain", fits)
    return MotorFit(quantities, gain, contradicted, polynomial, spring.largest(abs(gamma)))


@dataclass(frozen=True)
class MeasuredSpring:
    """Fit of the spring to the torque of a sensor."""

    zero: Quantity  # deformation without torque
    polynomial: Form  # orders and symmetry of the polynomial for the estimator
    largest: float  # largest torque of the spring in the log [N.m]


def fit_spring(
    pieces: Sequence[Signals], T: float, gamma: float, symmetric: bool, f_0: float
) -> MeasuredSpring:
    """Fits the spring to the torque of a sensor, without a motor; arguments as of fit_motor()."""
    form = Form.of_low_pass(f_0, T, n=_N, m=_M if set_point_moves(pieces) else 1)
    form, polynomial = _with_spring(pieces, T, gamma, form, symmetric, without=MOTOR)
    assumptions = Assumptions([form, slower(form)], without=MOTOR)
    fits = Variants(*assumptions.fits(pieces, T, gamma), [], assumptions)
    spring = SpringFit(form, fits.first, pieces)
    zero = _zero(spring, fits, T, gamma)
    return MeasuredSpring(zero, polynomial, spring.largest(abs(gamma)))


def _with_spring(
    pieces: Sequence[Signals],
    T: float,
    gamma: float,
    form: Form,
    symmetric: bool,
    without: Collection[str] = (),
) -> tuple[Form, Form]:
    """Chooses the polynomial with the best predictions in a cross-validation, up to given orders.

    The first form has only odd powers unless all powers are significantly better: in slow motion, a
    more general spring leaves less information about friction.

    The second form is for the estimator, and always has _POWERS powers. With fewer powers, the
    interval of the stiffness would be too narrow.

    without  regressors that are left out
    """

    def chosen(form: Form) -> Choice:
        system = equation.equations(pieces, T, gamma, form)
        return equation.choose(system.without(without), form)

    odd = chosen(form)
    if symmetric:
        return odd.form, replace(odd.form, n=_POWERS)
    general = chosen(form.with_all_powers())
    is_general = equation.is_more(np.log(odd.errors / general.errors))
    best = general.form if is_general else odd.form
    return best, replace(general.form, n=_POWERS, m=best.m)


@dataclass(frozen=True)
class Assumptions:
    """Forms of the motor equation whose fits are compared, and held values of the inertia."""

    forms: Sequence[Form]  # the chosen form, then this form with other filters
    inertias: Sequence[float] = ()  # values of B, the most likely first; none: B is fitted
    without: Collection[str] = ()  # regressors that are left out

    def fits(self, pieces: Sequence[Signals], T: float, gamma: float) -> tuple[Fit, list[Fit]]:
        """Returns the fit of the first form with the first inertia, and the other fits."""
        first, *others = (
            equation.equations(pieces, T, gamma, form).without(self.without) for form in self.forms
        )
        if not self.inertias:
            return equation.fit(first), [equation.fit(other) for other in others]
        B, *ends = self.inertias
        held = [other.known("B", B) for other in others] + [first.known("B", end) for end in ends]
        return equation.fit(first.known("B", B)), [equation.fit(system) for system in held]


@dataclass(frozen=True)
class Variants:
    """A fit of the motor equation, and fits with other assumptions about filters and friction.

    The results differ by more than chance if rounding is relevant, or if the friction is of another
    form.
    """

    first: Fit
    others: Sequence[Fit]  # fits with other filters, or ends of a known inertia
    frictions: Sequence[Fit]  # fits with other forms of friction
    assumptions: Assumptions  # of first and others


def _variants(
    pieces: Sequence[Signals], T: float, gamma: float, form: Form, inertia: KnownInertia | None
) -> tuple[Variants, Variants | None]:
    """Fits the equation with all forms of friction, and chooses another form only if significant.

    All fits include a delay of the torque, which looks like friction if a hand moves the link.

    The second result has the fits with the known B, if a known B exists.
    """
    sensor = pieces[0].tau_e is not None
    widest = with_all_columns(form)
    whole, names = equation.equations(pieces, T, gamma, widest), set(widest.names(sensor))

    ends = [] if inertia is None else [inertia.value, *inertia.interval]

    def fits_of(other: Form) -> list[Fit]:
        """Fits with an unknown B, then with the known B and with both ends of its interval."""
        if with_all_columns(other) == widest:  # neither a filter nor v_s differs
            system = whole.without(names.difference(other.names(sensor)))
        else:
            system = equation.equations(pieces, T, gamma, other)
        return [equation.fit(e) for e in (system, *(system.known("B", B) for B in ends))]

    plain = replace(form, delay=True)
    fits = {other: fits_of(other) for other in (plain, *frictions(plain))}
    best = min(fits, key=lambda other: np.nan_to_num(fits[other][0].error, nan=np.inf))
    chosen = best if equation.is_worse(fits[plain][0], fits[best][0]) else plain
    wider = replace(chosen, wide=min(2 * form.wide, 2 * equation.WIDEST / T))
    forms = [chosen, wider, slower(chosen)]
    filters = [fits_of(other) for other in forms[1:]]
    first = fits.pop(chosen)
    free, *known = (
        Variants(
            first[i],
            [fit[i] for fit in filters],
            [fit[i] for fit in fits.values()],
            Assumptions(forms, ends if i else []),
        )
        for i in range(min(2, len(first)))
    )
    if not known:
        return free, None
    return free, replace(known[0], others=[*known[0].others, *first[2:]])


def _half_width(name: str, fits: Variants) -> float:
    """Adds half of the interval of the first fit and the largest distance of the other fits.

    A fit with another form of friction counts if its errors are not significantly larger. The
    distance of such a fit is reduced by half of its interval.
    """
    first = fits.first
    if not math.isfinite(first.value.get(name, math.nan)):
        return math.inf
    distances = [abs(other.value[name] - first.value[name]) for other in fits.others]
    for friction in fits.frictions:
        distance = abs(friction.value[name] - first.value[name]) - friction.half_width[name]
        if not equation.is_worse(friction, first):
            distances.append(max(distance, 0.0))
    distance = max(distances)
    return first.half_width[name] + (distance if math.isfinite(distance) else math.inf)


def _motor_quantity(name: str, fits: Variants, torque: float) -> Quantity:
    value = fits.first.value[name]
    negligible = _NEGLIGIBLE * torque if name == "tau_coulomb" else 0.0
    half_width = _half_width(name, fits) + _SAMPLING[name] * abs(value)
    return _quantity(value, half_width, _UNITS[name], negligible)


def _quantity(value: float, half_width: float, unit: str, negligible: float) -> Quantity:
    """negligible  half width below which any value counts as determined, even 0"""
    determined = value > -negligible and half_width <= max(_RELATIVE * value, negligible)
    return Quantity(value, half_width, unit, bool(determined))


def _zero(spring: SpringFit, fits: Variants, T: float, gamma: float) -> Quantity:
    """Computes the deformation at which spring and constant torque cancel.

    The zero is determined if its interval is short compared with the range of the deformation, and
    if the stiffness is positive. A negative stiffness means a wrong sign or gear ratio.
    """
    start, fitted_others = 0.0, fits.others
    if spring.form.symmetric and math.isfinite(spring.zero()):
        # The zero of a curved spring with odd powers is exact only if it is small: second step.
        start = spring.zero()
        pieces = [replace(piece, phi=piece.phi - start) for piece in spring.pieces]
        first, fitted_others = fits.assumptions.fits(pieces, T, gamma)
        spring = SpringFit(spring.form, first, pieces)
    value, *others = (replace(spring, fit=fit).zero() for fit in (spring.fit, *fitted_others))
    if not all(map(math.isfinite, [value, *others])):
        return Quantity(math.nan, math.inf, "rad", False)
    half_width = spring.half_width(value) + max(abs(other - value) for other in others)
    is_stiff = spring.slope(value) * gamma < 0
    is_known = is_stiff and is_narrow(half_width, spring.covered)
    return Quantity(start + value, half_width, "rad", bool(is_known))
