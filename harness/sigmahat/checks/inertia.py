"""The inertia of the log beside that of the configuration: a torque geared twice shows in it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from sigmahat.checks.findings import Finding, Kind, Severity
from sigmahat.checks.motor import Fitted, explains, variants, with_form, with_inertia
from sigmahat.checks.view import View
from sigmahat.identification.quantities import WIDE
from sigmahat.identification.regression import Signals

_AWAS = 2.3e-5  # [kg.m2] of motor.B, the start value
_LARGE = 5.0
"""Friction and delays of other forms than those of the equation change B by less than this."""
_DIFFERENT = 2.0  # and a torque constant is not wrong by more than this
_LIKE = 3.0  # a ratio of inertias is that of the gear up to this factor


def inertia(seen: View, pieces: Sequence[Signals], found: Fitted) -> Iterator[Finding]:
    """The inertia, or what the torque is multiplied by, where the log shows it clearly."""
    given = float(seen.every["motor.B"])
    B = _nearest(seen, pieces, found, given) if given > 0 else None
    if B is None or not _differs(B, given, _DIFFERENT):
        return
    if not explains(with_inertia(seen, pieces, found.form, given), found.fit):
        return
    B = found.linear.value["B"]
    unit, rounded = "kg.m2", float(f"{B:.3g}")
    is_known = float(seen.every["prior.B"]) < WIDE  # else nobody has said that B is right
    gamma = abs(seen.gamma)
    geared = [each for each in (gamma, 1 / gamma) if not _differs(B, each * given, _LIKE)]
    is_given = "motor.B" in seen.configuration.parameters and is_known
    if is_given and geared and gamma > _LIKE**2:
        port = seen.configuration.ports["tau"]
        proposed = float(f"{port.gear_ratio * geared[0]:.6g}")
        kind, key = Kind.TORQUE_SCALE, "ports.tau.gear_ratio"
        others = [("motor.B", rounded)]
        yield Finding(kind, Severity.WRONG, key, B, unit, given, proposed, others)
        return
    is_wrong = is_known and (given == _AWAS or _differs(B, given, _LARGE))
    severity = Severity.WRONG if is_wrong else Severity.NOTE
    constant = [("ports.tau.torque_constant", None)]
    yield Finding(Kind.INERTIA, severity, "motor.B", B, unit, given, rounded, constant)


def _nearest(seen: View, pieces: Sequence[Signals], found: Fitted, given: float) -> float | None:
    """Of the inertias with other forms of friction, and the ends of the interval, the one that
    differs least from the configured one; None if one of them is not above 0."""
    B, half = found.linear.value["B"], found.linear.half_width["B"]
    if not 0 < B - half < math.inf or not _differs(B, given, _DIFFERENT):
        return None
    every = [with_form(seen, pieces, form).value["B"] for form in variants(found.form)]
    every += [B - half, B + half]
    if not all(each > 0 for each in every):
        return None
    return min(every, key=lambda each: abs(math.log(each / given)))


def _differs(one: float, other: float, factor: float) -> bool:
    return abs(math.log(one / other)) > math.log(factor)
