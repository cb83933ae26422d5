"""How q follows theta: their slope is 1, unless a sign, a unit, a gear or an encoder is wrong.

In slow motion the link follows its motor. Near the resonance the link does not, nor if the link is
held. So a slope alone is no proof: with the scale that the slope proposes, the motor equation must
fit the torque as well as before, or better.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sigmahat.checks.findings import Finding, Kind, Proposal, Severity
from sigmahat.checks.motor import LINEAR, Fitted, fitted, gear_error
from sigmahat.checks.view import View
from sigmahat.identification.noise import low_pass
from sigmahat.identification.regression import Signals, is_worse
from sigmahat.logs.configuration import Port
from sigmahat.logs.log import Array
from sigmahat.logs.units import factor

_ANGLES = ("rad", "deg", "turn")
_COUNTS = tuple(2.0**k for i in (2, 1, 3, 4, 5, 6) for k in (i, -i))
"""Likely factors of wrong counts: two or four counts per line, and wraps mistaken for turns."""
_LIKE = math.log(2.0)
"""Tolerance of the logarithm of a factor: a spring deforms, so q and theta do not move alike."""


@dataclass(frozen=True)
class Change:
    """Another value of a key, and the factor by which the values of the port change."""

    port: str  # theta or q
    key: str
    value: Proposal
    factor: float
    fits_any: bool = False
    """Whether the value was computed from the slope of the log, so that any slope fits."""

    @property
    def on_theta(self) -> float:
        """The factor of theta that has the same effect on the slope."""
        return self.factor if self.port == "theta" else 1 / self.factor


def changes(name: str, port: Port, gamma: float) -> Iterator[Change]:
    """Changes of the scale of an angle, likely changes first.

    name   theta or q
    gamma  gear ratio of the motor
    """
    where, gear = f"ports.{name}", abs(port.gear_ratio)
    if name == "theta" and gear != abs(gamma):
        yield Change(name, f"{where}.gear_ratio", abs(gamma), gear / abs(gamma))
    if gear != 1:
        yield Change(name, f"{where}.gear_ratio", 1.0, gear)
    if port.scale is None and port.unit in (None, *_ANGLES):
        now = factor(name, port)
        for unit in _ANGLES:
            other = factor(name, Port(port.column, unit=unit))
            if other != now:
                yield Change(name, f"{where}.unit", unit, other / now)
    if port.unit == "counts" and port.counts_per_turn is not None:
        for times in _COUNTS:
            value = port.counts_per_turn * times
            yield Change(name, f"{where}.counts_per_turn", value, 1 / times)


def gear_of(theta: Port, slope: float) -> Change:
    """The gear ratio with which the motor moves as far as the link."""
    gear = abs(theta.gear_ratio) / slope
    whole = round(gear)
    likely = float(whole) if whole and abs(gear / whole - 1) < _WHOLE else float(f"{gear:.4g}")
    return Change("theta", "ports.theta.gear_ratio", likely, slope, fits_any=True)


def distance(one: float, other: float) -> float:
    """Distance of two positive factors on a logarithmic scale [1]."""
    return abs(math.log(one / other))


_WHOLE = 0.02
"""Most gear ratios are integers: up to this relative error, the nearest integer is proposed."""
_ANY = 0.05
"""Sort key of a gear ratio that was computed from the slope: other changes that agree are first."""
_SLOW = 1.0  # [Hz]
_ENOUGH = 0.1  # least fraction of slow motion, else the whole motion is used
_CORRELATED = 0.9
_FAR = 5.0  # below resonance, a spring may enlarge the motion of the link by this factor
_DIFFERENT = 1.5  # up to this factor, a soft spring may be the cause of the slope
_BETTER = 0.8  # largest ratio of the squared errors, after to before
_PRECISE = 0.01  # largest half width of the correction of a gear ratio [1]
_AS_WELL = 0.25  # tolerance of the logarithm: another factor explains the same slope
PORTS = ("theta", "q")


@dataclass(frozen=True)
class Relation:
    """The motion of q and theta after the errors found are corrected."""

    findings: Sequence[Finding]
    seen: View  # the log, with the scales that were proposed
    fitted: Fitted | None  # the motor equation of this log


def relation(seen: View) -> Relation:
    """Compares the motions of q and theta, and corrects scale and sign."""
    here = Relation((), seen, fitted(seen))
    if not {"theta", "q"} <= set(seen.samples.names) or _is_from_torque(seen.configuration.ports):
        return here
    found = slope_of(seen.pieces, seen.T)
    return here if found is None else _sign(_scale(here, found), found)


def _is_from_torque(ports: Mapping[str, Port]) -> bool:
    """Whether theta is the compliance of a test bench, from the torque: theta drives no link."""
    return "tau_e_sensor" in ports and ports["theta"].column == ports["tau_e_sensor"].column


def _scale(here: Relation, slope: float) -> Relation:
    if not abs(np.log(abs(slope))) > np.log(_DIFFERENT):
        return here
    ports = here.seen.configuration.ports
    every = [gear_of(ports["theta"], _refined(here.seen, abs(slope)))]
    every += [
        change
        for name in PORTS
        for change in changes(name, ports[name], here.seen.gamma)
        if distance(change.on_theta, abs(slope)) < _LIKE
    ]

    def unlikely(each: Change) -> float:
        """The change with the smallest value is tried first."""
        return _ANY if each.fits_any else round(distance(each.on_theta, abs(slope)), 1)

    every.sort(key=unlikely)
    best: Change | None = None
    found = here
    for change in every:
        repaired = _scaled(here.seen, change.port, change.factor)
        after = fitted(repaired)
        is_next = _is_better(found.fitted, after)
        if best is None:
            is_next = _is_plausible(here.fitted, after, abs(slope))
        if is_next:
            best, found = change, Relation((), repaired, after)
    if best is None:
        return here
    others = [
        (change.key, change.value)
        for change in every
        if change.key != best.key and distance(change.on_theta, best.on_theta) < _AS_WELL
    ]
    finding = Finding(Kind.SLOPE, Severity.WRONG, best.key, slope, "", 1.0, best.value, others)
    return replace(found, findings=[finding])


def _refined(seen: View, slope: float) -> float:
    """The slope that the motor equation shows near a slope of the motions.

    Motor and link of a flexible joint move alike only roughly, the torque depends on 1 % of theta.
    """
    near = _scaled(seen, "theta", slope)
    found = fitted(near)
    error = None if found is None else gear_error(near, found.form)
    return slope if error is None or error.half_width > _PRECISE else slope * error.value


def _sign(here: Relation, slope: float) -> Relation:
    if slope > 0:
        return here
    seen, before = here.seen, here.fitted
    flipped = _scaled(seen, "q", -1.0)
    after = fitted(flipped)
    if before is not None and after is not None:
        is_stiff = before.linear.value[LINEAR] * seen.gamma < 0
        if is_worse(after.fit, before.fit) or (is_stiff and not _is_better(before, after)):
            return here
    ports = seen.configuration.ports
    keys = {f"ports.{name}.sign": -ports[name].sign for name in PORTS}
    gear, name = ports["theta"].gear_ratio, "theta"
    if gear < 0:
        keys = {"ports.theta.gear_ratio": -gear, "ports.q.sign": keys["ports.q.sign"]}
    elif not _sign_of_motor(after) < 0:
        # A change of the sign of theta instead would change the signs of inertia and friction.
        name = "q"
        keys = dict(reversed(keys.items()))
    (key, proposed), *others = keys.items()
    finding = Finding(Kind.SLOPE, Severity.WRONG, key, slope, "", 1.0, proposed, others, "sign")
    if name == "theta":
        flipped = _scaled(seen, "theta", -1.0)
        after = fitted(flipped)
    return Relation([*here.findings, finding], flipped, after)


def _sign_of_motor(found: Fitted | None) -> float:
    """Common sign of inertia and friction; 0 if the fit does not determine this sign."""
    if found is None:
        return 0.0
    scores = [
        found.linear.value[name] / found.linear.half_width[name]
        for name in ("B", "D_theta", "tau_coulomb")
        if 0 < found.linear.half_width.get(name, np.inf) < np.inf
    ]
    return float(np.sign(sum(score for score in scores if abs(score) > 1)))


def _scaled(seen: View, name: str, factor: float) -> View:
    """The log with another scale of theta or q."""
    of_theta, of_q = (factor, 1.0) if name == "theta" else (1.0, factor)
    pieces = []
    for piece in seen.pieces:
        theta, q = of_theta * piece.theta, of_q * (piece.theta + piece.phi)
        pieces.append(replace(piece, theta=theta, phi=q - theta))
    return replace(seen, pieces=pieces)


def _is_plausible(before: Fitted | None, after: Fitted | None, slope: float) -> bool:
    if before is None or after is None:
        return True
    if max(slope, 1 / slope) > _FAR:
        return not is_worse(after.fit, before.fit)
    return _is_better(before, after)


def _is_better(before: Fitted | None, after: Fitted | None) -> bool:
    if before is None or after is None:
        return False
    return is_worse(before.fit, after.fit) and after.error < _BETTER * before.error


def slope_of(pieces: Sequence[Signals], T: float) -> float | None:
    """Slope of q on theta by total least squares, of the slow motion if the log has any."""
    if not pieces:
        return None
    both = np.concatenate([_slow(np.column_stack([p.theta, p.theta + p.phi]), T) for p in pieces])
    variances = np.var(both, axis=0)
    if not np.all(variances > 0):
        return None
    # If both are scaled to variance 1, the axis is the diagonal, whatever the units are.
    correlation = np.corrcoef(both.T)[0, 1]
    if abs(correlation) < _CORRELATED:
        return None
    return float(np.sign(correlation) * np.sqrt(variances[1] / variances[0]))


def _slow(motion: Array, T: float) -> Array:
    """The motion without its mean; only the slow part, if this part is large enough."""
    motion = motion - motion.mean(axis=0)
    slow = low_pass(motion, min(_SLOW, 0.1 / T), T)
    return slow if np.all(np.std(slow, axis=0) > _ENOUGH * np.std(motion, axis=0)) else motion
