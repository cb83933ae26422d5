"""Checks by the motor equation: signs, zero of the deformation, delays, and inertia."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sigmahat.checks import motor_equation
from sigmahat.checks.changes import distance, gear_of
from sigmahat.checks.findings import Finding, Kind, Severity
from sigmahat.checks.motor_equation import LINEAR, Fitted, explains, with_all_powers
from sigmahat.checks.relation import Relation
from sigmahat.checks.view import View
from sigmahat.motor.equation import MOTOR
from sigmahat.motor.quantities import WIDE
from sigmahat.recording.units import scale

_MATTERS = 0.05  # smallest relevant error of zero, relative to the range of the deformation
_STD = 3.0  # a prior contradicts the log beyond this number of standard deviations


def dynamics(here: Relation) -> Iterator[Finding]:
    """Runs all checks by the motor equation that the motion in the log allows."""
    seen, found = here.seen, here.fitted
    if found is None or not 0 < found.linear.half_width.get(LINEAR, math.inf) < math.inf:
        return  # the log determines no stiffness
    wrong = (None if here.findings else _gear(seen, found)) or _sign(seen, found)
    if wrong is not None:
        yield wrong
        return  # with a wrong deformation or a wrong sign, further results mean nothing
    zero = _zero(seen, found)
    if zero is not None:
        yield zero
    elif found.form.symmetric and explains(found.fit, other := with_all_powers(seen, found.form)):
        times, key = math.sqrt(found.fit.error / other.error), "rls.symmetric"
        yield Finding(Kind.ASYMMETRY, Severity.NOTE, key, times, "", 1.0, proposed=False)
    if not seen.has_sensor:
        yield from _delays(seen, found)
        yield from inertia(seen, found)


def _delays(seen: View, found: Fitted) -> Iterator[Finding]:
    """Finds a delay of the torque, or a delay between the encoders. A late link position has the
    same effect as an early torque, and a late torque as an early link position."""
    late, lag = _late(seen, found), _encoder_lag(seen, found)
    if late is not None and (lag is None or (late[0].measured > 0 and late[1] < lag[1])):
        yield late[0]
    elif lag is not None:
        yield lag[0]


_Delay = tuple[Finding, float]  # finding, and sum of squared errors after the correction


def _sign(seen: View, found: Fitted) -> Finding | None:
    """Finds a torque of wrong sign, or a wrong deformation if only the stiffness is negative."""
    score = found.scores()
    stiffness = -np.sign(seen.gamma) * score[LINEAR]
    if not stiffness < -1:
        return None
    port = "tau_e_sensor" if seen.has_sensor else "tau"
    signs = [np.sign(score[name]) for name in MOTOR if abs(score.get(name, 0.0)) > 1]
    sigma = -seen.gamma * found.linear.value[LINEAR] / found.spring.units[0]
    if seen.has_sensor or (signs and sum(signs) < 0):
        key, proposed = f"ports.{port}.sign", -seen.configuration.ports[port].sign
        return Finding(Kind.SIGN, Severity.WRONG, key, sigma, "N.m/rad", None, proposed, (), port)
    key = "ports.theta.gear_ratio"
    others = [("ports.q.gear_ratio", None), (f"ports.{port}.sign", None)]
    return Finding(Kind.STIFFNESS_SIGN, Severity.WRONG, key, sigma, "N.m/rad", None, None, others)


_LEAST_GEAR = 2e-3
"""Smallest relative error of a gear ratio that is reported; real gears have smaller errors."""
_MUCH = 0.3
"""Largest ratio of the squared errors, corrected to configured, if a gear ratio is wrong."""


def _gear(seen: View, found: Fitted) -> Finding | None:
    """Finds a slightly wrong gear ratio, if the correction explains much of the torque."""
    if "theta" not in seen.configuration.ports:
        return None
    error = motor_equation.gear_error(seen, found.form)
    if error is None or not abs(error.value - 1) > error.half_width + _LEAST_GEAR:
        return None
    # An asymmetric spring, a wrong zero, or a changing spring must not explain the errors too.
    others = [each.error for each in (found.fit, with_all_powers(seen, found.form))]
    others.append(motor_equation.error_of_parts(seen, found.form))
    if not all(error.fit.error < _MUCH * each for each in others if math.isfinite(each)):
        return None
    change = gear_of(seen.configuration.ports["theta"], error.value, error.half_width)
    slope = 1 / error.value
    return Finding(Kind.SLOPE, Severity.WRONG, change.key, slope, "", 1.0, change.value)


def _zero(seen: View, found: Fitted) -> Finding | None:
    """Finds a wrong zero of the deformation.

    A polynomial with even powers may have its zero anywhere in the range of the deformation.
    """
    zero, covered = found.spring.zero(), found.spring.covered
    if not math.isfinite(zero):
        return None
    half_width = found.spring.half_width(zero)
    if not (half_width < _MATTERS * covered and abs(zero) > max(half_width, _MATTERS * covered)):
        return None
    keys = [
        (f"ports.{name}.zero", float(f"{port.zero + angle / scale(name, port):.6g}"))
        for name, angle in (("q", zero), ("theta", -zero))
        if (port := seen.configuration.ports.get(name)) is not None
    ]
    bias = 0.0  # largest bias of the torque that the estimator expects [N.m]
    if seen.every["method"] == "FilteredRegression":
        bias = _STD * float(seen.every["prior.bias"]) * float(seen.every["prior.tau_e"])
    torque = abs(seen.gamma * found.linear.value[LINEAR] * zero / found.spring.units[0])
    # A zero within the deformations of the log is only a note, because identify sets this zero.
    is_wrong = abs(zero) > covered / 2 and torque > bias
    if not (is_wrong or found.form.symmetric):
        return None
    severity = Severity.WRONG if is_wrong else Severity.NOTE
    (key, proposed), *others = keys
    return Finding(Kind.ZERO, severity, key, zero, "rad", 0.0, proposed, others)


def _late(seen: View, found: Fitted) -> _Delay | None:
    """Finds a delay of the torque relative to the motion."""
    late = motor_equation.delay(seen, found.form)
    if late is None:
        return None
    least = abs(late.value) - late.half_width
    if least < seen.T or not explains(found.fit, late.fit):
        return None
    # Another form of friction or another form of spring must not explain the torque too.
    _, *frictions = motor_equation.variants(found.form)
    others = [motor_equation.with_form(seen, form) for form in frictions]
    others.append(with_all_powers(seen, found.form))
    if not all(explains(each, late.fit) for each in others):
        return None
    is_expected = least < _STD * float(seen.every["prior.delay"])
    severity = Severity.NOTE if is_expected else Severity.WRONG
    port = seen.configuration.ports["tau"]
    # A delay within prior.delay is no error: damping of the spring looks like an early torque.
    proposed = None if is_expected else float(f"{port.delay + late.value:.3g}")
    key = "ports.tau.delay"
    finding = Finding(Kind.TORQUE_LAG, severity, key, late.value, "s", 0.0, proposed)
    return finding, late.fit.error


def _encoder_lag(seen: View, found: Fitted) -> _Delay | None:
    """Finds a time lag between the encoders, which appears as negative viscous friction.

    Unmodelled friction can also appear as negative viscous friction. Therefore the equation must
    fit better without the lag: much better, unless the negative friction explains much.
    """
    value, half = found.linear.value, found.linear.half_width
    if not value["D_theta"] + half["D_theta"] < 0:
        return None
    slope = value[LINEAR] / found.spring.units[0]
    is_known = float(seen.every["prior.D_theta"]) < WIDE
    D_theta = float(seen.every["motor.D_theta"]) if is_known else 0.0  # a lower limit of the lag
    lag = seen.gamma * (value["D_theta"] - D_theta) / slope
    if abs(lag) > motor_equation.LONGEST:
        return None
    pieces = []
    for piece in seen.pieces:  # with earlier positions of the link
        q = motor_equation.moved(piece.theta + piece.phi, lag / seen.T)
        pieces.append(replace(piece, phi=q - piece.theta))
    without = motor_equation.with_form(replace(seen, pieces=pieces), found.form)
    is_better = explains(found.fit, without)
    if not is_better and without.error < found.fit.error:
        is_better = explains(motor_equation.with_known(seen, found.form, "D_theta", 0.0), found.fit)
    if not is_better:
        return None
    least = seen.gamma * (value["D_theta"] + half["D_theta"]) / slope
    severity = Severity.WRONG if least > seen.T else Severity.NOTE
    port = seen.configuration.ports["q"]
    proposed = float(f"{port.delay + lag:.3g}")
    others = [("ports.theta.delay", float(f"{seen.configuration.ports['theta'].delay - lag:.3g}"))]
    key = "ports.q.delay"
    least_lag = "" if is_known else "at least "
    finding = Finding(Kind.ENCODER_LAG, severity, key, lag, "s", 0.0, proposed, others, least_lag)
    return finding, without.error


_AWAS = 2.3e-5  # start value of motor_equation.B [kg.m2]
_LARGE = math.log(5.0)
"""Logarithm of the largest factor by which unmodelled friction and delays can change B."""
_DIFFERENT = math.log(2.0)  # logarithm of the largest factor that a torque constant explains
_LIKE = math.log(3.0)  # tolerance of the logarithm of a ratio of inertias to the gear ratio


def inertia(seen: View, found: Fitted) -> Iterator[Finding]:
    """Finds a wrong inertia or a wrong scale of the torque, if the evidence is clear."""
    given = float(seen.every["motor.B"])
    B = _nearest(seen, found, given) if given > 0 else None
    if B is None or distance(B, given) < _DIFFERENT:
        return
    if not explains(motor_equation.with_known(seen, found.form, "B", given), found.fit):
        return
    B = found.fit.value["B"]
    unit, rounded = "kg.m2", float(f"{B:.3g}")
    if float(seen.every["prior.B"]) >= WIDE:
        return  # the prior of B is wide, so identify will determine B
    gamma = abs(seen.gamma)
    geared = [each for each in (gamma, 1 / gamma) if distance(B, each * given) < _LIKE]
    is_given = "motor.B" in seen.configuration.parameters
    if is_given and geared and math.log(gamma) > 2 * _LIKE:
        gear = float(f"{seen.configuration.ports['tau'].gear_ratio * geared[0]:.6g}")
        kind, key, others = Kind.TORQUE_SCALE, "ports.tau.gear_ratio", [("motor.B", rounded)]
        yield Finding(kind, Severity.WRONG, key, B, unit, given, gear, others)
        return
    is_wrong = given == _AWAS or distance(B, given) > _LARGE
    severity = Severity.WRONG if is_wrong else Severity.NOTE
    constant = [("ports.tau.torque_constant", None)]
    yield Finding(Kind.INERTIA, severity, "motor.B", B, unit, given, rounded, constant)


def _nearest(seen: View, found: Fitted, given: float) -> float | None:
    """Returns the inertia nearest to `given` among the ends of the interval and fits with other
    forms of friction. None if the difference is not clear, or an inertia is not above 0."""
    B, half = found.fit.value["B"], found.fit.half_width["B"]
    if not 0 < B - half < math.inf or distance(B, given) < _DIFFERENT:
        return None
    every = [
        motor_equation.with_form(seen, f).value["B"] for f in motor_equation.variants(found.form)
    ]
    every += [B - half, B + half]
    if not all(each > 0 for each in every):
        return None
    return min(every, key=lambda each: distance(each, given))
