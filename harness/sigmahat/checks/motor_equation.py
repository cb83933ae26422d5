"""Fits the motor equation to a log with little computation, for the checks of a configuration.

The equation is taken from `identify`, but with one form of friction and one filter. Therefore the
intervals are narrower than in `identify`. A delay delta of the torque has the time derivative of
the torque as regressor: tau(t - delta) = tau(t) - delta tau'(t).
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from sigmahat.checks.view import View
from sigmahat.motor import equation
from sigmahat.motor.coherence import coherent_range
from sigmahat.motor.equation import MOTOR, Equations, Fit, Form, Stribeck, extra, fit
from sigmahat.motor.noise import TorqueNoise, is_only_noise
from sigmahat.motor.spring import Spring
from sigmahat.recording.log import Array

LINEAR = "eta[0,0]"  # name of the regressor of the linear spring in a symmetric polynomial
_SLOWEST = 0.1  # largest sample period that still shows the motion of a joint [s]
_ORDERS = 3
_PARTS = 8  # number of parts of a log; each may have another spring
_SPARE = 6  # least number of blocks of a part in addition to the number of its columns
_STEPS = 4  # number of steps of Newton's method for the delay
LONGEST = 0.1  # largest delay [s]
_BETTER = 0.7
"""Largest ratio of the squared errors, after to before, if a change explains the log. A significant
difference is not sufficient: with unmodelled friction, nearly every change is significant."""


@dataclass(frozen=True)
class Fitted:
    form: Form  # orders and filters
    fit: Fit  # fit with a polynomial of these orders
    linear: Fit  # fit with a linear spring
    spring: Spring  # the polynomial

    def scores(self) -> dict[str, float]:
        """Returns determined coefficients of the linear spring fit, divided by half intervals."""
        value, half = self.linear.value, self.linear.half_width
        return {name: value[name] / half[name] for name in value if 0 < half[name] < math.inf}


def fitted(seen: View, f_0: float | None = None) -> Fitted | None:
    """Fits the motor equation, or with a torque sensor the spring alone.

    f_0  low pass of the equations [Hz]; None: the same choice as in identify

    Returns None without data, if the sample period is too long for the motion of a joint, or if the
    torque is only noise, as without current.
    """
    if seen.T > _SLOWEST or all(is_only_noise(piece.tau) for piece in seen.pieces):
        return None
    if f_0 is None:
        longest = max(seen.pieces, key=lambda piece: len(piece.theta))
        noise = TorqueNoise.of(longest.tau, longest.theta, seen.every, seen.T)
        limit = math.inf if seen.has_sensor else coherent_range(longest, seen.gamma, noise)
        f_0 = min(noise.bandwidth, limit)
    m_most = _ORDERS if np.ptp(seen.pieces[0].set_point) > 0 else 1
    symmetric = bool(seen.every["rls.symmetric"])
    form = Form(f_0, min(2.5 * f_0, equation.WIDEST / seen.T), _ORDERS, m_most)
    form, system = _chosen(seen, form if symmetric else form.with_all_powers())
    line = _equations(seen, replace(form, n=1, m=1, symmetric=True))
    whole = fit(system)
    return Fitted(form, whole, fit(line), Spring(form, whole, seen.pieces))


@dataclass(frozen=True)
class Corrected:
    """A value found by Newton's method, with its interval and the fit."""

    value: float
    half_width: float  # half of the 95 % interval
    fit: Fit  # fit of the motor equation with this value


def delay(seen: View, form: Form) -> Corrected | None:
    """Computes the delay of the torque [s]; None if no value is found.

    Each step of Newton's method shifts the torque until the coefficient of its derivative is 0.
    Therefore neither noise of the derivative nor curvature of the torque biases the result.
    """
    late = 0.0
    for _ in range(_STEPS):
        torques = [moved(piece.tau, late / seen.T) for piece in seen.pieces]
        shifted = [
            replace(piece, tau=tau, extra=-np.gradient(tau, seen.T)[:, None])
            for piece, tau in zip(seen.pieces, torques, strict=True)
        ]
        found = with_form(replace(seen, pieces=shifted), form)
        step, half_width = found.value[extra(0)], found.half_width[extra(0)]
        late += step
        if not math.isfinite(late) or abs(late) > LONGEST:
            return None
    return Corrected(late, half_width + abs(step), found) if math.isfinite(half_width) else None


def gear_error(seen: View, form: Form) -> Corrected | None:
    """Computes the configured gear ratio of theta divided by the true one; None if unknown.

    With theta (1 + delta) for theta, phi becomes phi - delta theta. The torque gets a term in
    theta, which is a regressor here. Newton's method corrects theta until this term vanishes. The
    spring has all powers, because a missing power would look like a term in theta.
    """
    whole = 1.0
    form = replace(form, n=_ORDERS).with_all_powers()
    for _ in range(_STEPS):
        scaled = []
        for each in seen.pieces:
            theta, phi = whole * each.theta, each.phi + (1 - whole) * each.theta
            scaled.append(replace(each, theta=theta, phi=phi, extra=theta[:, None]))
        system = _equations(replace(seen, pieces=scaled), form)
        found = fit(system)
        spring = found.value.get("eta[1,0]", 0.0) / system.units[0]  # coefficient of phi
        if not (spring and math.isfinite(found.half_width[extra(0)])):
            return None
        step, half_width = -found.value[extra(0)] / spring, abs(found.half_width[extra(0)] / spring)
        whole *= 1 + step
        if not 0.5 < whole < 2:
            return None
    return Corrected(whole, half_width + abs(step), found)


def variants(form: Form) -> list[Form]:
    """Returns forms of the equation that differ in the low pass, or in the model of friction."""
    return [
        replace(form, f_0=0.6 * form.f_0),
        replace(form, load_friction=True),
        replace(form, stribeck=(Stribeck(0.1, 2.0),)),
    ]


def with_form(seen: View, form: Form) -> Fit:
    return fit(_equations(seen, form))


def with_known(seen: View, form: Form, name: str, value: float) -> Fit:
    """Fits the motor equation with a known value of one coefficient of the motor."""
    return fit(_equations(seen, form).known(name, value))


def explains(before: Fit, after: Fit) -> bool:
    """Returns whether the errors after a change are significantly and much smaller."""
    return after.error < _BETTER * before.error and equation.is_worse(before, after)


def with_all_powers(seen: View, form: Form) -> Fit:
    return fit(_chosen(seen, replace(form, n=_ORDERS).with_all_powers())[1])


def error_of_parts(seen: View, form: Form) -> float:
    """Computes the sum of squared errors if spring and friction differ between parts of the log.

    The part with the largest errors is left out, because the spring may change in this part.
    """
    system = _equations(seen, form)
    number = min(_PARTS, len(system.rows) // (len(system.names) + _SPARE))
    errors = [fit(each).error for each in system.parts(max(number, 2))]
    return sum(errors) - max(errors)


def _chosen(seen: View, form: Form) -> tuple[Form, Equations]:
    """Chooses the polynomial orders that predict best, up to the orders of `form`."""
    form, _ = equation.choose(_equations(seen, form), form)
    return form, _equations(seen, form)


def _equations(seen: View, form: Form) -> Equations:
    every = equation.equations(seen.pieces, seen.T, seen.gamma, form)
    return every.without(MOTOR) if seen.has_sensor else every


def moved(signal: Array, ticks: float) -> Array:
    """Shifts a signal to earlier times by a number of ticks."""
    at = np.arange(len(signal), dtype=np.float64)
    return np.interp(at + ticks, at, signal)
