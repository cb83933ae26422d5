"""What the estimator needs to know of a motor, found off line from a log.

B, D_theta and Coulomb friction with 95 % intervals, the torque constant where a torque sensor is
there, noise, a bandwidth and V_a for the filters, and the orders of the polynomial. What the log
cannot tell within a tenth is not told.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.fmi.instance import Fmu, Slave, Value
from sigmahat.identification.noise import bandwidth, best_V_a, low_pass, variance
from sigmahat.identification.regression import (
    COULOMB_VELOCITY,
    Equations,
    Fit,
    Signals,
    equations,
    fit,
    left_out,
    shortest,
)
from sigmahat.logs.configuration import Configuration
from sigmahat.logs.errors import LogError
from sigmahat.logs.log import Array, Log
from sigmahat.logs.replay import parameters, replay
from sigmahat.logs.sampling import Samples, sample, stretches

UNITS = {"B": "kg.m2", "D_theta": "N.m.s/rad", "tau_coulomb": "N.m", "torque_constant": "N.m/A"}
_TELLS = 0.1
"""Half width of the interval over the value, above which the log cannot tell."""
_NEGLIGIBLE = 0.005
"""Coulomb friction known to this part of the torque is known, be it zero."""
_SAMPLING = {"B": 0.015, "tau_coulomb": 0.015, "D_theta": 0.001}
"""Relative error that is there without any noise, at the samples' 1 ms: reversals fall between."""
_LONGEST = 600.0  # [s] of a log that are used
_V_A = tuple(10.0**e for e in np.arange(5.0, 13.1, 0.5))
_V_A_TICKS = 10000
_WIDEST = 0.1  # of the sampling frequency, for the velocity whose sign counts
_N, _M = 4, 4  # highest orders that are tried


@dataclass(frozen=True)
class Quantity:
    """One figure with its 95 % interval, value +- half_width."""

    value: float
    """In the unit of its name: B [kg.m2], D_theta [N.m.s/rad], tau_coulomb [N.m],
    torque_constant [N.m/A]."""
    half_width: float
    """Of the interval, in the same unit."""
    told: bool
    """Whether the log determines it well enough to use it."""


@dataclass(frozen=True)
class Identified:
    """What the log tells."""

    quantities: dict[str, Quantity]
    """B, D_theta, tau_coulomb, and torque_constant if it was asked for."""
    n: int
    """For rls.n, see m."""
    m: int
    """Smallest orders that are not worse than the best by more than chance."""
    tau_variance: float
    """Of the torque's noise [(N.m)2]."""
    theta_variance: float
    """Of the motor position's noise, rounding included [rad2]."""
    bandwidth: float
    """Of a filter that balances both [rad/s]."""
    V_a: float
    """For filter.V_a [rad2/s4]."""
    phi: float
    """Largest deformation [rad]."""
    set_point: float
    """Largest set-point, without its sign [1]."""
    torque: float
    """Largest torque of the motor after its gear [N.m]."""
    notes: Sequence[str]
    """What the log needed."""


def identify(log: Log, configuration: Configuration, torque_constant: bool = False) -> Identified:
    """Identifies the motor of a log.

    With torque_constant it also finds K_t: then the torque of the sensor is believed, and tau must
    be a current.

    Raises LogError for a log and configuration that do not fit, or without a stretch to use.
    """
    needed = ["theta", "q", "tau", *(["tau_e_sensor"] if torque_constant else [])]
    for name in needed:
        if name not in configuration.ports:
            why = "; the torque constant shows beside a torque only" if "sensor" in name else ""
            raise LogError(f"{configuration.path}: identify needs [ports.{name}]{why}; add it")
    constant = configuration.ports["tau"].torque_constant
    if torque_constant and constant is None:
        raise LogError(
            f"{configuration.path}: [ports.tau] is not in A with a torque_constant; "
            "leave --torque-constant out"
        )
    with Fmu(installed_fmu("StiffnessEstimator")) as fmu:
        start = parameters(fmu, configuration)
        every = fmu.parameters(start)
        T = float(every["samplePeriod"])
        samples = sample(log, configuration, T)
        notes = list(samples.notes)
        if len(samples.values) * T > _LONGEST:
            samples = replace(samples, values=samples.values[: round(_LONGEST / T)])
            notes.append(f"used the first {_LONGEST:g} s")
        gamma = float(every["motor.gamma"])
        pieces = list(_pieces(samples, every, sensor=torque_constant))
        if not pieces:
            raise LogError(f"{log.path}: no stretch of {shortest(T) * T:g} s without a gap")
        counts = float(every["encoder.theta"])
        resolution = 2 * math.pi / counts if counts else 0.0
        longest = max(pieces, key=lambda piece: len(piece.theta))
        tau_variance = variance(longest.tau)
        theta_variance = variance(longest.theta, resolution)
        inertia = float(every["motor.B"]) * abs(gamma)
        f_0 = bandwidth(tau_variance, theta_variance, inertia, T)
        symmetric = bool(every["rls.symmetric"])
        m_most = _M if np.ptp(longest.set_point) > 0 else 1
        without = [replace(piece, tau_e=None) for piece in pieces]
        wide = min(2.5 * f_0, _WIDEST / T)
        whole = equations(without, T, gamma, _N, m_most, symmetric, f_0, wide)
        (n_fit, m_fit), (n, m) = _orders(whole, _N, m_most)
        fits = [
            fit(equations(pieces, T, gamma, n_fit, m_fit, symmetric, *filters))
            for filters in ((f_0, wide), (f_0, min(2 * wide, 2 * _WIDEST / T)), (0.6 * f_0, wide))
        ]
        found = _with_spread(fits)
        quantities = {}
        torque = float(np.std(np.concatenate([piece.tau for piece in pieces])))
        for name in ("B", "D_theta", "tau_coulomb"):
            floor = _NEGLIGIBLE * torque if name == "tau_coulomb" else 0.0
            quantities[name] = _quantity(found.value[name], found.half_width[name], floor)
        if constant is not None and torque_constant:
            quantities["torque_constant"] = _quantity(
                found.value["gain"] * constant, found.half_width["gain"] * constant, 0.0
            )
        V_a = _best_V_a(fmu, samples, start, longest, f_0)
        phi, set_point, torque = (
            max(float(np.max(np.abs(getattr(piece, name)))) for piece in pieces)
            for name in ("phi", "set_point", "tau")
        )
    return Identified(
        quantities=quantities,
        n=n,
        m=m,
        tau_variance=tau_variance,
        theta_variance=theta_variance,
        bandwidth=2 * math.pi * f_0,
        V_a=V_a,
        phi=phi,
        set_point=set_point,
        torque=abs(gamma) * torque,
        notes=notes,
    )


def _with_spread(fits: Sequence[Fit]) -> Fit:
    """The first fit, its intervals widened by what the interval of a single fit does not know.

    First how far the other fits are from it: they have other filters, and what they find differs
    by more than chance where rounding matters. Then _SAMPLING, which no filter shows.
    """
    first = fits[0]
    half_width = {
        name: half
        + max(abs(other.value[name] - first.value[name]) for other in fits[1:])
        + _SAMPLING.get(name, 0.0) * abs(first.value[name])
        for name, half in first.half_width.items()
    }
    return replace(first, half_width=half_width)


def _quantity(value: float, half_width: float, floor: float) -> Quantity:
    """floor: half width below which the value is known whatever it is."""
    told = value > -floor and half_width <= max(_TELLS * value, floor)
    return Quantity(value, half_width, bool(told))


def _pieces(samples: Samples, every: dict[str, Value], sensor: bool) -> Iterator[Signals]:
    """Stretches of the log without gaps that are long enough."""
    columns = dict(zip(samples.names, samples.values.T, strict=True))
    good = np.isfinite(samples.values).all(axis=1)
    scale, offset = float(every.get("setPoint.scale", 0.0)), float(every["setPoint.offset"])
    for first, last in zip(*stretches(good), strict=True):
        if last - first < shortest(samples.T):
            continue
        part = {name: np.ascontiguousarray(each[first:last]) for name, each in columns.items()}
        theta_c = part.get("theta_c", np.zeros(last - first))
        yield Signals(
            theta=part["theta"],
            phi=part["q"] - part["theta"],
            set_point=offset + scale * theta_c,
            tau=part["tau"],
            tau_e=part["tau_e_sensor"] if sensor else None,
        )


def _columns(n: int, m: int) -> list[str]:
    return ["B", "D_theta", "tau_coulomb", *(f"eta[{i},{j}]" for i in range(n) for j in range(m))]


def _orders(whole: Equations, n_most: int, m_most: int) -> tuple[tuple[int, int], tuple[int, int]]:
    """Orders with the least error on what was left out, and the smallest that are as good.

    As good: worse in the mean over the parts by less than the standard error of the difference.
    """
    errors = {
        (n, m): left_out(whole.only(_columns(n, m)))
        for n in range(1, n_most + 1)
        for m in range(1, m_most + 1)
    }
    best = min(errors, key=lambda each: float(np.mean(errors[each])))

    def as_good(each: tuple[int, int]) -> bool:
        worse = errors[each] - errors[best]
        return bool(np.mean(worse) <= np.std(worse, ddof=1) / math.sqrt(len(worse)))

    return best, min(filter(as_good, errors), key=lambda each: (each[0] * each[1], each))


def _best_V_a(
    fmu: Fmu, samples: Samples, start: dict[str, Value], piece: Signals, f_0: float
) -> float:
    """V_a whose velocity is nearest to the differentiated position, smoothed without phase."""
    theta: Array = piece.theta[:_V_A_TICKS]
    wide = min(2.5 * f_0, _WIDEST / samples.T)
    reference = np.gradient(low_pass(theta, wide, samples.T), samples.T)
    settled = slice(len(theta) // 10, -len(theta) // 10)
    only = Samples(0.0, samples.T, ["theta"], theta[:, None], samples.tick_of_row, ())
    velocity = {}
    for V_a in _V_A:
        with Slave(fmu, "filter") as slave:
            filtered = {"method": "Paper2011", "filter.V_a": V_a, "modality": "Residual"}
            values = {**start, **filtered}
            (outputs,) = replay(slave, only, values, len(theta))
            velocity[V_a] = outputs["theta_dot"][settled]
    return best_V_a(velocity, reference[settled])


def as_dict(found: Identified) -> dict[str, Any]:
    """For JSON and the configuration; units are those of UNITS."""
    return {
        **{
            name: {
                "value": q.value if q.told else None,
                "interval": [q.value - q.half_width, q.value + q.half_width],
                "unit": UNITS[name],
            }
            for name, q in found.quantities.items()
        },
        "rls.n": found.n,
        "rls.m": found.m,
        "tau noise variance [(N.m)2]": found.tau_variance,
        "theta noise variance [rad2]": found.theta_variance,
        "filter bandwidth [rad/s]": found.bandwidth,
        "filter.V_a": found.V_a,
        "largest phi [rad]": found.phi,
        "largest setPoint [1]": found.set_point,
        "largest gamma tau [N.m]": found.torque,
        "notes": list(found.notes),
    }


def summary(found: Identified) -> str:
    """One screen."""
    lines = [f"  {note}" for note in found.notes]
    lines.append("")
    for name, q in found.quantities.items():
        low, high = q.value - q.half_width, q.value + q.half_width
        if q.told:
            text = f"{q.value:.4g} +- {q.half_width:.2g} {UNITS[name]} (95 %)"
        elif math.isfinite(q.half_width):
            text = f"cannot tell: somewhere from {low:.2g} to {high:.2g} {UNITS[name]}"
        else:
            text = "cannot tell: the motion does not show it"
        lines.append(f"{name:16}{text}")
    if not all(q.told for q in found.quantities.values()):
        lines.append("  Faster motion tells B, many reversals tell tau_coulomb: record that.")
    lines += [
        "",
        f"orders          rls.n = {found.n}, rls.m = {found.m} (cross-validation)",
        f"noise           torque {math.sqrt(found.tau_variance):.2g} N.m, "
        f"motor position {math.sqrt(found.theta_variance):.2g} rad (standard deviations)",
        f"filter          V_a = {found.V_a:.2g} rad2/s4; bandwidth {found.bandwidth:.3g} rad/s",
        f"ranges          deformation {found.phi:.3g} rad, set-point {found.set_point:.3g}, "
        f"gamma tau {found.torque:.3g} N.m",
        f"friction is     tau_coulomb tanh(theta_dot / ({COULOMB_VELOCITY:g} rad/s))",
    ]
    return "\n".join(lines)
