"""Compares the motions of motor and link: a slope of q on theta other than 1 shows a wrong sign,
unit, gear or encoder.

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

import numpy as np

from sigmahat.motor.equation import explains, is_worse
from sigmahat.motor.hypotheses import encoder
from sigmahat.motor.hypotheses.hypothesis import (
    Evidence,
    Hypothesis,
    distance,
    gear_of_slope,
    mistyped_gears,
    scales,
)
from sigmahat.motor.hypotheses.slope import Slope, slope_of
from sigmahat.motor.log_view import LogView, liveliest_part
from sigmahat.motor.quick_fit import LINEAR, QuickFit, gear_error, quick_fit, with_unknown_inertia
from sigmahat.recording.log import LogError

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
_UNLIKE = 5.0  # slope of q on theta that is too large for a soft spring
_ALIKE = 1.5


def _clear_slope(view: LogView) -> Slope | None:
    """Computes the slope of q on theta; None if motor and link do not move alike."""
    motions = [np.column_stack([piece.theta, piece.theta + piece.phi]) for piece in view.pieces]
    slope = slope_of(motions, view.T)
    return slope if slope is not None and slope.is_clear else None


def still(view: LogView) -> list[str]:
    """Finds measured positions that do not change: the encoder is dead, or the joint is locked."""
    names = []
    for name in PORTS:
        if name not in view.samples.names:
            continue
        values = view.samples.values[:, list(view.samples.names).index(name)]
        known = values[np.isfinite(values)]
        is_given = view.configuration.inputs[name].value is not None
        if len(known) and float(np.ptp(known)) == 0 and not is_given:
            names.append(name)
    return names


def swapped(view: LogView) -> Evidence | None:
    """Returns the slope of q on theta if both move alike only after a swap of their columns."""
    ports = view.configuration.ports
    if not {"theta", "q"} <= ports.keys():
        return None
    now = _clear_slope(view)
    if now is None or distance(abs(now.value), 1.0) < math.log(_UNLIKE):
        return None
    theta, q = ports["theta"], ports["q"]
    if abs(theta.gear_ratio) < 1:
        return None  # an inverted gear ratio has the same effect as swapped columns
    turned = {
        "theta": replace(theta, column=q.column, time=q.time, zero=q.zero),
        "q": replace(q, column=theta.column, time=theta.time, zero=theta.zero),
    }
    try:
        other = liveliest_part(view.log, replace(view.configuration, ports={**ports, **turned}))
    except LogError:
        return None
    slope = _clear_slope(other)
    if slope is None or distance(abs(slope.value), 1.0) > math.log(_ALIKE):
        return None
    return Evidence(now.value, other_columns(view))


def other_columns(view: LogView) -> list[Hypothesis]:
    """Returns the columns of theta and q, each in place of the other."""
    ports = view.configuration.ports
    columns = {"theta": ports["q"].column, "q": ports["theta"].column}
    return [Hypothesis(f"ports.{name}.column", column) for name, column in columns.items()]


@dataclass(frozen=True)
class Positions:
    """The motion of q and theta after a correction of the errors that were found."""

    view: LogView  # the log, with the scales that were proposed
    fit: QuickFit | None  # the motor equation of this log
    slope: Slope | None = None  # of q on theta, before a correction, if both move alike
    scale: Evidence | None = None  # slope of q on theta, if another scale explains it
    may_be_held: bool = False
    """Whether a hand may have moved the link while a drive held the motor. In this case, the scale
    is not corrected."""
    by_torque: bool = False  # whether the scale is another one because of the torque alone
    sign: Evidence | None = None  # slope of q on theta, if another sign explains it

    @property
    def corrections(self) -> list[Evidence]:
        return [found for found in (self.scale, self.sign) if found is not None]


def _fit(view: LogView, f_0: float | None = None) -> QuickFit | None:
    """Fits the motor equation without the configured inertia, which a wrong scale contradicts."""
    return quick_fit(with_unknown_inertia(view), f_0)


def compare_positions(view: LogView) -> Positions:
    """Compares the motions of q and theta, and corrects scale and sign."""
    same = Positions(view, _fit(view))
    if not {"theta", "q"} <= set(view.samples.names):
        return same
    ports = view.configuration.ports
    if "phi" in ports:
        return same  # one position follows from the other, so both move alike in any case
    if "tau_e_sensor" in ports and ports["theta"].column == ports["tau_e_sensor"].column:
        return same  # theta is the compliance of a test bench, which drives no link
    slope = _clear_slope(view)
    if slope is None:
        return same
    return _with_sign(_with_scale(replace(same, slope=slope), slope))


def _with_scale(before: Positions, slope: Slope) -> Positions:
    size = abs(slope.value)
    if not distance(size, 1.0) > _LIKE:
        return before
    view = before.view
    ports = view.configuration.ports
    near = [
        hypothesis
        for name in PORTS
        for hypothesis in scales(name, ports[name], view.gamma)
        if distance(hypothesis.on_theta, size) < _LIKE
    ]
    gear = _refined(view, size)
    likely = _likely(view, slope)
    best = likely or _by_torque(before, slope, [gear, *near])
    if best is None:
        return before
    others = {
        other.key: other
        for other in (*near, gear)
        if other.key != best.key and distance(other.on_theta, best.on_theta) < _AS_WELL
    }
    evidence = Evidence(slope.value, [best, *others.values()])
    if size > 1 and not _is_gamma(best, view) and _is_positive(before.fit):
        return replace(before, scale=evidence, may_be_held=True)
    corrected = best.applied(view)
    return Positions(corrected, _fit(corrected), slope, evidence, by_torque=likely is None)


def _is_positive(fit: QuickFit | None) -> bool:
    """Returns whether the stiffness is significantly positive, and motor data are not negative."""
    if fit is None or not abs(fit.linear.value[LINEAR]) > fit.linear.half_width[LINEAR]:
        return False
    return not fit.stiffness < 0 and fit.sign_of_motor >= 0


def _likely(view: LogView, slope: Slope) -> Hypothesis | None:
    """Finds the likely mistake that explains the slope; None if the slope fits no likely mistake.

    A gear ratio that contradicts motor.gamma is additional evidence, so the tolerance is larger.
    """
    size, ports = abs(slope.value), view.configuration.ports
    if not (slope.is_rigid and max(size, 1 / size) > (_APART if slope.is_slow else _FARTHEST)):
        return None
    known = [other for name in PORTS for other in scales(name, ports[name], view.gamma)]
    known += mistyped_gears(ports["theta"])
    best = min(known, key=lambda other: distance(other.on_theta, size))
    if distance(best.on_theta, size) > (_LIKE if _is_gamma(best, view) else _LIKELY):
        return None
    return None if encoder.denies(view, best) else best


def _is_gamma(hypothesis: Hypothesis, view: LogView) -> bool:
    """Returns whether the value makes the gear ratio of theta equal to motor.gamma."""
    return hypothesis.port == "theta" and hypothesis.value == abs(view.gamma)


def _by_torque(
    before: Positions, slope: Slope, hypotheses: Sequence[Hypothesis]
) -> Hypothesis | None:
    """Finds the scale with which the motor equation fits best; None if no scale is plausible."""

    def unlikely(each: Hypothesis) -> float:
        """Returns a sort key: the hypothesis with the smallest key is tried first."""
        return _ANY if each.fits_any else round(distance(each.on_theta, abs(slope.value)), 1)

    best, fit = None, before.fit
    f_0 = fit.form.f_0 if fit else None  # errors compare with one filter only
    for hypothesis in sorted(hypotheses, key=unlikely):
        after = _fit(hypothesis.applied(before.view), f_0)
        is_better = _is_better(fit, after) if best else _is_plausible(fit, after, slope)
        if is_better:
            best, fit = hypothesis, after
    return best


def _refined(view: LogView, slope: float) -> Hypothesis:
    """Refines the gear ratio from the slope with the motor equation.

    The slope is inexact because the joint is flexible; the torque depends on 1 % of theta.
    """
    near = with_unknown_inertia(view).scaled("theta", slope)
    theta = view.configuration.ports["theta"]
    fit = quick_fit(near)
    error = None if fit is None else gear_error(near, fit.form)
    if error is None or error.half_width > _PRECISE:
        return gear_of_slope(theta, slope)
    return gear_of_slope(theta, slope * error.value, slope * error.half_width)


def _with_sign(before: Positions) -> Positions:
    view, fit = before.view, before.fit
    slope = _clear_slope(view)
    if slope is None or slope.value > 0:
        return before
    after = _fit(view.scaled("q", -1.0), fit.form.f_0 if fit else None)
    # In slow motion, only a wrong sign makes the link move as far as its motor, but reversed.
    is_certain = slope.is_slow and slope.is_rigid and distance(-slope.value, 1.0) < _LIKE
    if not is_certain and _denies(fit, after):
        return before
    ports = view.configuration.ports
    of_q = Hypothesis("ports.q.sign", -ports["q"].sign, "q", -1.0)
    gear = ports["theta"].gear_ratio
    if gear < 0:
        hypotheses = [Hypothesis("ports.theta.gear_ratio", -gear, "theta", -1.0), of_q]
    else:
        of_theta = Hypothesis("ports.theta.sign", -ports["theta"].sign, "theta", -1.0)
        # Another sign of theta would make inertia and friction negative if they are positive.
        is_theta = after is not None and after.sign_of_motor < 0
        hypotheses = [of_theta, of_q] if is_theta else [of_q, of_theta]
    corrected = hypotheses[0].applied(view)
    sign = Evidence(slope.value, hypotheses)
    return replace(before, view=corrected, fit=_fit(corrected), sign=sign)


def _denies(before: QuickFit | None, after: QuickFit | None) -> bool:
    """Returns whether the torque is evidence against another sign of q."""
    if before is None or after is None:
        return False
    return is_worse(after.fit, before.fit) or not (
        before.stiffness < 0 or _is_better(before, after)
    )


def _is_plausible(before: QuickFit | None, after: QuickFit | None, slope: Slope) -> bool:
    size = abs(slope.value)
    is_far = max(size, 1 / size) > _FAR
    if before is None or after is None:
        return is_far
    if slope.is_slow and slope.is_rigid and size < 1 and before.stiffness < 0:
        return True  # a free link moves less than the motor, and the stiffness would be negative
    return not is_worse(after.fit, before.fit) if is_far else _is_better(before, after)


def _is_better(before: QuickFit | None, after: QuickFit | None) -> bool:
    if before is None or after is None:
        return False
    return explains(before.fit, after.fit, _BETTER)
