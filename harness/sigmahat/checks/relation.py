"""How q follows theta: their slope is 1, unless a sign, a unit, a gear or an encoder is wrong.

In slow motion the link follows its motor. Near the resonance it does not, and a link that is held
does not either. So a slope alone is no proof: with the scale that it proposes, the motor
equation must fit the torque as well as before, or better.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sigmahat.checks.findings import Finding, Kind, Proposal, Severity
from sigmahat.checks.motor import LINEAR, Fitted, fitted
from sigmahat.checks.view import View
from sigmahat.identification.noise import low_pass
from sigmahat.identification.regression import Signals, is_worse
from sigmahat.logs.configuration import Port
from sigmahat.logs.log import Array
from sigmahat.logs.units import factor

_ANGLES = ("rad", "deg", "turn")
_COUNTS = tuple(2.0**k for i in (2, 1, 3, 4, 5, 6) for k in (i, -i))
"""Other numbers of counts: the evaluation of lines is two- or four-fold, and wraps are no turns."""
_LIKE = math.log(2.0)
"""A spring deforms, so q and theta do not move alike: a factor is recognised up to this."""


@dataclass(frozen=True)
class Change:
    """Another value of a key, and by what it multiplies the values of the port."""

    key: str
    value: Proposal
    factor: float
    fits_any: bool = False
    """Whether it is made for the slope of the log, whatever that is."""


def changes(name: str, port: Port, gamma: float) -> Iterator[Change]:
    """Changes of the scale of an angle, the likely ones first.

    name   theta or q
    gamma  gear ratio of the motor
    """
    where, gear = f"ports.{name}", abs(port.gear_ratio)
    if name == "theta" and gear != abs(gamma):
        yield Change(f"{where}.gear_ratio", abs(gamma), gear / abs(gamma))
    if gear != 1:
        yield Change(f"{where}.gear_ratio", 1.0, gear)
    if port.scale is None and port.unit in (None, *_ANGLES):
        now = factor(name, port)
        for unit in _ANGLES:
            other = factor(name, Port(port.column, unit=unit))
            if other != now:
                yield Change(f"{where}.unit", unit, other / now)
    if port.unit == "counts" and port.counts_per_turn is not None:
        for times in _COUNTS:
            value = port.counts_per_turn * times
            yield Change(f"{where}.counts_per_turn", value, 1 / times)


def gear_of(theta: Port, slope: float) -> Change:
    """The gear ratio with which the motor moves as far as the link."""
    gear = abs(theta.gear_ratio) / slope
    whole = round(gear)
    likely = float(whole) if whole and abs(gear / whole - 1) < _WHOLE else float(f"{gear:.4g}")
    return Change("ports.theta.gear_ratio", likely, slope, fits_any=True)


def _unlikely(name: str, change: Change, slope: float) -> float:
    """Small for a change that comes first."""
    return _ANY if change.fits_any else round(distance(_on_theta(name, change), slope), 1)


def like(one: float, other: float) -> bool:
    """Whether two positive factors may be the same."""
    return distance(one, other) < _LIKE


def distance(one: float, other: float) -> float:
    """Distance of two positive factors on a logarithmic scale [1]."""
    return abs(math.log(one / other))


_WHOLE = 0.02
"""Gear ratios are whole numbers more often than not: up to this, the nearest one is proposed."""
_ANY = 0.05
"""Distance of a gear ratio that is made for the slope: what agrees by itself comes first."""
_SLOW = 1.0  # [Hz]
_ENOUGH = 0.1  # of the motion must be slow, else all of it is taken
_CORRELATED = 0.9
_FAR = 5.0  # a spring may make the motion of the link so much larger, below its resonance
_DIFFERENT = 1.5  # a slope so near to 1 is that of a soft spring
_BETTER = 0.8  # squared errors over those before
_AS_WELL = 0.25  # of the logarithm of a factor: another one explains the same
PORTS = ("theta", "q")


@dataclass(frozen=True)
class Relation:
    """The motion of q and theta after what was found wrong is put right."""

    findings: Sequence[Finding]
    pieces: Sequence[Signals]
    """As View.pieces, with the scales that were proposed."""
    fitted: Fitted | None
    """The motor equation of these pieces."""


def relation(seen: View) -> Relation:
    """Compares the motion of q with that of theta, and puts scale and sign right."""
    here = Relation((), seen.pieces, fitted(seen, seen.pieces))
    if not {"theta", "q"} <= set(seen.samples.names) or _is_from_torque(seen.configuration.ports):
        return here
    found = slope_of(seen.pieces, seen.T)
    if found is None:
        return here
    here = _scale(seen, here, found)
    return _sign(seen, here, found)


def _is_from_torque(ports: Mapping[str, Port]) -> bool:
    """Whether theta is the compliance of a test bench, from the torque: it drives no link."""
    return "tau_e_sensor" in ports and ports["theta"].column == ports["tau_e_sensor"].column


def _scale(seen: View, here: Relation, slope: float) -> Relation:
    if not abs(np.log(abs(slope))) > np.log(_DIFFERENT):
        return here
    every: list[tuple[str, Change]] = [
        ("theta", gear_of(seen.configuration.ports["theta"], abs(slope)))
    ]
    every += [
        (name, change)
        for name in PORTS
        for change in changes(name, seen.configuration.ports[name], seen.gamma)
        if like(_on_theta(name, change), abs(slope))
    ]
    every.sort(key=lambda each: _unlikely(each[0], each[1], abs(slope)))
    best: tuple[str, Change] | None = None
    found = here
    for name, change in every:
        repaired = [_scaled(piece, name, change.factor) for piece in here.pieces]
        after = fitted(seen, repaired)
        is_next = (
            _is_plausible(here.fitted, after, abs(slope))
            if best is None
            else _is_better(found.fitted, after)
        )
        if is_next:
            best, found = (name, change), Relation((), repaired, after)
    if best is None:
        return here
    key, factor = best[1].key, _on_theta(*best)
    others = [
        (change.key, change.value)
        for name, change in every
        if change.key != key and distance(_on_theta(name, change), factor) < _AS_WELL
    ]
    finding = Finding(Kind.SLOPE, Severity.WRONG, key, slope, "", 1.0, best[1].value, others)
    return replace(found, findings=[finding])


def _sign(seen: View, here: Relation, slope: float) -> Relation:
    if slope > 0:
        return here
    flipped = [_scaled(piece, "q", -1.0) for piece in here.pieces]
    after = fitted(seen, flipped)
    before = here.fitted
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
        # With the sign of theta instead, all that moves the motor has the other sign.
        name = "q"
        keys = dict(reversed(keys.items()))
    (key, proposed), *others = keys.items()
    finding = Finding(Kind.SLOPE, Severity.WRONG, key, slope, "", 1.0, proposed, others, "sign")
    if name == "theta":
        flipped = [_scaled(piece, "theta", -1.0) for piece in here.pieces]
        after = fitted(seen, flipped)
    return Relation([*here.findings, finding], flipped, after)


def _sign_of_motor(found: Fitted | None) -> float:
    """Sign of inertia and friction together; 0 if they do not show it."""
    if found is None:
        return 0.0
    scores = [
        found.linear.value[name] / found.linear.half_width[name]
        for name in ("B", "D_theta", "tau_coulomb")
        if 0 < found.linear.half_width.get(name, np.inf) < np.inf
    ]
    return float(np.sign(sum(score for score in scores if abs(score) > 1)))


def _on_theta(name: str, change: Change) -> float:
    """What theta would have to be multiplied by, instead of the port."""
    return change.factor if name == "theta" else 1 / change.factor


def _scaled(piece: Signals, name: str, factor: float) -> Signals:
    theta, q = piece.theta, piece.theta + piece.phi
    theta, q = (factor * theta, q) if name == "theta" else (theta, factor * q)
    return replace(piece, theta=theta, phi=q - theta)


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
    """Slope of q on theta by total least squares, in slow motion if there is any."""
    if not pieces:
        return None
    both = np.concatenate([_slow(np.column_stack([p.theta, p.theta + p.phi]), T) for p in pieces])
    variances = np.var(both, axis=0)
    if not np.all(variances > 0):
        return None
    # Scaled to one variance: their axis is then the diagonal, whatever the units are.
    if abs(np.corrcoef(both.T)[0, 1]) < _CORRELATED:
        return None
    sign = np.sign(np.corrcoef(both.T)[0, 1])
    return float(sign * np.sqrt(variances[1] / variances[0]))


def _slow(motion: Array, T: float) -> Array:
    """Without its mean; only what is slow, if that is enough of the motion."""
    motion = motion - motion.mean(axis=0)
    slow = low_pass(motion, min(_SLOW, 0.1 / T), T)
    return slow if np.all(np.std(slow, axis=0) > _ENOUGH * np.std(motion, axis=0)) else motion
