"""Motor data with their intervals, from several fits of the motor equation."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sigmahat.identification import regression
from sigmahat.identification.quantities import Quantity
from sigmahat.identification.regression import MOTOR, Fit, Form, Signals, Stribeck
from sigmahat.identification.spring import Spring
from sigmahat.logs.log import Array

_UNITS = {"B": "kg.m2", "D_theta": "N.m.s/rad", "tau_coulomb": "N.m"}
_RELATIVE = 0.1  # largest half width of a determined value, over the value
_NEGLIGIBLE = 0.005  # the same for Coulomb friction, over the torque: it may be zero
_POWERS = 4
"""rls.n of every joint. FilteredRegression adds two more powers or knees if the data ask for them.
With 6, the interval of the stiffness is a quarter wider, and with 3 it holds fewer curves."""
_SAMPLING = {"B": 0.015, "tau_coulomb": 0.015, "D_theta": 0.001}
"""Relative error without any noise, at a period of 1 ms: reversals fall between samples."""
_OF_COVERED = 0.05  # largest half width of a known zero, over the covered deformation
_STRIBECK = tuple(
    Stribeck(v, delta) for v in (0.01, 0.02, 0.04, 0.08, 0.16, 0.32) for delta in (1.0, 2.0)
)
_ENDS = (0.0, -1.96, 1.96)  # value and ends of a known inertia, in standard deviations
_FAR = 5.0  # standard deviations of a known B that no error of a data sheet exceeds
_ANOTHER = 0.5  # relative error of B below which another scale of the torque is not likely
_N, _M = 4, 4  # highest orders of the polynomial that are tried


@dataclass(frozen=True)
class KnownInertia:
    """What is known of B from the configuration."""

    value: float  # [kg.m2]
    std: float  # standard deviation of its relative error, > 0

    def contradicts(self, found: Quantity) -> bool:
        """Whether B is so far off that the scale of the torque may be wrong. A wrong torque
        constant or gear ratio changes B and the stiffness by the same factor.
        """
        most = self.value * max(_FAR * self.std, _ANOTHER)
        return abs(found.value - self.value) - found.half_width > most


@dataclass(frozen=True)
class MotorFit:
    """Fit of the motor equation to the stretches of a log."""

    quantities: dict[str, Quantity]
    """B, D_theta and tau_coulomb, and the zero of the deformation where there is one."""
    gain: tuple[float, float]  # gain of a measured torque, half of its 95 % interval
    contradicted: bool
    """Whether the B of the log contradicts the known B. Then B counts as not determined, and the
    other quantities are identified with the known B."""
    polynomial: Form  # orders and symmetry of the polynomial for the estimator
    spring: float  # largest torque of the spring in the log [N.m]

    def torque_constant(self, nominal: float) -> Quantity:
        """K_t, if the pieces have the torque of a sensor and the current times a nominal K_t."""
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
    """Fits the motor equation with the orders of the polynomial that suit the pieces.

    T        time between samples [s]
    gamma    gear ratio
    f_0      low pass of the equations [Hz]
    inertia  what is known of B: if the pieces do not determine it, the other quantities are
             identified with this value
    """
    longest = max(pieces, key=lambda piece: len(piece.theta))
    m_most = _M if np.ptp(longest.set_point) > 0 else 1
    form = Form(f_0, min(2.5 * f_0, regression.WIDEST / T), n=_N, m=m_most)
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
    spring = Spring(form, fits.first, pieces)
    if "gain" not in fits.first.value:
        quantities["zero"] = _zero(spring, fits.others, gamma)
    gain = fits.first.value.get("gain", math.nan), _half_width("gain", fits)
    return MotorFit(quantities, gain, contradicted, polynomial, spring.largest(abs(gamma)))


def _with_spring(
    pieces: Sequence[Signals], T: float, gamma: float, form: Form, symmetric: bool
) -> tuple[Form, Form]:
    """The form with the polynomial that predicts best what was left out, up to its orders.

    The form has only odd powers unless all powers are significantly better: in slow motion, a more
    general spring leaves less information about friction.

    The second form is the one for the estimator. That form has _POWERS powers, even if the log
    shows little of them: with fewer powers, the interval would be too narrow.
    """

    def chosen(form: Form) -> tuple[Form, Array]:
        return regression.choose(regression.equations(pieces, T, gamma, form), form)

    odd, errors = chosen(form)
    if symmetric:
        return odd, replace(odd, n=_POWERS)
    every, errors_of_all = chosen(form.with_all_powers())
    best = every if regression.is_more(np.log(errors / errors_of_all)) else odd
    return best, replace(every, n=_POWERS, m=best.m)


@dataclass(frozen=True)
class Variants:
    """The fit of the equations, and fits of others with different uncertain assumptions.

    Where rounding matters, or friction is not of the form of the equation, the results differ by
    more than chance.
    """

    first: Fit
    others: Sequence[Fit]  # fits with other filters, or ends of a known inertia
    frictions: Sequence[Fit]  # fits with other forms of friction


def _frictions(plain: Form) -> list[Form]:
    """All other forms of friction than that of the plain equation."""
    load = replace(plain, load_friction=True)
    return [
        replace(plain, coulomb_velocity=regression.COULOMB_VELOCITY / 4),
        replace(plain, coulomb_velocity=regression.COULOMB_VELOCITY * 2),
        load,
        *(replace(each, stribeck=(one,)) for each in (plain, load) for one in _STRIBECK),
    ]


def _with_all_columns(form: Form) -> Form:
    return replace(form, load_friction=True, stribeck=_STRIBECK, delay=True)


def _variants(
    pieces: Sequence[Signals], T: float, gamma: float, form: Form, inertia: KnownInertia | None
) -> tuple[Variants, Variants | None]:
    """With the form of friction of the least errors, if the plain one is significantly worse.

    The torque may be late in all of them: where a hand moves the link, a delay looks like friction.

    The second fits use the known B, if there is one.
    """
    sensor = pieces[0].tau_e is not None
    widest = _with_all_columns(form)
    whole, names = regression.equations(pieces, T, gamma, widest), set(widest.names(sensor))

    def fits_of(each: Form) -> list[Fit]:
        """With B as unknown, then as known and at both ends of its interval."""
        if _with_all_columns(each) == widest:  # neither a filter nor v_s differs
            system = whole.without(names.difference(each.names(sensor)))
        else:
            system = regression.equations(pieces, T, gamma, each)
        ends = [] if inertia is None else [inertia.value * (1 + k * inertia.std) for k in _ENDS]
        return [regression.fit(each) for each in (system, *(system.known("B", B) for B in ends))]

    plain = replace(form, delay=True)
    every = {each: fits_of(each) for each in (plain, *_frictions(plain))}
    best = min(every, key=lambda each: np.nan_to_num(every[each][0].error, nan=np.inf))
    chosen = best if regression.is_worse(every[plain][0], every[best][0]) else plain
    filters = [
        fits_of(replace(chosen, wide=min(2 * form.wide, 2 * regression.WIDEST / T))),
        fits_of(replace(chosen, f_0=0.6 * form.f_0)),
    ]
    first = every.pop(chosen)
    free, *known = (
        Variants(first[i], [each[i] for each in filters], [each[i] for each in every.values()])
        for i in range(min(2, len(first)))
    )
    if not known:
        return free, None
    return free, replace(known[0], others=[*known[0].others, *first[2:]])


def _half_width(name: str, fits: Variants) -> float:
    """Half of the interval of the first fit, and the largest distance of the others.

    Another form of friction counts if it explains the log not significantly worse, and by the
    distance that its own uncertainty does not explain.
    """
    first = fits.first
    if not math.isfinite(first.value.get(name, math.nan)):
        return math.inf
    distances = [abs(other.value[name] - first.value[name]) for other in fits.others]
    for friction in fits.frictions:
        distance = abs(friction.value[name] - first.value[name]) - friction.half_width[name]
        if not regression.is_worse(friction, first):
            distances.append(max(distance, 0.0))
    distance = max(distances)
    return first.half_width[name] + (distance if math.isfinite(distance) else math.inf)


def _motor_quantity(name: str, fits: Variants, torque: float) -> Quantity:
    value = fits.first.value[name]
    negligible = _NEGLIGIBLE * torque if name == "tau_coulomb" else 0.0
    half_width = _half_width(name, fits) + _SAMPLING[name] * abs(value)
    return _quantity(value, half_width, _UNITS[name], negligible)


def _quantity(value: float, half_width: float, unit: str, negligible: float) -> Quantity:
    """negligible  half width below which any value is determined, be it zero"""
    determined = value > -negligible and half_width <= max(_RELATIVE * value, negligible)
    return Quantity(value, half_width, unit, bool(determined))


def _zero(spring: Spring, fits: Sequence[Fit], gamma: float) -> Quantity:
    """The deformation at which spring and constant torque cancel.

    It is determined if its interval is short compared with the covered deformation, and if the
    stiffness is positive. A negative stiffness means a wrong sign or gear ratio.
    """
    value, *others = (replace(spring, fit=each).zero() for each in (spring.fit, *fits))
    if not all(map(math.isfinite, [value, *others])):
        return Quantity(math.nan, math.inf, "rad", False)
    half_width = spring.half_width(value) + max(abs(other - value) for other in others)
    is_stiff = spring.slope(value) * gamma < 0
    is_narrow = half_width < _OF_COVERED * spring.covered
    return Quantity(value, half_width, "rad", bool(is_stiff and is_narrow))
