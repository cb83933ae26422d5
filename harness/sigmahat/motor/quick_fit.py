"""Fits the motor equation with one form of friction and one filter, to compare configurations.

The intervals are narrower than those of motor_fit.py, which fits many forms of friction. A delay
delta of the torque has the time derivative of the torque as regressor:
tau(t - delta) = tau(t) - delta tau'(t).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from sigmahat.motor import equation
from sigmahat.motor.coherence import pass_band
from sigmahat.motor.equation import MOTOR, Equations, Fit, Form, extra, fit
from sigmahat.motor.inertia import KnownInertia
from sigmahat.motor.log_view import LogView
from sigmahat.motor.noise import is_only_noise
from sigmahat.motor.signals import set_point_moves
from sigmahat.motor.spring import SpringFit

LINEAR = "eta[0,0]"  # name of the regressor of the linear spring in a symmetric polynomial
_SLOWEST = 0.1  # largest sample period that still shows the motion of a joint [s]
_ORDERS = 3
_PARTS = 8  # number of parts of a log; each may have another spring
_SPARE = 6  # least number of blocks of a part in addition to the number of its columns
_STEPS = 4  # number of steps of Newton's method for the delay
LONGEST_DELAY = 0.1  # [s]


@dataclass(frozen=True)
class QuickFit:
    """A fit of the motor equation, or with a torque sensor of the spring alone."""

    view: LogView
    form: Form  # orders and filters
    fit: Fit  # fit with a polynomial of these orders
    linear: Fit  # fit with a linear spring
    free: Fit  # fit with a linear spring, as if the configuration gave no inertia
    spring: SpringFit  # the polynomial

    @property
    def scores(self) -> dict[str, float]:
        """Determined coefficients of the fit with a linear spring, divided by half intervals."""
        return _scores(self.linear)

    @property
    def has_stiffness(self) -> bool:
        """Whether the log determines the stiffness of a linear spring."""
        return 0 < self.linear.half_width.get(LINEAR, math.inf) < math.inf

    @property
    def stiffness(self) -> float:
        """Stiffness of the linear spring, at the gear output [N.m/rad]."""
        return -self.view.gamma * self.slope

    @property
    def slope(self) -> float:
        """Torque of the linear spring on the motor's axis per deformation [N.m/rad]: the negative
        stiffness divided by the gear ratio."""
        return self.linear.value[LINEAR] / self.spring.units[0]

    @property
    def sign_of_motor(self) -> float:
        """Common sign of inertia and friction; 0 if the log does not determine it."""
        scores = _scores(self.free)
        signs = [np.sign(scores[name]) for name in MOTOR if abs(scores.get(name, 0.0)) > 1]
        return float(np.sign(sum(signs)))


def _scores(fit: Fit) -> dict[str, float]:
    return {
        name: value / fit.half_width[name]
        for name, value in fit.value.items()
        if 0 < fit.half_width[name] < math.inf
    }


def quick_fit(view: LogView, f_0: float | None = None) -> QuickFit | None:
    """Fits the motor equation, or with a torque sensor the spring alone.

    f_0  low pass of the equations [Hz]; None: the same choice as in identify

    Returns None without data, if the sample period is too long for the motion of a joint, or if the
    torque is only noise, as without current.
    """
    if view.T > _SLOWEST or all(is_only_noise(piece.tau) for piece in view.pieces):
        return None
    if f_0 is None:
        f_0 = pass_band(view, view.has_sensor).low_pass(view.T)
    m_most = _ORDERS if set_point_moves(view.pieces) else 1
    form = Form.of_low_pass(f_0, view.T, _ORDERS, m_most)
    is_symmetric = bool(view.parameters["rls.symmetric"])
    choice = _chosen(view, form if is_symmetric else form.with_all_powers())
    linear = replace(choice.form, n=1, m=1, symmetric=True)
    polynomial = fit(choice.equations)
    spring = SpringFit(choice.form, polynomial, view.pieces)
    line = with_form(view, linear)
    free = with_free_inertia(view, linear)
    return QuickFit(view, choice.form, polynomial, line, free, spring)


@dataclass(frozen=True)
class Corrected:
    """A value found by Newton's method, with its interval and the fit."""

    value: float
    half_width: float  # half of the 95 % interval
    fit: Fit  # fit of the motor equation with this value


def delay_of_torque(view: LogView, form: Form) -> Corrected | None:
    """Computes the delay of the torque [s]; None if no value is found.

    Each step of Newton's method shifts the torque until the coefficient of its derivative is 0.
    Therefore neither noise of the derivative nor curvature of the torque biases the result.
    """
    late = 0.0
    for _ in range(_STEPS):
        earlier = view.earlier("tau", late)
        pieces = [
            replace(piece, extra=-np.gradient(piece.tau, view.T)[:, None])
            for piece in earlier.pieces
        ]
        shifted = with_form(replace(view, pieces=pieces), form)
        step = shifted.value[extra(0)]
        half_width = shifted.half_width[extra(0)]
        late += step
        if not math.isfinite(late) or abs(late) > LONGEST_DELAY:
            return None
    if not math.isfinite(half_width):
        return None
    return Corrected(late, half_width + abs(step), shifted)


def gear_error(view: LogView, form: Form) -> Corrected | None:
    """Computes the configured gear ratio of theta divided by the true one; None if unknown.

    With theta (1 + delta) for theta, phi becomes phi - delta theta. The torque gets a term in
    theta, which is a regressor here. Newton's method corrects theta until this term vanishes. The
    spring has all powers, because a missing power would look like a term in theta.
    """
    ratio = 1.0
    form = replace(form, n=_ORDERS).with_all_powers()
    for _ in range(_STEPS):
        scaled = view.scaled("theta", ratio)
        pieces = [replace(piece, extra=piece.theta[:, None]) for piece in scaled.pieces]
        system = _equations(replace(view, pieces=pieces), form)
        corrected = fit(system)
        spring = corrected.value.get("eta[1,0]", 0.0) / system.units[0]  # coefficient of phi
        half_width = corrected.half_width[extra(0)]
        if not (spring and math.isfinite(half_width)):
            return None
        step = -corrected.value[extra(0)] / spring
        ratio *= 1 + step
        if not 0.5 < ratio < 2:
            return None
    return Corrected(ratio, abs(half_width / spring) + abs(step), corrected)


def with_form(view: LogView, form: Form) -> Fit:
    return fit(_equations(view, form))


def with_known_friction(view: LogView, form: Form, D_theta: float) -> Fit:
    """Fits the motor equation with a known viscous friction of the motor."""
    return fit(_equations(view, form).known("D_theta", D_theta))


def with_known_inertia(view: LogView, form: Form, B: float) -> Fit:
    """Fits the motor equation with a known inertia of the motor."""
    return fit(_free_equations(view, form).known("B", B))


def with_unknown_inertia(view: LogView) -> LogView:
    """Returns a log whose configuration gives no inertia of the motor."""
    given = view.configuration.parameters
    others = {name: value for name, value in given.items() if name != "motor.B"}
    return replace(view, configuration=replace(view.configuration, parameters=others))


def with_free_inertia(view: LogView, form: Form) -> Fit:
    """Fits the motor equation as if the configuration gave no inertia."""
    return fit(_free_equations(view, form))


def with_damped_spring(view: LogView, form: Form) -> Fit:
    """Fits the motor equation with a spring whose torque also has a damping."""
    pieces = [
        replace(piece, extra=np.gradient(piece.phi, view.T)[:, None]) for piece in view.pieces
    ]
    return with_form(replace(view, pieces=pieces), form)


def with_all_corrections(view: LogView, form: Form) -> Equations:
    """Computes equations that also have what a gear ratio or a delay that is slightly wrong does,
    with all powers of the spring, and as if the configuration gave no inertia."""
    pieces = []
    for piece in view.pieces:
        rates = [np.gradient(signal, view.T) for signal in (piece.phi, piece.tau)]
        of_torque = rates[: 1 if view.has_sensor else 2]
        pieces.append(replace(piece, extra=np.column_stack([piece.theta, *of_torque])))
    corrected = replace(view, pieces=pieces)
    return _free_equations(corrected, replace(form, n=_ORDERS).with_all_powers())


def with_all_powers(view: LogView, form: Form) -> Fit:
    return fit(_chosen(view, replace(form, n=_ORDERS).with_all_powers()).equations)


def error_of_parts(view: LogView, form: Form) -> float:
    """Computes the sum of squared errors if spring and friction differ between parts of the log.

    The part with the largest errors is left out, because the spring may change in this part.
    """
    system = _equations(view, form)
    number = min(_PARTS, len(system.rows) // (len(system.names) + _SPARE))
    errors = [fit(part).error for part in system.parts(max(number, 2))]
    return sum(errors) - max(errors)


def _chosen(view: LogView, form: Form) -> equation.Choice:
    """Chooses the polynomial orders that predict best, up to the orders of `form`."""
    return equation.choose(_equations(view, form), form)


def _equations(view: LogView, form: Form) -> Equations:
    """Computes the equations; an inertia that the configuration gives is held within its prior."""
    system = _free_equations(view, form)
    inertia = KnownInertia.of(view)
    if view.has_sensor or inertia is None:
        return system
    free = fit(system)
    B, half_width = free.value["B"], free.half_width["B"]
    low, high = inertia.interval
    if not half_width < (high - low) / 2:
        return system.known("B", inertia.value)  # the prior says more than the log
    return system if low < B < high else system.known("B", low if low > B else high)


def _free_equations(view: LogView, form: Form) -> Equations:
    system = equation.equations(view.pieces, view.T, view.gamma, form)
    return system.without(MOTOR) if view.has_sensor else system
