"""Regression of the motor equation with instrumental variables against the noise of encoders.

The equation of the motor (3) with Coulomb friction, on the motor axis, with the flexibility torque
tau_e as a polynomial (16) with unknown coefficients, is linear in all unknowns:

    tau = B gamma theta'' + D_theta gamma theta' + tau_coulomb tanh(theta'/v_s) - tau_e/gamma + c

The constant c is the sum of a constant torque, and of the spring torque from a wrong zero of the
deformation.

Least squares would be biased: theta'' of a rounded position is mostly noise, and noise in a
regressor makes its coefficient too small. Therefore even and odd samples are filtered and
differentiated separately. The rounding errors of even and odd samples are independent while the
joint moves. The regressors of each half are the instruments of the other half, so the sums Z'X
contain no squared noise.

The equations are stored as sums over blocks of time, never row by row. Therefore the memory does
not grow with the number of samples, and a fit takes much less time than the filters.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sigmahat.estimator.powers import powers_of_phi
from sigmahat.motor.noise import SETTLED, low_pass
from sigmahat.motor.signals import BLOCK, EDGE, Signals, units
from sigmahat.recording.log import Array

MOTOR = ("B", "D_theta", "tau_coulomb")  # first columns, which describe the motor
COULOMB_VELOCITY = 0.02  # v_s, width of the sign change of the friction [rad/s]
WIDEST = 0.1  # highest low pass of the velocity, in sampling frequencies
_VELOCITY = 2.5  # ratio of the low pass of the velocity to the low pass of the equations
CONSTANT = "constant"  # name of the column of c
_WINDOW = 1 << 14  # approximate number of rows that are filtered at a time
MUCH = 0.7  # largest ratio of the squared errors, after to before, if a change explains a log
_PARTS = 8  # number of parts of a log for the cross-validation


class Stribeck(NamedTuple):
    """Friction that falls with the velocity as exp(-|theta'/v|^delta) (Armstrong-Helouvry, Dupont
    and Canudas de Wit, Automatica 30:1083-1138, 1994)."""

    velocity: float  # v [rad/s], > 0
    exponent: float  # delta, usually 1 or 2


@dataclass(frozen=True)
class Form:
    """Form of the equations: orders of the polynomial, model of the friction, and filters."""

    f_0: float  # low pass of both sides [Hz]
    wide: float  # low pass of the velocity in the Coulomb friction [Hz]
    n: int = 1  # order of the polynomial, as rls.n
    m: int = 1  # as rls.m
    symmetric: bool = True  # only odd powers of the deformation, as rls.symmetric
    coulomb_velocity: float = COULOMB_VELOCITY  # v_s [rad/s]
    load_friction: bool = False
    """Whether there is friction that is proportional to the magnitude of the deformation."""
    stribeck: tuple[Stribeck, ...] = ()  # additional friction in slow motion
    delay: bool = False  # whether a delay is estimated: tau(t - delay) = tau(t) - delay tau'(t)

    @staticmethod
    def of_low_pass(f_0: float, T: float, n: int = 1, m: int = 1, symmetric: bool = True) -> Form:
        """Creates a form for samples T apart [s], with the velocity less filtered than the rest."""
        return Form(f_0, min(_VELOCITY * f_0, WIDEST / T), n, m, symmetric)

    def with_all_powers(self) -> Form:
        """Returns the form with odd and even powers of the deformation, up to a similar power."""
        return replace(self, n=2 * self.n, symmetric=False)

    def names(self, sensor: bool) -> list[str]:
        """Returns names of the regressors; with a torque sensor a gain replaces the polynomial."""
        has_constant = sensor or self.symmetric  # otherwise the polynomial contains the constant
        return [
            *MOTOR,
            *(["load"] if self.load_friction else []),
            *(f"stribeck[{v:g},{delta:g}]" for v, delta in self.stribeck),
            *(["delay"] if self.delay else []),
            *([CONSTANT] if has_constant else []),
            *(["gain"] if sensor else eta(self.n, self.m)),
        ]


@dataclass(frozen=True)
class Equations:
    """Equations y = X p + error with instruments Z, for all samples, as sums over blocks."""

    ZX: Array  # Z'X of each block, [size: blocks x columns x columns]
    Zy: Array  # Z'y of each block, [size: blocks x columns]
    R: Array
    """QR factor of each block, R'R = [X y]'[X y], [size: blocks x any x columns + 1]. Therefore
    |y - X p| = |R [-p, 1]|, which avoids a difference of large numbers."""
    rows: NDArray[np.int64]  # number of equations in each block
    names: Sequence[str]  # names of the regressors, see Form.names
    units: tuple[float, float]  # divisors of deformation and set-point [rad, 1]

    @property
    def scale(self) -> Array:
        """RMS of each regressor."""
        squares: Array = np.sqrt(np.sum(self.R[:, :, :-1] ** 2, axis=(0, 1)) / self.rows.sum())
        return squares

    def errors(self, p: Array) -> Array:
        """Computes the sum of squared errors of each block with the coefficients p."""
        squares: Array = np.sum((self.R @ np.append(-p, 1.0)) ** 2, axis=1)
        return squares

    def only(self, names: Sequence[str]) -> Equations:
        """Returns the same equations with the named regressors only."""
        kept = np.array([self.names.index(name) for name in names])
        ZX, Zy = self.ZX[:, kept[:, None], kept], self.Zy[:, kept]
        return replace(self, ZX=ZX, Zy=Zy, R=self.R[:, :, [*kept, -1]], names=list(names))

    def without(self, names: Collection[str]) -> Equations:
        """Returns the same equations without the named regressors."""
        return self.only([name for name in self.names if name not in names])

    def known(self, name: str, value: float) -> Equations:
        """Returns the same equations with a known coefficient of one regressor."""
        i, R = self.names.index(name), self.R.copy()
        R[:, :, -1] -= value * R[:, :, i]
        return replace(self, Zy=self.Zy - value * self.ZX[:, :, i], R=R).without([name])

    def parts(self, number: int) -> list[Equations]:
        """Divides the equations into parts of equal duration."""
        ends = -(-np.arange(number + 1) * len(self.rows) // number)  # rounded up
        return [
            replace(self, ZX=self.ZX[i:k], Zy=self.Zy[i:k], R=self.R[i:k], rows=self.rows[i:k])
            for i, k in pairwise(ends)
        ]

    def in_parts(self, parts: int) -> Equations:
        """Combines the blocks of the equations to fewer, longer blocks."""
        filled = [part for part in self.parts(parts) if len(part.rows)]
        return replace(
            self,
            ZX=np.array([part.ZX.sum(axis=0) for part in filled]),
            Zy=np.array([part.Zy.sum(axis=0) for part in filled]),
            R=np.array([part.factor() for part in filled]),
            rows=np.array([part.rows.sum() for part in filled]),
        )

    def factor(self) -> Array:
        """Returns the QR factor of all blocks together."""
        return factor(self.R.reshape(-1, self.R.shape[2]))


def factor(X: Array) -> Array:
    """Computes the square factor R of X = QR, for one matrix X or for a stack of matrices."""
    missing = max(0, X.shape[-1] - X.shape[-2])
    if missing:
        X = np.pad(X, [*[(0, 0)] * (X.ndim - 2), (0, missing), (0, 0)])
    return np.asarray(np.linalg.qr(X, mode="r"))


def equations(pieces: Sequence[Signals], T: float, gamma: float, form: Form) -> Equations:
    """Computes the equations of all stretches, with samples T [s] apart, after the low pass."""
    of_polynomial = units(pieces)
    parts = []
    for piece in pieces:
        for part in rows(piece, T, gamma, form, of_polynomial):
            y, X, Z = (_in_blocks(x, part.place, T) for x in (part.y[..., None], part.X, part.Z))
            ZX, Zy = Z.swapaxes(1, 2) @ X, (Z.swapaxes(1, 2) @ y)[..., 0]
            of_block = np.bincount(part.place // _block(T) - part.place[0] // _block(T))
            parts.append((ZX, Zy, factor(np.concatenate([X, y], axis=2)), 2 * of_block))
    names = form.names(pieces[0].tau_e is not None)
    if pieces[0].extra is not None:
        names += [extra(i) for i in range(pieces[0].extra.shape[1])]
    ZX, Zy, R, number = (np.concatenate(blocks) for blocks in zip(*parts, strict=True))
    return Equations(ZX, Zy, R, number, names, of_polynomial)


@dataclass(frozen=True)
class Rows:
    """Some of the equations of a stretch, for even and odd samples."""

    y: Array  # [size: 2 x rows]
    X: Array  # [size: 2 x rows x columns]
    Z: Array  # instruments [size: 2 x rows x columns]
    place: NDArray[np.intp]  # indices of the rows in the stretch, without a gap


def rows(
    piece: Signals, T: float, gamma: float, form: Form, units: tuple[float, float]
) -> Iterator[Rows]:
    """Yields the equations of a stretch, whole blocks at a time; units as in Equations.

    Samples around the blocks are filtered too, so that the filters have settled in the blocks.
    """
    count, long = len(piece.theta) // 2, _block(T)
    edge = round(EDGE / (2 * T))
    around = math.ceil(SETTLED / (form.f_0 * 2 * T)) + 4
    step = max(1, _WINDOW // long) * long
    for begin in range(0, count - edge, step):
        first, last = max(begin - around, 0), min(begin + step + around, count)
        part = piece[2 * first : 2 * last]
        velocity = _first(low_pass(part.theta, form.wide, T), T)
        direction = _direction(velocity, form.coulomb_velocity)
        part = part.with_acting_torque()
        halves = [
            _half(part[half::2], velocity[half::2], direction[half::2], 2 * T, gamma, form, units)
            for half in (0, 1)
        ]
        y, X = (np.stack(both) for both in zip(*halves, strict=True))
        Z = np.empty_like(X)
        Z[0, 1:], Z[0, 0] = (X[1, 1:] + X[1, :-1]) / 2, X[1, 0]  # at the times of even samples
        Z[1, :-1], Z[1, -1] = (X[0, 1:] + X[0, :-1]) / 2, X[0, -1]
        if piece.extra is not None:
            first_extra = X.shape[2] - piece.extra.shape[1]
            Z[..., first_extra:] = X[..., first_extra:]
        place = np.arange(max(begin, edge), min(begin + step, count - edge))
        inner = place - first
        yield Rows(y[:, inner], X[:, inner], Z[:, inner], place)


def _block(T: float) -> int:
    """Returns the number of even samples in a block."""
    return round(BLOCK / (2 * T))


def _in_blocks(values: Array, place: NDArray[np.intp], T: float) -> Array:
    """Arranges rows by blocks; an incomplete block is filled with zeros.

    values  [size: 2 x rows x columns], at the indices `place` in a stretch

    Returns an array [size: blocks x rows of a block x columns].
    """
    long = _block(T)
    first, end = place[0] // long, place[-1] // long + 1
    whole = np.zeros((2, end - first, long, values.shape[2]))
    whole.reshape(2, -1, values.shape[2])[:, place - first * long] = values
    blocks: Array = whole.swapaxes(0, 1).reshape(end - first, 2 * long, -1)
    return blocks


def eta(n: int, m: int) -> list[str]:
    """Returns the names of the regressors of a polynomial of orders n and m."""
    return [f"eta[{i},{j}]" for i in range(n) for j in range(m)]


def extra(i: int) -> str:
    """Returns the name of column i of Signals.extra."""
    return f"extra[{i}]"


def _half(
    s: Signals,
    velocity: Array,
    friction: Array,
    h: float,
    gamma: float,
    form: Form,
    units: tuple[float, float],
) -> tuple[Array, Array]:
    """Computes response and regressors of samples h [s] apart.

    velocity  velocity of theta [rad/s]
    friction  direction of the Coulomb friction, from _direction()
    """
    sensor, speed = s.tau_e is not None, np.abs(velocity)
    raw = [s.tau if s.tau_e is None else s.tau_e / gamma, friction]
    if form.load_friction:
        raw.append(np.abs(s.phi if s.tau_e is None else s.tau_e) * friction)
    raw += [np.exp(-((speed / v) ** delta)) * friction for v, delta in form.stribeck]
    if form.delay:
        raw.append(np.gradient(s.tau, h))
    if CONSTANT in form.names(sensor):
        raw.append(np.ones_like(s.tau))
    if sensor:  # tau_e/gamma = B gamma theta'' + ... - gain tau
        raw.append(-s.tau)
    else:
        x, y = s.phi / units[0], s.set_point / units[1]
        powers = powers_of_phi(form.symmetric, form.n)
        of_x = np.vander(x, powers[-1] + 1, increasing=True)[:, powers]
        of_y = np.vander(y, form.m, increasing=True)
        raw += [a * b for a in of_x.T for b in of_y.T]
    if s.extra is not None:
        raw += list(s.extra.T)
    filtered = low_pass(np.column_stack(raw), form.f_0, h)
    smooth = low_pass(s.theta, form.f_0, h)
    motion = [gamma * _second(smooth, h), gamma * _first(smooth, h)]
    return filtered[:, 0], np.column_stack([*motion, filtered[:, 1:]])


def _direction(velocity: Array, v_s: float) -> Array:
    """Computes the mean of tanh(theta'/v_s) around each sample, with a piecewise linear velocity.

    A fast reversal happens between two samples. The mean avoids an error of the reversal time of up
    to half a period. For the same reason this velocity is given at all samples.
    """
    x = velocity / v_s
    middle = np.concatenate([x[:1], (x[1:] + x[:-1]) / 2, x[-1:]])
    integral = np.logaddexp(middle, -middle)  # integral of tanh
    step = np.diff(middle)
    flat = np.abs(step) < 1e-3
    mean: Array = np.where(flat, np.tanh(x), np.diff(integral) / np.where(flat, 1.0, step))
    near = np.concatenate([mean[:1], mean, mean[-1:]])
    wider: Array = (near[:-2] + 2 * mean + near[2:]) / 4  # for every second sample
    return wider


def _first(x: Array, h: float) -> Array:
    """Computes the first derivative, of fourth order in h; two values at each end are invalid."""
    r = np.roll
    return (r(x, 2) - 8 * r(x, 1) + 8 * r(x, -1) - r(x, -2)) / (12 * h)


def _second(x: Array, h: float) -> Array:
    """Computes the second derivative, of fourth order in h; two values at each end are invalid."""
    r = np.roll
    return (-r(x, 2) + 16 * r(x, 1) - 30 * x + 16 * r(x, -1) - r(x, -2)) / (12 * h**2)


@dataclass(frozen=True)
class Fit:
    """Coefficients and their covariance; nan and inf if the data do not determine them."""

    value: dict[str, float]
    covariance: Array  # covariance in the order of value, [size: coefficients, coefficients]
    quantile: float  # half a 95 % interval divided by the standard deviation
    squares: Array  # sum of the squared errors of each block, [size: blocks]

    @property
    def half_width(self) -> dict[str, float]:
        """Half widths of the 95 % intervals of the coefficients, by name."""
        std = np.sqrt(np.diag(self.covariance))
        return dict(zip(self.value, (self.quantile * std).tolist(), strict=True))

    @property
    def error(self) -> float:
        """Sum of the squared errors; nan if the data determine no coefficient."""
        return float(np.sum(self.squares))


def fit(e: Equations) -> Fit:
    """Solves Z'X p = Z'y for even and odd samples together.

    The covariance is computed from sums of Z times error over blocks of time. Therefore the
    intervals also hold for coloured errors, and for a polynomial that does not fit exactly.
    """
    scale = e.scale
    if not np.all(scale > 0):
        return _nothing(e)
    blocks, freedom = len(e.rows), len(e.rows) - len(scale)
    A = e.ZX / np.outer(scale, scale)
    whole, b = A.sum(axis=0), e.Zy / scale
    if np.linalg.matrix_rank(whole, tol=1e-13 * e.rows.sum()) < len(scale) or freedom < 5:
        return _nothing(e)
    p = np.linalg.solve(whole, b.sum(axis=0))
    scores = b - A @ p
    from scipy.special import stdtrit

    inverse = np.linalg.inv(whole)
    covariance = inverse @ (scores.T @ scores) @ inverse.T * blocks / freedom
    return Fit(
        dict(zip(e.names, (p / scale).tolist(), strict=True)),
        covariance / np.outer(scale, scale),
        float(stdtrit(freedom, 0.975)),
        e.errors(p / scale),
    )


def residual(e: Equations) -> float:
    """Computes the sum of squared errors of ordinary least squares, also for equations whose
    regressors depend on each other. Noise of the regressors biases its coefficients, see above."""
    R = e.factor()
    X, y = R[:, :-1], R[:, -1]
    X = X / (np.linalg.norm(X, axis=0) + 1e-300)
    left = y - X @ np.linalg.lstsq(X, y, rcond=1e-10)[0]
    return float(left @ left)


def explained(e: Equations) -> float:
    """Computes the share of the variance of the torque that the equations explain, with ordinary
    least squares [1]; 0 for a constant torque."""
    constant = [name for name in (CONSTANT, *eta(1, 1)) if name in e.names][:1]
    spread = residual(e.only(constant))
    return 1 - residual(e) / spread if spread else 0.0


def is_worse(one: Fit, other: Fit) -> bool:
    """Returns whether the squared errors of `one` are significantly larger than of `other`."""
    return is_more(one.squares - other.squares)


def explains(before: Fit, after: Fit, most: float = MUCH) -> bool:
    """Returns whether the squared errors after a change are significantly smaller than before, and
    at most the given part of them. A significant difference alone is not sufficient: with
    unmodelled friction, nearly every change is significant."""
    return after.error < most * before.error and is_worse(before, after)


def is_more(differences: Array) -> bool:
    """Returns whether the mean of independent differences is significantly above 0."""
    error = np.std(differences, ddof=1) / math.sqrt(len(differences))
    return bool(np.mean(differences) > 2 * error)


def _nothing(e: Equations) -> Fit:
    size = len(e.names)
    unknown = np.full((size, size), np.inf)
    return Fit(dict.fromkeys(e.names, np.nan), unknown, 1.0, np.full(len(e.rows), np.nan))


def left_out(e: Equations) -> Array:
    """Computes the mean square error of each block after a fit to all others, [size: blocks]."""
    scale = e.scale
    scale[scale == 0] = 1.0
    A, b = e.ZX / np.outer(scale, scale), e.Zy / scale
    others = zip(A.sum(axis=0) - A, b.sum(axis=0) - b, strict=True)
    fits = [np.linalg.lstsq(*sums, rcond=1e-12)[0] / scale for sums in others]
    return np.array([e.errors(p)[i] / e.rows[i] for i, p in enumerate(fits)])


@dataclass(frozen=True)
class Choice:
    """The orders of the polynomial with the best predictions."""

    form: Form
    equations: Equations  # with these orders
    errors: Array  # mean square error of each eighth of the log after a fit to the others


def choose(system: Equations, form: Form) -> Choice:
    """Chooses the orders with the least error in a cross-validation over eighths of the log, up to
    the orders of the form; system: equations of the form.
    """
    parts = system.in_parts(_PARTS)
    others = [name for name in system.names if name not in eta(form.n, form.m)]
    errors = {
        (n, m): left_out(parts.only([*others, *eta(n, m)]))
        for n in range(1, form.n + 1)
        for m in range(1, form.m + 1)
    }
    n, m = min(errors, key=lambda orders: float(np.mean(errors[orders])))
    chosen = system.only([*others, *eta(n, m)])
    return Choice(replace(form, n=n, m=m), chosen, errors[n, m])
