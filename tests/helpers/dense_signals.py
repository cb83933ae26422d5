"""The signals of FilteredRegression from whole records, with the filters of scipy.

A record is cut into runs of samples without a gap; in each of them the filters begin anew.
"""

import math
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np
from scipy import signal

from c_library import Array, Library
from regression_joint import stop_operator

Parameters = Mapping[str, Any]
GAPS = (0.01, 0.04, 0.16)
PLAYS = (0.005, 0.02, 0.08)
SENSOR = 2


@cache
def discrete(order: int, w: float, T: float, method: str) -> tuple[Array, Array]:
    system = [w**3] + [0.0] * order, np.poly([-w] * 3)
    b, a, _ = signal.cont2discrete(system, T, method=method)
    return b.ravel(), a


def through(x: Array, order: int, w: float, T: float, held: bool = False) -> Array:
    """x filtered by s^order w^3 / (s + w)^3, from zero: x linear between samples, or held."""

    def response(u: Array, method: str) -> Array:
        return np.asarray(signal.lfilter(*discrete(order, w, T, method), u, axis=0))

    if held:
        return response(x, "zoh")
    return response(x - x[0], "foh") + response(np.broadcast_to(x[0], x.shape), "zoh")


@cache
def as_if_smooth(w: float, T: float) -> tuple[Array, Array]:
    """Filters a signal given by its mean over each sample; the output is at the sample's end."""
    (b, a), (of_second, _) = (discrete(order, w, T, "zoh") for order in (0, 2))
    return (b + T**2 / 12 * of_second)[1:], a  # without the 0 for the sample to come


def resolution(counts: float) -> float:
    """Resolution of an encoder [rad]; 0 without quantisation."""
    return 2 * math.pi / counts if counts else 0.0


def bandwidth(p: Parameters) -> float:
    """Corner frequency of the filters [rad/s]."""
    rounding = p["motor.B"] * abs(p["motor.gamma"]) * resolution(p["encoder.theta"]) / math.sqrt(12)
    if p["modality"] == SENSOR or rounding == 0:
        return float(p["regression.bandwidth"])
    return float(min(p["regression.bandwidth"], 1.42 * math.sqrt(p["noise.tau"] / rounding)))


def decimation(p: Parameters) -> int:
    """Samples of a row."""
    chosen = int(p.get("regression.decimation", 0))
    return chosen or int(min(max(2.5 / (bandwidth(p) * p["samplePeriod"]), 1), 8))


def direction(c: Library, theta: Array, count: float, slow: float) -> tuple[Array, Array]:
    """Mean sign over the sample before each instant; and 0 if the sign is known, else 1 or more."""
    motion = c.new("sh_motion_sign")
    c.lib.sh_motion_sign_start(motion, theta[0])
    found = [(0.0, 1.0)]
    for x in theta[1:]:
        c.lib.sh_motion_sign_step(motion, x, count, slow)
        found.append((motion.sign, motion.unknown))
    sign, unknown = np.array(found).T
    return sign, unknown


Column = tuple[str, int, float]  # kind, number in its kind, prior


def columns(p: Parameters) -> list[Column]:
    """The columns in their order. Columns with a prior of 0 are left out."""
    tau_e, n, m = p["prior.tau_e"], p["rls.n"], p["rls.m"]
    K_0 = tau_e / p["range.phi"]
    most_n, most_m = 8, 5

    def of(name: str) -> float:
        return float(p[f"prior.{name}"])

    found: list[Column] = [("POWER", i, tau_e) for i in range(n * m)]
    found += [("NOMINAL", 0, of("nominal") if "rls.eta_0" in p else 0.0)]
    found += [("HIGHER_POWER", i, of("power") * tau_e) for i in range(2) if n + i < most_n]
    linear = 0 if p["rls.symmetric"] else 1
    if 1 < m < most_m and linear < n:
        found += [("SET_POWER", 0, of("power") * tau_e)]
    found += [("DEAD_ZONE", i, of("gap") * tau_e) for i in range(3)]
    knee = "KNEE" if p["range.knee"] > 0 else "POSSIBLE_KNEE"
    found += [(knee, i, of("power") * tau_e) for i in ([2] if p["rls.symmetric"] else range(3))]
    if p["range.knee_2"] > 0:
        sides = [4] if p["rls.symmetric"] else [3, 4]
        found += [("KNEE", i, of("power") * tau_e) for i in sides]
    found += [("BIAS", 0, of("bias") * tau_e)]
    found += [(f"{name}_Q", 0, of("eccentric") * K_0) for name in ("SIN", "COS")]
    found += [("HYSTERESIS", i, of("hysteresis") * tau_e) for i in range(3)]
    found += [("DAMPING", j, of("damping") * K_0) for j in sorted({0, m - 1})]
    found += [("DELAY", 0, of("delay"))]
    found += [("REVERSAL", 0, of("reversal") * of("tau_coulomb"))]
    found += [(f"{name}_M", 0, of("eccentric_motor")) for name in ("SIN", "COS")]
    dry = of("tau_coulomb") > 0
    found += [("LOAD", 0, of("load_friction")), ("DRIVE", 0, of("load_friction") if dry else 0.0)]
    found += [("VISCOUS", 0, of("D_theta")), ("COULOMB", 0, of("tau_coulomb"))]
    found += [("INERTIA", 0, of("B"))]
    return [column for column in found if column[2] > 0]


def place_of_knee(p: Parameters, index: int) -> float:
    """Over range.phi."""
    first, second = float(p["range.knee"]) or 0.35, float(p["range.knee_2"])
    return (0.0, -first, first, -second, second)[index]


GROUPS = {
    "HIGHER_POWER": 1,
    "SET_POWER": 2,
    "DEAD_ZONE": 6,
    "HYSTERESIS": 4,
    "SIN_M": 5,
    "COS_M": 5,
    "POSSIBLE_KNEE": 3,
}
CURVE = ("POWER", "NOMINAL", "HIGHER_POWER", "SET_POWER", "KNEE", "POSSIBLE_KNEE")
TORQUE = (*CURVE, "DEAD_ZONE")


def plays(phi: Array, runs: list[slice], range_phi: float) -> Array:
    """States of the stop operators [size: ticks x 3]. The operators do not move over a gap."""
    inside = np.zeros(len(phi), dtype=bool)
    for run in runs:
        inside[run.start + 1 : run.stop] = True
    changes = np.where(inside, np.diff(phi, prepend=0.0), 0.0)
    return np.column_stack([stop_operator(changes, range_phi * width) for width in PLAYS])


class Inputs:
    """Unfiltered signals of the columns, and their derivatives by phi [size: ticks x n]."""

    def __init__(self, p: Parameters, z: Array, runs: list[slice]) -> None:
        theta, q, theta_c = z[:, 0], z[:, 1], z[:, 2]
        self.p, self.theta, self.q, self.phi = p, theta, q, q - theta
        self.x = self.phi / p["range.phi"]
        self.set_point = 100 - 2.5 / (2 * math.pi) * theta_c
        self.l = (self.set_point - p["range.setPoint_center"]) / p["range.setPoint"]
        self.plays = plays(self.phi, runs, p["range.phi"])
        self.columns = columns(p)
        zero = np.zeros(len(z))
        self.nominal, self.nominal_slope = zero, zero
        # Coefficients of setPoint^j phi^e.
        for (i, j), value in np.ndenumerate(p.get("rls.eta_0", [])):
            e, factor = self.exponent(i), value * self.set_point**j
            self.nominal = self.nominal + factor * self.phi**e
            self.nominal_slope = self.nominal_slope + factor * e * self.phi ** max(e - 1, 0)
        pairs = [self.signal(kind, index) for kind, index, _ in self.columns]
        priors = np.array([prior for _, _, prior in self.columns])
        self.F = np.array([f for f, _ in pairs]).T * priors
        self.dF = np.array([slope for _, slope in pairs]).T * priors

    def exponent(self, i: int) -> int:
        return 2 * i + 1 if self.p["rls.symmetric"] else i

    def power(self, e: int) -> tuple[Array, Array]:
        """x^e / e and its slope over phi; 1 for e = 0."""
        if e == 0:
            return np.ones(len(self.x)), np.zeros(len(self.x))
        return self.x**e / e, self.x ** (e - 1) / self.p["range.phi"]

    def signal(self, kind: str, index: int) -> tuple[Array, Array]:
        n, m, zero = self.p["rls.n"], self.p["rls.m"], np.zeros(len(self.x))
        if kind == "POWER":
            f, slope = self.power(self.exponent(index % n))
            return f * self.l ** (index // n), slope * self.l ** (index // n)
        if kind == "HIGHER_POWER":
            return self.power(self.exponent(n + index))
        if kind == "SET_POWER":
            return self.x * self.l**m, self.l**m / self.p["range.phi"]
        if kind == "NOMINAL":
            return self.nominal, self.nominal_slope
        if kind in ("KNEE", "POSSIBLE_KNEE"):
            knee, x = place_of_knee(self.p, index), self.x
            sides = np.sign(x) if self.p["rls.symmetric"] else -1.0 if knee < 0 else 1.0
            beyond = np.maximum(sides * x - abs(knee), 0.0)
            return sides * beyond, (beyond > 0) / self.p["range.phi"]
        if kind == "DEAD_ZONE":
            width = GAPS[index] * self.p["range.phi"]
            is_inside = (np.abs(self.phi) < width) if index == 2 else zero > 0
            return np.clip(self.x / GAPS[index], -1, 1), is_inside / width
        gamma = self.p["motor.gamma"]
        flat: dict[str, Callable[[], Array]] = {
            "BIAS": lambda: zero + 1,
            "DAMPING": lambda: self.phi * self.l**index,
            "SIN_Q": lambda: np.sin(self.q),
            "COS_Q": lambda: np.cos(self.q),
            "HYSTERESIS": lambda: self.plays[:, index] / (PLAYS[index] * self.p["range.phi"]),
            "SIN_M": lambda: np.sin(gamma * self.theta),
            "COS_M": lambda: np.cos(gamma * self.theta),
        }
        return flat.get(kind, lambda: zero)(), zero


class Filtered:
    """Signals of one run of samples behind the filters."""

    def __init__(
        self, c: Library, p: Parameters, inputs: Inputs, z: Array, run: slice, measured: bool
    ) -> None:
        self.p, self.run, self.measured = p, run, measured
        self.w, self.T = bandwidth(p), p["samplePeriod"]
        self.F = inputs.F[run]
        self.columns = inputs.columns
        B, D, gamma = (p[f"motor.{name}"] for name in ("B", "D_theta", "gamma"))
        self.gamma, self.of_velocity, self.of_acceleration = gamma, gamma**2 * D, gamma**2 * B
        theta = z[run, 0]
        self.moved = theta - theta[0]
        slow = p["regression.slow"] * self.T
        self.sign, self.unknown = direction(c, theta, resolution(p["encoder.theta"]), slow)
        self.unknown_f = self.filtered(np.append(self.unknown[1:], 0.0), 0, True)
        self.torque = z[run, 4 if measured else 3]
        self.held = bool(p["torque.held"]) and not measured
        self.gain = 1.0 if measured else -gamma
        self.nominal = self.filtered(inputs.nominal[run], 0)
        torque = self.filtered(self.torque, 0, self.held)
        inertial = viscous = np.zeros(len(theta))
        if not measured:
            torque = torque + self.T**2 / 12 * self.filtered(self.torque, 2, self.held)
            inertial = self.of_acceleration * self.filtered(self.moved, 2)
            viscous = self.of_velocity * self.filtered(self.moved, 1)
        self.inertial, self.viscous = inertial, viscous
        self.y = inertial + viscous + self.gain * torque
        self.sides = np.column_stack([self.gain * torque, self.y - self.nominal])
        self.rows = np.column_stack([self.column(i) for i in range(len(self.columns))])
        self.derivatives = [self.filtered(self.torque, order, self.held) for order in (1, 2)]
        of_motor = (i for i, (kind, _, _) in enumerate(self.columns) if kind in ("SIN_M", "COS_M"))
        self.encoder_errors = {i: self.encoder_error(i) for i in of_motor}

    def filtered(self, x: Array, order: int, held: bool = False) -> Array:
        return through(x, order, self.w, self.T, held)

    def column(self, i: int) -> Array:
        """Signals of a column; LOAD, DELAY, SIN_M, and COS_M depend on the estimate and are set
        later.
        """
        kind, _, prior = self.columns[i]
        sign = np.append(self.sign[1:], 0.0)
        smooth = np.asarray(signal.lfilter(*as_if_smooth(self.w, self.T), self.sign))
        of_motor: dict[str, Callable[[], Array]] = {
            "REVERSAL": lambda: abs(self.gamma) * self.filtered(sign, 1, True),
            "COULOMB": lambda: -abs(self.gamma) * smooth,
            "DRIVE": lambda: -smooth,  # times the torque, which is of the mean
            "VISCOUS": lambda: -self.viscous,
            "INERTIA": lambda: -self.inertial,
        }
        if kind in ("LOAD", "DELAY", "SIN_M", "COS_M") or (kind in of_motor and self.measured):
            return np.zeros(len(self.y))
        if kind in of_motor:
            return prior * of_motor[kind]()
        if kind == "NOMINAL":
            return prior * self.nominal
        if kind == "DAMPING":
            return self.filtered(self.F[:, i] - self.F[0, i], 1)
        return self.filtered(self.F[:, i], 0)

    def encoder_error(self, i: int) -> tuple[Array, Array]:
        """Returns the filtered signal of column i, and the motor torque that the signal causes."""
        f = self.F[:, i]
        motor = self.of_velocity * self.filtered(f - f[0], 1)
        motor = motor + self.of_acceleration * self.filtered(f - f[0], 2)
        return f[0] + self.filtered(f - f[0], 0), motor
