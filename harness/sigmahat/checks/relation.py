"""Checks the slope of q on theta: a slope other than 1 shows a wrong sign, unit, gear or encoder.

In slow motion the link follows its motor. Near the resonance the link does not follow, nor if link
or motor is held. Therefore the slope of q on theta is not sufficient as evidence. With a scale from
the slope, the motor equation must fit the torque at least as well as before.

The torque is no evidence either if the torque is a function of the position, like a spring torque.
Examples are gravity, and a link moved by hand while the motor holds its position. Therefore a slope
of slow motion with a high correlation needs no evidence from the torque in two cases. The slope is
negative, or the slope fits a likely mistake, such as a gear ratio with one zero too many.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sigmahat.checks.changes import Change, changes, distance, gear_of
from sigmahat.checks.findings import Finding, Kind, Severity
from sigmahat.checks.motor_equation import LINEAR, Fitted, fitted, gear_error
from sigmahat.checks.samples import encoder_step, step
from sigmahat.checks.view import View
from sigmahat.motor.equation import MOTOR, Signals, is_worse
from sigmahat.motor.noise import low_pass

PORTS = ("theta", "q")
_LIKE = math.log(1.5)
"""Tolerance of the logarithm of a slope, because q and theta differ by the deformation."""
_ANY = 0.05
"""Sort key of a gear ratio computed from the slope: other changes that agree are tried first."""
_LIKELY = 0.06  # tolerance of the logarithm of a likely mistake
_APART = 3.0  # slopes beyond this factor are checked; the smallest likely mistake is a factor of 4
_FAR = 5.0  # largest factor by which a spring enlarges the link motion below the resonance
_FARTHEST = 100.0  # largest factor by which a resonance enlarges the link motion
_BETTER = 0.8  # largest ratio of the squared errors, after to before
_PRECISE = 0.01  # largest half width of the correction of a gear ratio [1]
_AS_WELL = 0.25  # tolerance of the logarithm of another factor that explains the same slope
_SLOW = 1.0  # [Hz]
_ENOUGH = 0.1  # least fraction of slow motion; with less, the whole motion is used
_CORRELATED = 0.9
_RIGID = 0.99  # with a higher correlation of motor and link, the deformation is negligible


@dataclass(frozen=True)
class Slope:
    """Slope of q on theta, from the slow motion if the log contains slow motion."""

    value: float  # [1]
    is_slow: bool
    is_rigid: bool  # whether the deformation is small compared with the motion


def slope_of(pieces: Sequence[Signals], T: float) -> Slope | None:
    """Computes the slope of q on theta by total least squares; None for a low correlation."""
    if not pieces:
        return None
    motions = [np.column_stack([p.theta, p.theta + p.phi]) for p in pieces]
    motions = [each - each.mean(axis=0) for each in motions]
    slow = [low_pass(each, min(_SLOW, 0.1 / T), T) for each in motions]
    enough = [
        bool(np.all(np.std(s, axis=0) > _ENOUGH * np.std(m, axis=0)))
        for s, m in zip(slow, motions, strict=True)
    ]
    both = np.concatenate([s if e else m for s, m, e in zip(slow, motions, enough, strict=True)])
    variances = np.var(both, axis=0)
    if not np.all(variances > 0):
        return None
    # With both signals scaled to variance 1, the principal axis is the diagonal.
    correlation = np.corrcoef(both.T)[0, 1]
    if abs(correlation) < _CORRELATED:
        return None
    value = float(np.sign(correlation) * np.sqrt(variances[1] / variances[0]))
    return Slope(value, all(enough), bool(abs(correlation) > _RIGID))


@dataclass(frozen=True)
class Relation:
    """The motion of q and theta after a correction of the errors that were found."""

    findings: Sequence[Finding]
    seen: View  # the log, with the scales that were proposed
    fitted: Fitted | None  # the motor equation of this log


def relation(seen: View) -> Relation:
    """Compares the motions of q and theta, and corrects scale and sign."""
    here = Relation((), seen, fitted(seen))
    if not {"theta", "q"} <= set(seen.samples.names):
        return here
    ports = seen.configuration.ports
    if "tau_e_sensor" in ports and ports["theta"].column == ports["tau_e_sensor"].column:
        return here  # theta is the compliance of a test bench, which drives no link
    found = slope_of(seen.pieces, seen.T)
    return here if found is None else _sign(_scale(here, found))


def _scale(here: Relation, slope: Slope) -> Relation:
    size = abs(slope.value)
    if not distance(size, 1.0) > _LIKE:
        return here
    ports = here.seen.configuration.ports
    near = [
        change
        for name in PORTS
        for change in changes(name, ports[name], here.seen.gamma)
        if distance(change.on_theta, size) < _LIKE
    ]
    gear = _refined(here.seen, size)
    best = _likely(here.seen, slope) or _by_torque(here, slope, [gear, *near])
    if best is None:
        return here
    others = {
        change.key: change.value
        for change in (*near, gear)
        if change.key != best.key and distance(change.on_theta, best.on_theta) < _AS_WELL
    }
    key, listed = best.key, list(others.items())
    what = (key, slope.value, "", 1.0, best.value, listed, "held" if size > 1 else "")
    if size > 1 and not _is_gamma(best, here.seen) and _is_positive(here.seen, here.fitted):
        # A hand may have moved the link while a drive held the motor.
        return replace(here, findings=[Finding(Kind.SLOPE, Severity.NOTE, *what)])
    repaired = _scaled(here.seen, best.port, best.factor)
    return Relation([Finding(Kind.SLOPE, Severity.WRONG, *what)], repaired, fitted(repaired))


def _is_positive(seen: View, found: Fitted | None) -> bool:
    """Returns whether the stiffness is significantly positive, and motor data are not negative."""
    if found is None or not abs(found.linear.value[LINEAR]) > found.linear.half_width[LINEAR]:
        return False
    return not _is_stiffness_negative(seen, found) and _sign_of_motor(found) >= 0


def _likely(seen: View, slope: Slope) -> Change | None:
    """Finds the likely mistake that explains the slope; None if the slope fits no likely mistake.

    A gear ratio that contradicts motor.gamma is additional evidence, so the tolerance is larger.
    """
    size, ports = abs(slope.value), seen.configuration.ports
    if not (slope.is_rigid and max(size, 1 / size) > (_APART if slope.is_slow else _FARTHEST)):
        return None
    now = abs(ports["theta"].gear_ratio)
    known = [each for name in PORTS for each in changes(name, ports[name], seen.gamma)]
    gears = [1 / now, *(now * 10.0**k for k in (-3, -2, -1, 1, 2, 3))]
    known += [Change("theta", "ports.theta.gear_ratio", gear, now / gear) for gear in gears]
    best = min(known, key=lambda each: distance(each.on_theta, size))
    if distance(best.on_theta, size) > (_LIKE if _is_gamma(best, seen) else _LIKELY):
        return None
    return None if _encoder_denies(seen, best) else best


def _is_gamma(change: Change, seen: View) -> bool:
    """Returns whether the change makes the gear ratio of theta equal to motor.gamma."""
    return change.port == "theta" and change.value == abs(seen.gamma)


def _encoder_denies(seen: View, change: Change) -> bool:
    """Returns whether the encoder steps fit the given resolution only without the change."""
    port = seen.configuration.ports[change.port]
    if f"encoder.{change.port}" not in seen.configuration.parameters:
        return False
    other: dict[str, Any] = {change.key.rpartition(".")[2]: change.value}
    after = replace(port, **other)
    values = seen.log.read(port.column)
    of_encoder = encoder_step(values[np.isfinite(values)])
    now, then = (list(step(seen, change.port, each, of_encoder)) for each in (port, after))
    return not now and bool(then)


def _by_torque(here: Relation, slope: Slope, every: list[Change]) -> Change | None:
    """Finds the change with which the motor equation fits best; None if no change is plausible."""

    def unlikely(each: Change) -> float:
        """Returns a sort key: the change with the smallest key is tried first."""
        return _ANY if each.fits_any else round(distance(each.on_theta, abs(slope.value)), 1)

    best, found = None, here.fitted
    f_0 = found.form.f_0 if found else None  # errors compare with one filter only
    for change in sorted(every, key=unlikely):
        after = fitted(_scaled(here.seen, change.port, change.factor), f_0)
        if _is_plausible(here, after, slope) if best is None else _is_better(found, after):
            best, found = change, after
    return best


def _refined(seen: View, slope: float) -> Change:
    """Refines the gear ratio from the slope with the motor equation.

    The slope is inexact because the joint is flexible; the torque depends on 1 % of theta.
    """
    near, theta = _scaled(seen, "theta", slope), seen.configuration.ports["theta"]
    found = fitted(near)
    error = None if found is None else gear_error(near, found.form)
    if error is None or error.half_width > _PRECISE:
        return gear_of(theta, slope)
    return gear_of(theta, slope * error.value, slope * error.half_width)


def _sign(here: Relation) -> Relation:
    seen, before = here.seen, here.fitted
    slope = slope_of(seen.pieces, seen.T)
    if slope is None or slope.value > 0:
        return here
    flipped = _scaled(seen, "q", -1.0)
    after = fitted(flipped, before.form.f_0 if before else None)
    # In slow motion, only a wrong sign makes the link move as far as its motor, but reversed.
    is_certain = slope.is_slow and slope.is_rigid and distance(-slope.value, 1.0) < _LIKE
    if before is not None and after is not None and not is_certain:
        is_soft = _is_stiffness_negative(seen, before)
        if is_worse(after.fit, before.fit) or not (is_soft or _is_better(before, after)):
            return here
    ports = seen.configuration.ports
    keys = {f"ports.{name}.sign": -ports[name].sign for name in PORTS}
    gear, name = ports["theta"].gear_ratio, "theta"
    if gear < 0:
        keys = {"ports.theta.gear_ratio": -gear, "ports.q.sign": keys["ports.q.sign"]}
    elif not _sign_of_motor(after) < 0:
        # The sign of theta is right, because its change would make inertia and friction negative.
        name = "q"
        keys = dict(reversed(keys.items()))
    (key, proposed), *others = keys.items()
    what = (Kind.SLOPE, Severity.WRONG, key, slope.value, "", 1.0, proposed, others, "sign")
    repaired = _scaled(seen, name, -1.0)
    return Relation([*here.findings, Finding(*what)], repaired, fitted(repaired))


def _sign_of_motor(found: Fitted | None) -> float:
    """Returns the common sign of inertia and friction; 0 if the fit does not determine it."""
    if found is None:
        return 0.0
    scores = found.scores()
    return float(np.sign(sum(scores[n] for n in MOTOR if abs(scores.get(n, 0.0)) > 1)))


def _scaled(seen: View, name: str, factor: float) -> View:
    """Changes the scale of theta or q in the signals of a log."""
    of_theta, of_q = (factor, 1.0) if name == "theta" else (1.0, factor)
    pieces = []
    for piece in seen.pieces:
        theta, q = of_theta * piece.theta, of_q * (piece.theta + piece.phi)
        pieces.append(replace(piece, theta=theta, phi=q - theta))
    return replace(seen, pieces=pieces)


def _is_plausible(here: Relation, after: Fitted | None, slope: Slope) -> bool:
    before, size = here.fitted, abs(slope.value)
    is_far = max(size, 1 / size) > _FAR
    if before is None or after is None:
        return is_far
    if slope.is_slow and slope.is_rigid and size < 1 and _is_stiffness_negative(here.seen, before):
        return True  # a free link moves less than the motor, and the stiffness would be negative
    return not is_worse(after.fit, before.fit) if is_far else _is_better(before, after)


def _is_stiffness_negative(seen: View, found: Fitted) -> bool:
    return found.linear.value[LINEAR] * seen.gamma > 0


def _is_better(before: Fitted | None, after: Fitted | None) -> bool:
    if before is None or after is None:
        return False
    return is_worse(before.fit, after.fit) and after.fit.error < _BETTER * before.fit.error
