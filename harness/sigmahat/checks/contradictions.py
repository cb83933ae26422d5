"""Findings from the motion: what the motor equation shows against the configuration.

The inference is in sigmahat.motor.hypotheses. Here its results get their severity, by the priors of
the configuration and by what identify will set.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sigmahat.checks.findings import Finding, Kind, Severity
from sigmahat.motor.hypotheses.hypothesis import Evidence, distance
from sigmahat.motor.hypotheses.misfit import is_explained_by_swap, misfit
from sigmahat.motor.hypotheses.positions import Positions, other_columns, swapped
from sigmahat.motor.hypotheses.size import implausible_sizes
from sigmahat.motor.hypotheses.torque import (
    Delay,
    Inertia,
    Sign,
    TorqueEvidence,
    Zero,
    compare_torque,
    is_friction_known,
)
from sigmahat.motor.log_view import LogView

_STD = 3.0  # a prior contradicts the log beyond this number of standard deviations
_AWAS = 2.3e-5  # start value of motor.B [kg.m2]
_LARGE = math.log(5.0)
"""Logarithm of the largest factor by which unmodelled friction and delays can change B."""
_LARGER = math.log(30.0)  # the same if the motor equation does not explain the torque
_SAME = 0.01  # two gear ratios count as equal up to this relative difference


def finding(
    kind: Kind,
    severity: Severity,
    evidence: Evidence,
    unit: str,
    expected: float | None = None,
    about: str = "",
) -> Finding:
    """Creates a finding with the keys and values of all hypotheses."""
    best, *others = evidence.hypotheses
    keys = [(other.key, other.value) for other in others]
    measured = evidence.measured
    return Finding(kind, severity, best.key, measured, unit, expected, best.value, keys, about)


def of_swap(view: LogView) -> Iterator[Finding]:
    evidence = swapped(view)
    if evidence is not None:
        yield finding(Kind.SLOPE, Severity.WRONG, evidence, "", 1.0, "swap")


def of_misfit(positions: Positions) -> Iterator[Finding]:
    """Finds a torque that the motion does not explain, whatever is wrong in the configuration."""
    view, fit = positions.view, positions.fit
    evidence = None if fit is None else misfit(view, fit)
    if fit is None or evidence is None:
        return
    if is_explained_by_swap(view, fit):
        evidence = replace(evidence, hypotheses=other_columns(view))
        yield finding(Kind.UNEXPLAINED, Severity.WRONG, evidence, "", 0.0, "swap")
    else:
        yield finding(Kind.UNEXPLAINED, Severity.NOTE, evidence, "", 0.0)


def of_positions(positions: Positions, has_misfit: bool) -> Iterator[Finding]:
    """Finds scales and signs of the positions.

    has_misfit  whether the motor equation does not explain the torque: then the torque is no
                evidence of a wrong scale
    """
    if positions.scale is not None:
        is_doubtful = positions.may_be_held or (has_misfit and positions.by_torque)
        severity = Severity.NOTE if is_doubtful else Severity.WRONG
        about = "held" if abs(positions.scale.measured) > 1 else ""
        yield finding(Kind.SLOPE, severity, positions.scale, "", 1.0, about)
    if positions.sign is not None:
        yield finding(Kind.SLOPE, Severity.WRONG, positions.sign, "", 1.0, "sign")


def of_gears(view: LogView) -> Iterator[Finding]:
    """Finds gear ratios of theta and tau that are neither 1 nor motor.gamma."""
    gamma = abs(view.gamma)
    for name in ("theta", "tau"):
        port = view.configuration.ports.get(name)
        gear = abs(port.gear_ratio) if port else 1.0
        if gear == 1 or abs(gamma / gear - 1) < _SAME:
            continue
        keys = [("motor.gamma", gear), (f"ports.{name}.gear_ratio", gamma)]
        if name == "tau":
            keys.reverse()
        (key, right), other = keys
        yield Finding(Kind.GEAR, Severity.WRONG, key, other[1], "", right, right, [other], name)


def of_sizes(positions: Positions) -> Iterator[Finding]:
    """Finds a torque, an inertia or a deformation that is implausible for any joint."""
    for size in implausible_sizes(positions):
        severity = Severity.WRONG if size.is_certain else Severity.NOTE
        yield finding(Kind.SIZE, severity, size, size.unit, size.usual, size.size.value)


def of_torque(positions: Positions, has_misfit: bool) -> Iterator[Finding]:
    """Finds what the torque contradicts.

    has_misfit  whether the motor equation does not explain the torque: then only errors that no
                misfit causes are more than notes
    """
    evidence = compare_torque(positions)
    certain = []
    if evidence.sign is not None and evidence.sign.power > 0:
        certain.append(Kind.SIGN)
    if evidence.inertia is not None and _is_far(evidence.inertia, _LARGER):
        certain += [Kind.INERTIA, Kind.TORQUE_SCALE]
    for each in _of_torque(positions.view, evidence):
        is_doubtful = has_misfit and each.kind not in certain
        yield replace(each, severity=Severity.NOTE) if is_doubtful else each


def _of_torque(view: LogView, evidence: TorqueEvidence) -> Iterator[Finding]:
    if evidence.gear is not None:
        yield finding(Kind.SLOPE, Severity.WRONG, evidence.gear, "", 1.0)
    if evidence.sign is not None:
        yield _of_sign(view, evidence.sign)
    if evidence.deformation is not None:
        kind = Kind.STIFFNESS_SIGN
        yield finding(kind, Severity.WRONG, evidence.deformation, "N.m/rad")
    if evidence.swap is not None:
        yield finding(Kind.STIFFNESS_SIGN, Severity.WRONG, evidence.swap, "N.m/rad", about="swap")
    if evidence.zero is not None:
        yield from _of_zero(view, evidence.zero)
    if evidence.asymmetry is not None:
        yield finding(Kind.ASYMMETRY, Severity.NOTE, evidence.asymmetry, "", 1.0)
    if evidence.torque_delay is not None:
        yield _of_torque_delay(view, evidence.torque_delay)
    if evidence.encoder_delay is not None:
        severity = Severity.WRONG if evidence.encoder_delay.least > view.T else Severity.NOTE
        about = "" if is_friction_known(view) else "at least "
        yield finding(Kind.ENCODER_LAG, severity, evidence.encoder_delay, "s", 0.0, about)
    if evidence.inertia is not None:
        yield _of_inertia(evidence.inertia)


def _of_sign(view: LogView, sign: Sign) -> Finding:
    port = "tau_e_sensor" if view.has_sensor else "tau"
    if sign.by_power:
        found = finding(Kind.SIGN, Severity.WRONG, sign, "W", about="power")
        return replace(found, measured=sign.power)
    return finding(Kind.SIGN, Severity.WRONG, sign, "N.m/rad", about=port)


def _of_zero(view: LogView, zero: Zero) -> Iterator[Finding]:
    """Yields a wrong zero, but only a note within the deformations of the log: identify sets it."""
    bias = 0.0  # largest bias of the torque that the estimator expects [N.m]
    if view.parameters["method"] == "FilteredRegression":
        bias = _STD * float(view.parameters["prior.bias"]) * _size_of_torque(view)
    if abs(zero.measured) > zero.covered / 2 and zero.torque > bias:
        yield finding(Kind.ZERO, Severity.WRONG, zero, "rad", 0.0)
    elif zero.is_symmetric:
        yield finding(Kind.ZERO, Severity.NOTE, zero, "rad", 0.0)


def _size_of_torque(view: LogView) -> float:
    """Returns prior.tau_e, or before `identify` has set it the largest torque [N.m]."""
    if "prior.tau_e" in view.configuration.parameters:
        return float(view.parameters["prior.tau_e"])
    return abs(view.gamma) * max(float(np.max(np.abs(piece.tau))) for piece in view.pieces)


def _of_torque_delay(view: LogView, delay: Delay) -> Finding:
    is_within_prior = delay.least < _STD * float(view.parameters["prior.delay"])
    if delay.measured < 0 or is_within_prior:
        # No key is wrong: damping and hysteresis of the spring look like an early torque, too.
        key = delay.hypotheses[0].key
        return Finding(Kind.TORQUE_LAG, Severity.NOTE, key, delay.measured, "s", 0.0)
    return finding(Kind.TORQUE_LAG, Severity.WRONG, delay, "s", 0.0)


def _of_inertia(inertia: Inertia) -> Finding:
    unit, given = "kg.m2", inertia.given
    if inertia.is_geared:
        return finding(Kind.TORQUE_SCALE, Severity.WRONG, inertia, unit, given)
    is_wrong = given == _AWAS or _is_far(inertia, _LARGE)
    severity = Severity.WRONG if is_wrong else Severity.NOTE
    return finding(Kind.INERTIA, severity, inertia, unit, given)


def _is_far(inertia: Inertia, factor: float) -> bool:
    """Returns whether the inertia differs from the configured one by more than a factor, given as
    its logarithm."""
    return distance(inertia.measured, inertia.given) > factor
