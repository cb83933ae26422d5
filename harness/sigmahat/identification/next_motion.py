"""Which motion would make known what a log does not determine.

Candidates are pairs of sines of the motor, with at most twice the torque and 1.5 times the
deformation of the log. Each is put through the fit of the motor equation, rounded as the encoders
do: the larger one of two half widths counts, that of this fit, and the one from its regressors with
the errors of the present log, sqrt(s^2 (Z'X)^-1 Z'Z (X'Z)^-1).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sigmahat.identification.noise import low_pass, variance
from sigmahat.identification.quantities import Advice, Motion, Quantity
from sigmahat.identification.regression import (
    MOTOR,
    Equations,
    Form,
    Signals,
    equations,
    fit,
)
from sigmahat.logs.log import Array

_FREQUENCIES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
_TRIED = 20.0  # [s] of a candidate
_LONGEST = 600.0  # [s]
_WANTED = 0.05  # half width over the value
_TORQUE, _DEFORMATION = 2.0, 1.5  # over the largest of the log
_TRAVEL = 0.25  # [rad] to either side that every joint can turn
_NORMAL = 1.96
_SEEN = 1.0  # half width of the stiffness over its value: above it a deformation is not known
_STIFFNESS = "stiffness"
_LINEAR = "eta[0,0]"


def advice(
    pieces: Sequence[Signals],
    T: float,
    gamma: float,
    form: Form,
    quantities: Mapping[str, Quantity],
    B: float,
    steps: tuple[float, float],
) -> list[Advice]:
    """A motion for each quantity that the log does not determine.

    pieces      of the log
    T           time between samples [s]
    gamma       gear ratio
    form        of the motor equation, with the orders of the polynomial
    quantities  what was identified
    B           inertia to reckon with where the log does not show it [kg.m2]
    steps       of the encoders of theta and q [rad]; 0 if a signal is not rounded
    """
    form = replace(form, n=1, m=1, symmetric=True)
    pieces = [replace(piece, tau_e=None) for piece in pieces]
    system = equations(pieces, T, gamma, form)
    found = fit(system)
    p: Array = np.linalg.lstsq(system.X, system.y, rcond=1e-12)[0].astype(np.float64)
    values = dict(zip(system.names, p.tolist(), strict=True))
    known = {
        name: _share(q.half_width, q.value)
        for name, q in quantities.items()
        if name in MOTOR and not q.determined
    }
    k = _share(found.half_width[_LINEAR], values[_LINEAR])
    if not k < 2 * _WANTED:
        known[_STIFFNESS] = k
    if not k < _SEEN:
        return [Advice(name, value, None, math.inf) for name, value in known.items()]
    determined = {name: q.value for name, q in quantities.items() if q.determined}
    values = {**values, "B": B, **determined}
    joint = _Joint.of(pieces, T, gamma, system.units[0], values)
    noise = _Noise(_error(system, p), max(variance(piece.tau) for piece in pieces), steps)
    trials = list(_trials(joint, pieces, form, noise))
    return [_best(name, value, values, trials) for name, value in known.items()]


def _share(half_width: float, value: float) -> float:
    return half_width / abs(value) if value and math.isfinite(half_width) else math.inf


@dataclass(frozen=True)
class _Joint:
    """A linear joint that moves as in the log, to reckon what a motion would give."""

    gamma: float
    k: float
    """Stiffness [N.m/rad]."""
    link: Array
    """Inertia, damping and weight of the link, per acceleration, velocity and angle."""
    motor: tuple[float, float, float]
    """B, D_theta, tau_coulomb."""
    T: float

    @staticmethod
    def of(
        pieces: Sequence[Signals], T: float, gamma: float, unit: float, v: Mapping[str, float]
    ) -> _Joint:
        """From the fit to a log: the link by least squares from the torque of the spring."""
        k = max(-gamma * v[_LINEAR] / unit, 0.0)
        piece = max(pieces, key=lambda each: len(each.theta))
        q = low_pass(piece.theta + piece.phi, min(20.0, 0.1 / T), T)
        phi = low_pass(piece.phi, min(20.0, 0.1 / T), T)
        q_dot = np.gradient(q, T)
        X = np.column_stack([np.gradient(q_dot, T), q_dot, q, np.ones_like(q)])
        link = np.linalg.lstsq(X, -k * phi, rcond=1e-12)[0][:3]
        motor = v["B"], v["D_theta"], v["tau_coulomb"]
        return _Joint(gamma, k, np.maximum(link, 0.0), motor, T)

    def phi(self, sines: Sequence[tuple[float, float]], duration: float) -> Array:
        """Deformation under sines of the motor [rad]."""
        M, D, g = self.link
        t = _times(self.T, duration)
        phi = np.zeros_like(t)
        for A, f in sines:
            s = 2j * math.pi * f
            load = M * s**2 + D * s + g
            phi += A * np.imag(-load / (self.k + load) * np.exp(s * t)) if self.k else 0.0
        return phi

    def torque(self, theta: Array, phi: Array) -> Array:
        """Torque of the motor for a motion [N.m]."""
        B, D_theta, tau_coulomb = self.motor
        v = np.gradient(theta, self.T)
        friction = D_theta * self.gamma * v + tau_coulomb * np.sign(v)
        inertia = B * self.gamma * np.gradient(v, self.T)
        torque: Array = inertia + friction - self.k * phi / self.gamma
        return torque


@dataclass(frozen=True)
class _Trial:
    """A candidate, and half of the intervals that it would give."""

    motion: Motion
    half_width: Mapping[str, float]


@dataclass(frozen=True)
class _Noise:
    """What disturbs a log."""

    error: float
    """Variance of the errors of the motor equation [(N.m)2]."""
    torque: float
    """Variance of the noise of the torque [(N.m)2]."""
    steps: tuple[float, float]
    """Of the encoders of theta and q [rad]."""

    def recorded(self, theta: Array, phi: Array, tau: Array) -> Signals:
        """A motion as it would be recorded."""
        q = _rounded(theta + phi, self.steps[1])
        theta = _rounded(theta, self.steps[0])
        noise = math.sqrt(self.torque) * np.random.default_rng(1).standard_normal(len(tau))
        return Signals(theta, q - theta, np.ones_like(tau), tau + noise, None)


def _rounded(x: Array, step: float) -> Array:
    return step * np.round(x / step) if step else x


def _trials(
    joint: _Joint, pieces: Sequence[Signals], form: Form, noise: _Noise
) -> Iterator[_Trial]:
    T = joint.T
    travel = max(_TRAVEL, max(float(np.ptp(piece.theta)) for piece in pieces) / 2)
    deformation = _DEFORMATION * max(float(np.max(np.abs(piece.phi))) for piece in pieces)
    torque = _TORQUE * max(float(np.max(np.abs(piece.tau))) for piece in pieces)
    possible = [f for f in _FREQUENCIES if f < min(form.f_0, 0.05 / T)]
    # A single sine has acceleration and deformation in phase: then one takes the other's place.
    for frequencies in itertools.combinations(possible, 2):
        # Amplitudes of equal acceleration, within the travel.
        wanted = [(min(travel / 2, 1 / f**2), f) for f in frequencies]
        scale = _largest(joint, wanted, travel, deformation, torque)
        sines = [(scale * A, f) for A, f in wanted]
        theta, phi = _theta(sines, T, _TRIED), joint.phi(sines, _TRIED)
        tau = joint.torque(theta, phi)
        system = equations([noise.recorded(theta, phi, tau)], T, joint.gamma, form)
        peak = float(np.max(np.abs(tau[10:-10])))
        reversals = int(np.count_nonzero(np.diff(np.sign(np.diff(theta)))))
        yield _Trial(Motion(sines, _TRIED, peak, reversals), _half_widths(system, noise.error))


def _largest(
    joint: _Joint,
    sines: Sequence[tuple[float, float]],
    travel: float,
    deformation: float,
    torque: float,
) -> float:
    """What the amplitudes may be multiplied by."""
    theta, phi = _theta(sines, joint.T, _TRIED), joint.phi(sines, _TRIED)
    friction = joint.motor[2]
    rest = np.max(np.abs(replace(joint, motor=(*joint.motor[:2], 0.0)).torque(theta, phi)[10:-10]))
    limits = [
        travel / float(np.max(np.abs(theta))),
        max(torque - friction, 0.1 * torque) / float(rest),
    ]
    if np.any(phi):
        limits.append(deformation / float(np.max(np.abs(phi))))
    return min(limits)


def _best(
    name: str, known_to: float, values: Mapping[str, float], trials: Sequence[_Trial]
) -> Advice:
    column = _LINEAR if name == _STIFFNESS else name
    value = abs(values[column])
    best = min(trials, key=lambda each: each.half_width[column], default=None)
    reached = best.half_width[column] / value if best and value else math.inf
    if best is None or not reached * math.sqrt(_TRIED / _LONGEST) < _WANTED:
        return Advice(name, known_to, None, reached)
    longer = max(1.0, (reached / _WANTED) ** 2)
    duration = math.ceil(_TRIED * longer / 10) * 10.0
    times = duration / _TRIED
    motion = replace(best.motion, duration=duration, reversals=int(times * best.motion.reversals))
    return Advice(name, known_to, motion, reached / math.sqrt(times))


def _error(system: Equations, p: Array) -> float:
    """Variance of the errors, as it counts for a sum over many samples: they are not white."""
    error = system.y - system.X @ p
    blocks = int(system.block[-1]) + 1
    scores = np.column_stack([np.bincount(system.block, x * error, blocks) for x in system.X.T])
    ratio = np.sum(scores**2, axis=0) / np.sum(system.X**2, axis=0)
    return float(np.median(ratio[np.isfinite(ratio)]))


def _half_widths(system: Equations, s2: float) -> dict[str, float]:
    """Half of the 95 % intervals of the coefficients; inf where a motion does not show them."""
    found = fit(system)
    if not all(map(math.isfinite, found.value.values())):
        return dict.fromkeys(system.names, math.inf)
    inverse = np.linalg.inv(system.Z.T @ system.X)
    covariance = s2 * inverse @ (system.Z.T @ system.Z) @ inverse.T
    of_log = _NORMAL * np.sqrt(np.diag(covariance))
    return {
        name: max(half_width, other)
        for (name, half_width), other in zip(found.half_width.items(), of_log.tolist(), strict=True)
    }


def _times(T: float, duration: float) -> Array:
    return T * np.arange(round(duration / T), dtype=np.float64)


def _theta(sines: Sequence[tuple[float, float]], T: float, duration: float) -> Array:
    t = _times(T, duration)
    theta: Array = np.sum([A * np.sin(2 * math.pi * f * t) for A, f in sines], axis=0)
    return theta
