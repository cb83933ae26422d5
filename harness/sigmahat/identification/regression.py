"""Regression of the motor equation with instrumental variables against the noise of encoders.

The motor (3) with Coulomb friction, on its axis, with the flexibility torque as a polynomial (16)
whose coefficients are unknown as well:

    tau = B gamma theta'' + D_theta gamma theta' + tau_coulomb tanh(theta'/v_s) - tau_e/gamma + c

is linear in all unknowns. The constant c is a torque that does not change, and the torque of the
spring at a wrong zero of the deformation.

Least squares would be biased: theta'' of a rounded position is mostly noise, and noise in a
regressor makes its coefficient too small. Therefore even and odd samples are filtered and
differentiated separately. Their rounding errors are independent while the joint moves, and the
regressors of each half are the instruments of the other half: the sums Z'X contain no
squared noise.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.instance import Value
from sigmahat.identification.noise import low_pass
from sigmahat.joint.sheet import powers_of_phi
from sigmahat.logs.log import Array
from sigmahat.logs.resampling import stretches
from sigmahat.logs.sampling import Samples

MOTOR = ("B", "D_theta", "tau_coulomb")
"""Names of the first columns, which describe the motor."""
COULOMB_VELOCITY = 0.02
"""v_s, the velocity over which the friction changes its sign [rad/s]."""
CONSTANT = "constant"
"""Name of the column of c."""
_BLOCK = 0.25  # [s]; errors further apart are taken as independent
_EDGE = 0.1  # [s] left out at both ends of a piece, where the filter has not settled

_LEAST = 40
"""Samples of a stretch: filters need some."""


@dataclass(frozen=True)
class Signals:
    """A piece of a log without gaps; arrays of one size, T apart."""

    theta: Array
    phi: Array
    set_point: Array
    tau: Array
    tau_e: Array | None
    """Torque of the sensor, if the torque constant is to be identified."""


@dataclass(frozen=True)
class Form:
    """What the equations contain, and the filters."""

    f_0: float
    """Low pass of both sides [Hz]."""
    wide: float
    """Low pass of the velocity in the Coulomb friction, which changes fast [Hz]."""
    n: int = 1
    """Order of the polynomial, as rls.n."""
    m: int = 1
    """As rls.m."""
    symmetric: bool = True
    """Only odd powers of the deformation, as rls.symmetric."""
    coulomb_velocity: float = COULOMB_VELOCITY
    """v_s [rad/s]."""
    load_friction: bool = False
    """Whether there is friction that is proportional to the magnitude of the deformation."""
    stribeck_velocity: float = 0.0
    """v, if friction is larger in slow motion [rad/s]; 0 if it is not. The additional part falls as
    exp(-|theta'/v|^delta) (Armstrong-Helouvry, Dupont and Canudas de Wit, Automatica 30:1083-1138,
    1994)."""
    stribeck_exponent: float = 2.0
    """delta, usually 1 or 2."""

    delay: bool = False
    """Whether the torque may be late: tau(t - delay) = tau(t) - delay tau'(t)."""

    def names(self, sensor: bool) -> list[str]:
        """Names of the columns. With a torque sensor the polynomial is replaced by a gain."""
        has_constant = sensor or self.symmetric  # else it is a coefficient of the polynomial
        return [
            *MOTOR,
            *(["load"] if self.load_friction else []),
            *(["stribeck"] if self.stribeck_velocity else []),
            *(["delay"] if self.delay else []),
            *([CONSTANT] if has_constant else []),
            *(["gain"] if sensor else eta(self.n, self.m)),
        ]


@dataclass(frozen=True)
class Equations:
    """y = X p + error, with instruments Z; both halves of all pieces, one after another."""

    y: Array
    X: Array
    Z: Array
    block: NDArray[np.int64]
    """Stretch of time of each row, [size: rows]."""
    names: Sequence[str]
    """Names of the columns, see Form.names."""
    units: tuple[float, float]
    """What deformation and set-point are divided by in the polynomial [rad, 1]."""

    def only(self, names: Sequence[str]) -> Equations:
        """The same equations with some of the columns."""
        kept = [self.names.index(name) for name in names]
        X, Z = self.X[:, kept], self.Z[:, kept]
        return replace(self, X=X, Z=Z, names=list(names))

    def known(self, name: str, value: float) -> Equations:
        """The same equations without a column whose coefficient is known."""
        rest = self.only([each for each in self.names if each != name])
        return replace(rest, y=self.y - value * self.X[:, self.names.index(name)])


def equations(pieces: Sequence[Signals], T: float, gamma: float, form: Form) -> Equations:
    """The equations of all pieces, weighted by the low pass.

    T      time between samples [s]
    gamma  gear ratio
    """
    units = _unit([p.phi for p in pieces]), _unit([p.set_point for p in pieces])
    parts = []
    blocks = 0
    for piece in pieces:
        halves = [_half(piece, s, 2 * T, gamma, form, units) for s in (0, 1)]
        rows = min(len(y) for y, _ in halves)
        (y_0, X_0), (y_1, X_1) = ((y[:rows], X[:rows]) for y, X in halves)
        between_1 = np.vstack([X_1[:1], (X_1[1:] + X_1[:-1]) / 2])  # at the times of half 0
        between_0 = np.vstack([(X_0[1:] + X_0[:-1]) / 2, X_0[-1:]])
        edge = round(_EDGE / (2 * T))
        inner = slice(edge, rows - edge)
        block = blocks + np.arange(rows)[inner] // round(_BLOCK / (2 * T))
        blocks = int(block[-1]) + 1
        parts += [
            (y_0[inner], X_0[inner], between_1[inner], block),
            (y_1[inner], X_1[inner], between_0[inner], block),
        ]
    y, X, Z, block = (np.concatenate(each) for each in zip(*parts, strict=True))
    return Equations(y, X, Z, block, form.names(pieces[0].tau_e is not None), units)


def eta(n: int, m: int) -> list[str]:
    """Names of the columns of a polynomial of orders n and m."""
    return [f"eta[{i},{j}]" for i in range(n) for j in range(m)]


def shortest(T: float) -> int:
    """Least number of samples of a piece."""
    return round((2 * _EDGE + 2 * _BLOCK) / T)


def signals_of(
    samples: Samples, every: Mapping[str, Value], torque: str = "tau", sensor: bool = False
) -> Iterator[Signals]:
    """Stretches of a log without a gap that are long enough; none without q and the torque.

    every   parameters of the estimator
    torque  port of the torque; tau_e_sensor over the gear ratio takes the place of -tau
    sensor  whether the torque of the sensor is kept beside that of the motor
    """
    columns = dict(zip(samples.names, samples.values.T, strict=True))
    if not {"q", torque} <= columns.keys():
        return
    scale, offset = float(every["setPoint.scale"]), float(every["setPoint.offset"])
    for first, last in zip(*stretches(np.isfinite(samples.values).all(axis=1)), strict=True):
        if last - first < max(shortest(samples.T), _LEAST):
            continue
        part = {name: np.ascontiguousarray(each[first:last]) for name, each in columns.items()}
        nothing: Array = np.zeros(last - first)
        theta = part.get("theta", nothing)
        measured = part[torque]
        yield Signals(
            theta=theta,
            phi=part["q"] - theta,
            set_point=offset + scale * part.get("theta_c", nothing),
            tau=measured if torque == "tau" else -measured / float(every["motor.gamma"]),
            tau_e=part["tau_e_sensor"] if sensor else None,
        )


def _half(
    s: Signals, first: int, h: float, gamma: float, form: Form, units: tuple[float, float]
) -> tuple[Array, Array]:
    """Response and regressors of every second sample, h [s] apart, from a first one on."""
    kept = slice(first, None, 2)
    theta, tau = s.theta[kept], s.tau[kept]
    sensor = s.tau_e is not None
    friction = _direction(s.theta, h / 2, form.wide, form.coulomb_velocity)[kept]
    raw = [tau if s.tau_e is None else s.tau_e[kept] / gamma, friction]
    if form.load_friction:
        raw.append(np.abs(s.phi[kept] if s.tau_e is None else s.tau_e[kept]) * friction)
    if form.stribeck_velocity:
        speed = np.abs(_first(low_pass(s.theta, form.wide, h / 2), h / 2))[kept]
        raw.append(np.exp(-((speed / form.stribeck_velocity) ** form.stribeck_exponent)) * friction)
    if form.delay:
        raw.append(np.gradient(tau, h))
    if CONSTANT in form.names(sensor):
        raw.append(np.ones_like(tau))
    if sensor:  # tau_e/gamma = B gamma theta'' + ... - gain tau
        raw.append(-tau)
    else:
        x, y = s.phi[kept] / units[0], s.set_point[kept] / units[1]
        raw += [x**e * y**j for e in powers_of_phi(form.symmetric, form.n) for j in range(form.m)]
    filtered = low_pass(np.column_stack(raw), form.f_0, h)
    smooth = low_pass(theta, form.f_0, h)
    motion = [gamma * _second(smooth, h), gamma * _first(smooth, h)]
    return filtered[:, 0], np.column_stack([*motion, filtered[:, 1:]])


def _direction(theta: Array, T: float, wide: float, v_s: float) -> Array:
    """Mean of tanh(theta'/v_s) around each sample, for a velocity that is linear in between.

    A fast reversal happens between two samples: with the value at one of them its time would be
    wrong by up to half a period. For the same reason theta has all samples here, T [s] apart.
    """
    x = _first(low_pass(theta, wide, T), T) / v_s
    middle = np.concatenate([x[:1], (x[1:] + x[:-1]) / 2, x[-1:]])
    integral = np.logaddexp(middle, -middle)  # of tanh
    step = np.diff(middle)
    flat = np.abs(step) < 1e-3
    mean: Array = np.where(flat, np.tanh(x), np.diff(integral) / np.where(flat, 1.0, step))
    near = np.concatenate([mean[:1], mean, mean[-1:]])
    wider: Array = (near[:-2] + 2 * mean + near[2:]) / 4  # around a sample, 2 T apart
    return wider


def _unit(pieces: Sequence[Array]) -> float:
    """Largest magnitude in all pieces: divided by it, values have powers of order 1."""
    return max(float(np.max(np.abs(values))) for values in pieces) or 1.0


def _first(x: Array, h: float) -> Array:
    """First derivative, of fourth order in h; the two values at each end are not valid."""
    r = np.roll
    d: Array = (r(x, 2) - 8 * r(x, 1) + 8 * r(x, -1) - r(x, -2)) / (12 * h)
    return d


def _second(x: Array, h: float) -> Array:
    """Second derivative, as _first."""
    r = np.roll
    d: Array = (-r(x, 2) + 16 * r(x, 1) - 30 * x + 16 * r(x, -1) - r(x, -2)) / (12 * h**2)
    return d


@dataclass(frozen=True)
class Fit:
    """Coefficients, and how certain they are; nan and inf where the data do not determine them."""

    value: dict[str, float]
    covariance: Array
    """[size: coefficients, coefficients], in their order."""
    quantile: float
    """Half a 95 % interval over the standard deviation."""
    squares: Array
    """Sum of the squared errors of each block, [size: blocks]."""

    @property
    def half_width(self) -> dict[str, float]:
        """Half of the 95 % intervals."""
        std = np.sqrt(np.diag(self.covariance))
        return dict(zip(self.value, (self.quantile * std).tolist(), strict=True))


def fit(e: Equations) -> Fit:
    """Solves Z'X p = Z'y for both halves together.

    The covariance is that of the sums of Z times error over blocks of time. So the intervals also
    hold for coloured errors, and where the polynomial does not fit exactly.
    """
    scale = np.sqrt(np.mean(e.X**2, axis=0))
    if not np.all(scale > 0):
        return _nothing(e)
    X, Z = e.X / scale, e.Z / scale
    A = Z.T @ X
    if np.linalg.matrix_rank(A, tol=1e-13 * len(X)) < len(scale):
        return _nothing(e)
    p = np.linalg.solve(A, Z.T @ e.y)
    error = e.y - X @ p
    blocks = int(e.block[-1]) + 1
    scores = np.column_stack([np.bincount(e.block, z * error, blocks) for z in Z.T])
    freedom = blocks - len(p)
    if freedom < 5:
        return _nothing(e)
    from scipy.special import stdtrit

    inverse = np.linalg.inv(A)
    covariance = inverse @ (scores.T @ scores) @ inverse.T * blocks / freedom
    return Fit(
        dict(zip(e.names, (p / scale).tolist(), strict=True)),
        covariance / np.outer(scale, scale),
        float(stdtrit(freedom, 0.975)),
        np.bincount(e.block, error**2, blocks).astype(np.float64),
    )


def is_worse(one: Fit, other: Fit) -> bool:
    """Whether the squared errors of one fit are significantly larger than those of the other."""
    return is_more(one.squares - other.squares)


def is_more(differences: Array) -> bool:
    """Whether the mean of independent differences is significantly above 0."""
    error = np.std(differences, ddof=1) / math.sqrt(len(differences))
    return bool(np.mean(differences) > 2 * error)


def _nothing(e: Equations) -> Fit:
    size = len(e.names)
    unknown = np.full((size, size), np.inf)
    return Fit(dict.fromkeys(e.names, np.nan), unknown, 1.0, np.full(int(e.block[-1]) + 1, np.nan))


def left_out(e: Equations, parts: int = 8) -> Array:
    """Mean square error on each part of the log after a fit to all others, [size: parts]."""
    scale = np.sqrt(np.mean(e.X**2, axis=0))
    scale[scale == 0] = 1.0
    X, Z = e.X / scale, e.Z / scale
    part = e.block * parts // (int(e.block[-1]) + 1)
    A = [Z[part == i].T @ X[part == i] for i in range(parts)]
    b = [Z[part == i].T @ e.y[part == i] for i in range(parts)]
    errors = []
    for i in range(parts):
        p = np.linalg.lstsq(sum(A) - A[i], sum(b) - b[i], rcond=1e-12)[0]
        errors.append(np.mean((e.y[part == i] - X[part == i] @ p) ** 2))
    return np.array(errors)


Orders = tuple[int, int]
"""n and m of (16), as in rls.n and rls.m."""


def choose(equations: Equations, n_most: int, m_most: int) -> tuple[Orders, dict[Orders, Array]]:
    """The orders with the least error on parts that were left out, and the errors of all, see
    left_out.

    equations  with all columns up to the orders n_most, m_most
    """
    others = [name for name in equations.names if name not in eta(n_most, m_most)]
    errors = {
        (n, m): left_out(equations.only([*others, *eta(n, m)]))
        for n in range(1, n_most + 1)
        for m in range(1, m_most + 1)
    }
    best = min(errors, key=lambda each: float(np.mean(errors[each])))
    return best, errors
