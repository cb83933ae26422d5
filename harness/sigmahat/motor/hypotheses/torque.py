"""Compares the torque with the motion, by the motor equation: signs, gear ratio, zero of the
deformation, delays, and inertia.

The order matters: with a wrong deformation or a wrong sign, further results mean nothing.
"""

import math
from dataclasses import dataclass

import numpy as np

from sigmahat.motor.equation import Fit, Form, explains
from sigmahat.motor.friction import few_frictions, slower
from sigmahat.motor.hypotheses.drive import drive
from sigmahat.motor.hypotheses.hypothesis import Evidence, Hypothesis, distance, gear_of_slope
from sigmahat.motor.hypotheses.positions import Positions, other_columns
from sigmahat.motor.hypotheses.slope import Slope
from sigmahat.motor.inertia import KnownInertia
from sigmahat.motor.log_view import LogView
from sigmahat.motor.quantities import WIDE
from sigmahat.motor.quick_fit import (
    LINEAR,
    LONGEST_DELAY,
    QuickFit,
    delay_of_torque,
    error_of_parts,
    gear_error,
    quick_fit,
    with_all_powers,
    with_damped_spring,
    with_form,
    with_free_inertia,
    with_known_friction,
    with_known_inertia,
    with_unknown_inertia,
)
from sigmahat.motor.spring import is_off
from sigmahat.recording.units import scale


@dataclass(frozen=True)
class Sign(Evidence):
    """A torque of the wrong sign: the stiffness would be `measured` [N.m/rad]."""

    power: float  # mean power that the motor would take from the joint [W]
    by_power: bool  # whether the power shows the sign, and the stiffness does not


@dataclass(frozen=True)
class Zero(Evidence):
    """Deformation at which the spring has no torque [rad]."""

    covered: float  # range of the deformation in the log [rad]
    torque: float  # torque of the spring at a deformation of this size, at the gear output [N.m]
    is_symmetric: bool  # whether the spring has odd powers alone


@dataclass(frozen=True)
class Delay(Evidence):
    """Delay of a column relative to the others [s]."""

    least: float
    """Least delay in the interval [s]: a magnitude for the torque, signed for the encoders."""
    error: float  # sum of the squared errors with this delay


@dataclass(frozen=True)
class Inertia(Evidence):
    """Inertia of the motor, another one than the configured one [kg.m2]."""

    given: float  # configured inertia [kg.m2]
    is_geared: bool  # whether a torque that is geared twice, or not at all, explains the ratio


@dataclass(frozen=True)
class TorqueEvidence:
    """What the torque shows against a configuration; None for what it does not contradict."""

    gear: Evidence | None = None  # slope of q on theta by a slightly wrong gear ratio [1]
    sign: Sign | None = None
    deformation: Evidence | None = None  # negative stiffness by a wrong deformation [N.m/rad]
    swap: Evidence | None = None  # negative stiffness by swapped positions [N.m/rad]
    zero: Zero | None = None
    asymmetry: Evidence | None = None  # ratio of the errors, without and with even powers [1]
    torque_delay: Delay | None = None
    encoder_delay: Delay | None = None  # of q relative to theta
    inertia: Inertia | None = None


def compare_torque(positions: Positions) -> TorqueEvidence:
    """Asks all that the motion in the log allows to ask about the torque."""
    view, fit = positions.view, positions.fit
    if fit is None or not fit.has_stiffness:
        return TorqueEvidence()
    inertia = None if view.has_sensor else _inertia(view, fit)
    if inertia is not None:  # held at the configured value, it would falsify all that follows
        view = with_unknown_inertia(view)
    elif KnownInertia.of(view) is not None:
        fit = quick_fit(view, fit.form.f_0)
        if fit is None or not fit.has_stiffness:
            return TorqueEvidence()
    if not positions.corrections and (gear := _gear(view, fit, positions.slope)) is not None:
        return TorqueEvidence(gear=gear)
    if -np.sign(view.gamma) * fit.scores[LINEAR] < -1:
        return _negative_stiffness(view, fit)
    if not view.has_sensor and fit.sign_of_motor < 0 and _is_driven(view):
        return TorqueEvidence(sign=_other_sign(view, fit, by_power=True))
    zero = _zero(view, fit)
    asymmetry = None if zero is not None else _asymmetry(view, fit)
    if view.has_sensor:
        return TorqueEvidence(zero=zero, asymmetry=asymmetry)
    of_torque, of_encoder = _delay_of_torque(view, fit), _delay_of_encoder(view, fit)
    if of_torque is not None and of_encoder is not None:
        # A late link position has the same effect as an early torque, and the other way round.
        if of_torque.measured > 0 and of_torque.error < of_encoder.error:
            of_encoder = None
        else:
            of_torque = None
    return TorqueEvidence(
        zero=zero,
        asymmetry=asymmetry,
        torque_delay=of_torque,
        encoder_delay=of_encoder,
        inertia=inertia,
    )


def _negative_stiffness(view: LogView, fit: QuickFit) -> TorqueEvidence:
    """Finds a torque of wrong sign, or a wrong deformation if only the stiffness is negative."""
    if view.has_sensor or fit.sign_of_motor < 0:
        return TorqueEvidence(sign=_other_sign(view, fit))
    if "phi" in view.configuration.ports:
        other = Hypothesis("ports.phi.sign", -view.configuration.ports["phi"].sign)
        of_torque = Hypothesis("ports.tau.sign", None)
        return TorqueEvidence(deformation=Evidence(fit.stiffness, [other, of_torque]))
    if _is_swapped(view, fit):
        return TorqueEvidence(swap=Evidence(fit.stiffness, other_columns(view)))
    keys = ("theta.gear_ratio", "q.gear_ratio", "tau.sign", "theta.column")
    hypotheses = [Hypothesis(f"ports.{each}", None) for each in keys]
    return TorqueEvidence(deformation=Evidence(fit.stiffness, hypotheses))


def _is_swapped(view: LogView, fit: QuickFit) -> bool:
    """Returns whether the stiffness is positive, and the torque explained better, if motor and link
    change places: with both measured after the gear, their motions do not show which is which."""
    if not {"theta", "q"} <= view.configuration.ports.keys():
        return False
    other = quick_fit(view.exchanged(), fit.form.f_0)
    if other is None or not other.has_stiffness or other.sign_of_motor <= 0:
        return False
    is_positive = np.sign(view.gamma) * other.scores[LINEAR] < -1
    return bool(is_positive and other.fit.error < fit.fit.error)


def _other_sign(view: LogView, fit: QuickFit, by_power: bool = False) -> Sign:
    port = "tau_e_sensor" if view.has_sensor else "tau"
    sign = -view.configuration.ports[port].sign
    hypotheses = [Hypothesis(f"ports.{port}.sign", sign, "tau", -1.0)]
    piece = view.longest
    velocity = view.gamma * np.gradient(piece.theta, view.T)
    power = -float(np.mean((piece.tau - piece.tau.mean()) * velocity))
    return Sign(fit.stiffness, hypotheses, power, by_power)


def _is_driven(view: LogView) -> bool:
    """Returns whether the motor takes power from the joint throughout the log, and no hand moves
    the link. That cannot be, because friction takes power from the motor.

    In slow motion of a stiff joint most of the torque is friction, so the power shows the sign of
    the torque where the stiffness does not.
    """
    piece = view.longest
    sign = drive(piece.theta, piece.theta + piece.phi, piece.tau).sign
    return bool(sign == -np.sign(view.gamma))


_LEAST_GEAR = 2e-3
"""Smallest relative error of a gear ratio that is reported; real gears have smaller errors."""
_MUCH = 0.3
"""Largest ratio of the squared errors, corrected to configured, if a gear ratio is wrong."""
_PRECISE = 3.0
"""Least error of a gear ratio, in half intervals. Where a controller makes the torque a function of
the position, as in gravity compensation, this function explains the torque with any gear ratio."""
_AS_FAR = 2.0
_SAG = 0.03  # deviation of a slope from 1 that many springs have
"""Where a link follows slowly, the right gear ratio does not take the slope of q on theta further
from 1: at most to twice the distance, or to 3 %, by the deformation of the spring."""


def _gear(view: LogView, fit: QuickFit, slope: Slope | None) -> Evidence | None:
    """Finds a slightly wrong gear ratio, if the correction explains much of the torque.

    slope  of q on theta; None if the link does not follow
    """
    ports = view.configuration.ports
    if "theta" not in ports or "phi" in ports:
        return None
    error = gear_error(view, fit.form)
    if error is None or not abs(error.value - 1) > _PRECISE * error.half_width + _LEAST_GEAR:
        return None
    if slope is not None and _denies(slope, error.value):
        return None
    # An asymmetric spring, a wrong zero, or a changing spring must not explain the errors too.
    others = [
        fit.fit.error,
        with_all_powers(view, fit.form).error,
        error_of_parts(view, fit.form),
    ]
    if not all(error.fit.error < _MUCH * other for other in others if math.isfinite(other)):
        return None
    theta = ports["theta"]
    return Evidence(error.value, [gear_of_slope(theta, error.value, error.half_width)])


def _denies(slope: Slope, error: float) -> bool:
    """Returns whether a slow motion denies an error of a gear ratio, configured to true."""
    if not (slope.is_slow and slope.value > 0):
        return False
    before, after = distance(slope.value, 1.0), distance(slope.value, error)
    return after > max(_AS_FAR * before, _SAG)


def _zero(view: LogView, fit: QuickFit) -> Zero | None:
    """Finds a wrong zero of the deformation.

    A polynomial with even powers may have its zero anywhere in the range of the deformation.
    """
    zero, covered = fit.spring.zero(), fit.spring.covered
    if not math.isfinite(zero) or not is_off(zero, fit.spring.half_width(zero), covered):
        return None
    ports = view.configuration.ports
    hypotheses = [
        Hypothesis(f"ports.{name}.zero", float(f"{port.zero + angle / scale(name, port):.6g}"))
        for name, angle in (("phi", zero), ("q", zero), ("theta", -zero))
        if (port := ports.get(name)) is not None and ("phi" not in ports or name == "phi")
    ]
    return Zero(zero, hypotheses, covered, abs(fit.stiffness * zero), fit.form.symmetric)


def _asymmetry(view: LogView, fit: QuickFit) -> Evidence | None:
    if not fit.form.symmetric:
        return None
    other = with_all_powers(view, fit.form)
    if not explains(fit.fit, other):
        return None
    return Evidence(math.sqrt(fit.fit.error / other.error), [Hypothesis("rls.symmetric", False)])


def _delay_of_torque(view: LogView, fit: QuickFit) -> Delay | None:
    """Finds a delay of the torque relative to the motion."""
    late = delay_of_torque(view, fit.form)
    if late is None:
        return None
    least = abs(late.value) - late.half_width
    if least < view.T or not explains(fit.fit, late.fit):
        return None
    # Another form of friction or another form of spring must not explain the torque too.
    others = [with_form(view, form) for form in few_frictions(fit.form)]
    others.append(with_all_powers(view, fit.form))
    others.append(with_damped_spring(view, fit.form))
    if not all(explains(other, late.fit) for other in others):
        return None
    delay = float(f"{view.configuration.ports['tau'].delay + late.value:.3g}")
    return Delay(late.value, [Hypothesis("ports.tau.delay", delay)], least, late.fit.error)


def _delay_of_encoder(view: LogView, fit: QuickFit) -> Delay | None:
    """Finds a time lag between the encoders, which appears as negative viscous friction.

    Unmodelled friction can also appear as negative viscous friction. Therefore the equation must
    fit better without the lag: much better, unless the negative friction explains much.
    """
    friction = fit.linear.value["D_theta"]
    largest_friction = friction + fit.linear.half_width["D_theta"]
    if not largest_friction < 0:
        return None
    # Without a known friction, the result is a lower limit of the lag.
    D_theta = float(view.parameters["motor.D_theta"]) if is_friction_known(view) else 0.0
    lag = view.gamma * (friction - D_theta) / fit.slope
    if abs(lag) > LONGEST_DELAY:
        return None
    without = with_form(view.earlier("q", lag), fit.form)
    is_better = explains(fit.fit, without)
    if not is_better and without.error < fit.fit.error:
        is_better = explains(with_known_friction(view, fit.form, 0.0), fit.fit)
    if not is_better:
        return None
    ports = view.configuration.ports
    hypotheses = [
        Hypothesis(f"ports.{name}.delay", float(f"{ports[name].delay + later:.3g}"))
        for name, later in (("q", lag), ("theta", -lag), ("phi", lag))
        if name in ports
    ]
    least = view.gamma * largest_friction / fit.slope
    return Delay(lag, hypotheses, least, without.error)


def is_friction_known(view: LogView) -> bool:
    """Returns whether the configuration gives the viscous friction of the motor."""
    return float(view.parameters["prior.D_theta"]) < WIDE


_DIFFERENT = math.log(2.0)  # logarithm of the largest factor that a torque constant explains
_LIKE = math.log(3.0)  # tolerance of the logarithm of a ratio of inertias to the gear ratio


def _inertia(view: LogView, fit: QuickFit) -> Inertia | None:
    """Finds a wrong inertia or a wrong scale of the torque, if the evidence is clear.

    With a wide prior of B, the inertia is not compared, because identify will determine B.
    """
    given = float(view.parameters["motor.B"])
    if not given > 0 or float(view.parameters["prior.B"]) >= WIDE:
        return None
    free = with_free_inertia(view, fit.form)
    nearest = _nearest(view, fit.form, free, given)
    if nearest is None or distance(nearest, given) < _DIFFERENT:
        return None
    if not explains(with_known_inertia(view, fit.form, given), free):
        return None
    B = free.value["B"]
    of_motor = Hypothesis("motor.B", float(f"{B:.3g}"))
    gamma = abs(view.gamma)
    geared = [gear for gear in (gamma, 1 / gamma) if distance(B, gear * given) < _LIKE]
    is_given = "motor.B" in view.configuration.parameters
    if is_given and geared and math.log(gamma) > 2 * _LIKE:
        gear = float(f"{view.configuration.ports['tau'].gear_ratio * geared[0]:.6g}")
        of_gear = Hypothesis("ports.tau.gear_ratio", gear, "tau", 1 / geared[0])
        return Inertia(B, [of_gear, of_motor], given, is_geared=True)
    constant = Hypothesis("ports.tau.torque_constant", None)
    return Inertia(B, [of_motor, constant], given, is_geared=False)


def _nearest(view: LogView, form: Form, free: Fit, given: float) -> float | None:
    """Returns the inertia nearest to `given` among the ends of the interval and fits with other
    forms of friction. None if the difference is not clear, or an inertia is not above 0."""
    B, half_width = free.value["B"], free.half_width["B"]
    if not 0 < B - half_width < math.inf or distance(B, given) < _DIFFERENT:
        return None
    forms = [slower(form), *few_frictions(form)]
    inertias = [with_free_inertia(view, other).value["B"] for other in forms]
    inertias += [B - half_width, B + half_width]
    if not all(inertia > 0 for inertia in inertias):
        return None
    return min(inertias, key=lambda inertia: distance(inertia, given))
