"""The job of `sigmahat identify`: motor data and settings of the estimator, off line from a log.

Results: B, D_theta and Coulomb friction with 95 % intervals, and the torque constant if there is a
torque sensor. Further results: noise of the signals, bandwidth and V_a of the filters, and orders.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from sigmahat.fmi.instance import Fmu, Slave, Value, installed
from sigmahat.identification.coherence import coherent_range, is_hidden
from sigmahat.identification.motor import KnownInertia, MotorFit, fit_motor
from sigmahat.identification.noise import TorqueNoise, count, is_only_noise, low_pass
from sigmahat.identification.quantities import WIDE, Identified, Quantity
from sigmahat.identification.regression import Signals, set_point_moves, shortest, signals_of
from sigmahat.identification.spring import (
    change_of_spring,
    knees,
    plain_equations,
    with_two_springs,
)
from sigmahat.logs.configuration import Configuration
from sigmahat.logs.log import Array, Log, LogError
from sigmahat.logs.replay import parameters, play
from sigmahat.logs.sampling import Samples, sample, stretches

_LONGEST = 600.0  # [s] of a log that are used
_FEWEST = 1000  # samples of the longest stretch that are left if the motor moves slowly
_RESOLVED = 0.07
"""Largest bandwidth of the estimator, in sampling frequencies. For joints that are sampled at 250
Hz, other values reduce the coverage. 0.05 is too slow; with 0.15, the signals between samples are
no lines."""
_V_A = tuple(10.0**e for e in np.arange(5.0, 13.1, 0.5))
_MATTERS = 0.05  # share of the covered deformation; prior.bias covers smaller errors of zero
_V_A_TICKS = 10000
_NO_TORQUE = (
    "the torque of the motor is only noise: such a log does not show its inertia and friction, and "
    "they have to be known for the stiffness; record with the motor on"
)
_CHANGES = (
    "the stiffness changes after {t:.4g} s of the log: identified with one spring before, and "
    "another one after it"
)
_CONTRADICTED = (
    "the log shows B = {found:.3g} kg.m2 where motor.B is {given:.3g}, known to {std:.3g} %: it "
    "is not written, as the torque may have another scale than the configuration says; check "
    "torque_constant, unit and gear_ratio of tau, and motor.gamma, or remove motor.B"
)
_HIDDEN = (
    "the deformation is proportional to the acceleration of the motor, but for the rounding of the "
    "encoders: the log cannot tell the inertia of the motor from the inertia of the load; record "
    "more frequencies, or give motor.B and prior.B"
)
_SLOWEST = 0.25  # between samples [s]: as long as a block of errors
_V_A_HIGHEST = 0.1  # low pass of the velocity to compare with, in sampling frequencies


def _unusable(samples: Samples, needed: float) -> str:
    """Why no part of a log is usable, and what to do. A part must last `needed` [s]."""
    if samples.T > _SLOWEST:
        return (
            f"samples {samples.T:g} s apart do not show the motion of a joint, expected at most "
            f"{_SLOWEST} s; check time.unit and samplePeriod"
        )
    duration = len(samples.values) * samples.T
    if duration < needed:
        least = f"at least {needed:.3g} s with samples {samples.T:g} s apart"
        return f"the log is {duration:.3g} s long, expected {least}"
    gaps, _ = stretches(np.isnan(samples.values).any(axis=1))
    return (
        f"expected a stretch of {needed:.3g} s without a gap, got {len(gaps)} gaps in "
        f"{duration:.4g} s; to interpolate over short ones, set time.longest_gap [s]"
    )


def identify(log: Log, configuration: Configuration, torque_constant: bool = False) -> Identified:
    """Identifies the motor of a log.

    With torque_constant it also identifies K_t: tau must be a current, and the torque of the sensor
    is taken as exact.

    Raises LogError for a log and configuration that do not fit, or a log without a stretch that is
    long enough.
    """
    _check(configuration, torque_constant)
    fmu = installed("StiffnessEstimator")
    start = parameters(fmu, configuration)
    every = fmu.parameters(start)
    samples = _beginning(sample(log, configuration, float(every["samplePeriod"])))
    T, gamma = samples.T, float(every["motor.gamma"])
    pieces = list(signals_of(samples, every, sensor=torque_constant)) if T <= _SLOWEST else []
    if not pieces:
        raise LogError(f"{log.path}: {_unusable(samples, shortest(T) * T)}")
    longest = max(pieces, key=lambda piece: len(piece.theta))
    noise = TorqueNoise.of(longest.tau, longest.theta, every, T)
    bandwidth = noise.bandwidth
    symmetric = bool(start.get("rls.symmetric", False))
    coherent = math.inf if torque_constant else coherent_range(longest, gamma, noise)
    apart = _apart(pieces, count(every))
    h = apart * T
    thinned = [each.with_acting_torque()[::apart] for each in pieces]
    inertia = _known_inertia(every, configuration)
    f_0 = min(replace(noise, T=h).bandwidth, coherent)
    change, hidden = None, False
    if not torque_constant:
        plain = plain_equations(thinned, h, gamma, f_0)
        change = change_of_spring(plain, thinned)
        rounding = sum(count(every, encoder) ** 2 / 12 for encoder in ("theta", "q"))
        hidden = is_hidden(plain, f_0, h, rounding, known=inertia is not None)
    springs = thinned if change is None else with_two_springs(thinned, change)
    motor = fit_motor(springs, h, gamma, symmetric, f_0, inertia)
    quantities = dict(motor.quantities)
    no_torque = all(is_only_noise(piece.tau) for piece in pieces)
    changed = None if change is None else change * h
    if no_torque or hidden:
        quantities = {
            name: Quantity(math.nan, math.inf, each.unit, determined=False)
            for name, each in quantities.items()
        }
    if quantities["B"].determined:  # until here it was that of the configuration
        bandwidth = replace(noise, inertia=quantities["B"].value * abs(gamma)).bandwidth
    if torque_constant and (nominal := configuration.ports["tau"].torque_constant) is not None:
        quantities["torque_constant"] = motor.torque_constant(nominal)
    spring = motor.spring if math.isfinite(motor.spring) else 0.0
    center = _center(quantities.get("zero"), pieces)
    middle, set_point = _set_points(pieces, has_effect=motor.polynomial.m > 1)
    return Identified(
        quantities=quantities,
        symmetric=motor.polynomial.symmetric,
        n=motor.polynomial.n,
        m=motor.polynomial.m,
        tau_variance=noise.torque,
        theta_variance=noise.position,
        bandwidth=2 * math.pi * min(bandwidth, coherent, _RESOLVED / samples.T),
        coherent=coherent,
        V_a=_best_V_a(fmu, samples, start, longest, noise.bandwidth),
        phi=max(float(np.max(np.abs(piece.phi - center))) for piece in pieces),
        zero=center,
        knees=()
        if no_torque or hidden or change is not None
        else knees(thinned, h, gamma, motor.polynomial, center),
        set_point=set_point,
        set_point_center=middle,
        set_point_moves=set_point_moves(pieces),
        torque=0.0
        if no_torque
        else max(spring, *(abs(gamma) * float(np.max(np.abs(each.tau))) for each in pieces)),
        B=float(every["motor.B"]),
        D_theta=float(every["motor.D_theta"]),
        notes=[*samples.notes, *_notes(changed, motor, inertia, no_torque, hidden)],
    )


def _notes(
    changed: float | None,
    motor: MotorFit,
    inertia: KnownInertia | None,
    no_torque: bool,
    hidden: bool,
) -> Iterator[str]:
    """Notes on what the log does not show, or contradicts; changed: time of a change [s]."""
    if changed is not None:
        yield _CHANGES.format(t=changed)
    if no_torque or hidden:
        yield _NO_TORQUE if no_torque else _HIDDEN
    elif motor.contradicted and inertia is not None:
        found, std = motor.quantities["B"].value, 100 * inertia.std
        yield _CONTRADICTED.format(found=found, given=inertia.value, std=std)


def _set_points(pieces: Sequence[Signals], has_effect: bool) -> tuple[float, float]:
    """Center of the set-points, and the largest distance from it; 0 is the center if they have no
    effect."""
    ends = [float(end(piece.set_point)) for piece in pieces for end in (np.min, np.max)]
    center = (min(ends) + max(ends)) / 2 if has_effect else 0.0
    return center, max(abs(end - center) for end in ends)


def _apart(pieces: Sequence[Signals], count: float) -> int:
    """Distance of the samples for the fit, in samples. It is 1 if the motor moves by at least one
    count [rad] between two samples (RMS), else the number of samples for two counts.

    The errors of rounding must be independent from one sample to the next. Of a slower motor, the
    samples between repeat the same error.
    """
    moved = math.sqrt(np.mean(np.concatenate([np.diff(each.theta) for each in pieces]) ** 2))
    if moved >= count or moved == 0:
        return 1
    longest = max(len(each.theta) for each in pieces)
    return max(1, min(math.ceil(2 * count / moved), longest // _FEWEST))


def _known_inertia(every: Mapping[str, Value], configuration: Configuration) -> KnownInertia | None:
    """B of the configuration, unless its prior is the wide one of `init` or of an earlier run."""
    std = float(every["prior.B"])
    given = "motor.B" in configuration.parameters
    return KnownInertia(float(every["motor.B"]), std) if given and 0 < std < WIDE else None


def _center(zero: Quantity | None, pieces: Sequence[Signals]) -> float:
    """The zero of the deformation, if it is surely not 0 and far enough to matter; else 0."""
    if zero is None or not zero.determined:
        return 0.0
    covered = max(float(np.ptp(piece.phi)) for piece in pieces)
    is_wrong = abs(zero.value) > max(zero.half_width, _MATTERS * covered)
    return zero.value if is_wrong else 0.0


def _check(configuration: Configuration, torque_constant: bool) -> None:
    """Raises LogError if a port is missing, or if tau is not a current where it has to be one."""
    for name in ("theta", "q", "tau", *(["tau_e_sensor"] if torque_constant else [])):
        if name not in configuration.ports:
            why = "; a torque constant needs a measured torque" if "sensor" in name else ""
            raise LogError(f"{configuration.path}: identify needs [ports.{name}]{why}; add it")
    if torque_constant and configuration.ports["tau"].torque_constant is None:
        raise LogError(
            f"{configuration.path}: expected [ports.tau] in A with a torque_constant; "
            "add both, or omit --torque-constant"
        )


def _beginning(samples: Samples) -> Samples:
    """As much of a log as is used."""
    if len(samples.values) * samples.T <= _LONGEST:
        return samples
    return replace(
        samples,
        values=samples.values[: round(_LONGEST / samples.T)],
        notes=[*samples.notes, f"used the first {_LONGEST:g} s"],
    )


def _best_V_a(
    fmu: Fmu, samples: Samples, start: Mapping[str, Value], piece: Signals, f_0: float
) -> float:
    """V_a whose velocity is nearest to the differentiated position, smoothed without phase."""
    theta: Array = piece.theta[:_V_A_TICKS]
    wide = min(2.5 * f_0, _V_A_HIGHEST / samples.T)
    reference = np.gradient(low_pass(theta, wide, samples.T), samples.T)
    settled = slice(len(theta) // 10, -len(theta) // 10)
    only = Samples(samples.T, ["theta"], theta[:, None])
    errors: dict[float, float] = {}
    for V_a in _V_A:
        with Slave(fmu, "filter") as slave:
            filtered = {"method": "Paper2011", "filter.V_a": V_a, "modality": "Residual"}
            slave.initialize({**start, **filtered})
            (outputs,) = play(slave, only, len(theta))
            difference = outputs["theta_dot"][settled] - reference[settled]
            errors[V_a] = float(np.mean(difference**2))
    return min(errors, key=errors.__getitem__)
