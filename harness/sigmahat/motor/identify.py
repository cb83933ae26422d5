"""The job of `sigmahat identify`: motor data and settings of the estimator, off line from a log.

The results are B, D_theta and Coulomb friction with 95 % intervals, and with a torque sensor the
torque constant. Further results are noise, filter settings, and orders of the polynomial.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from sigmahat.estimator.estimator import Estimator
from sigmahat.fmi.model import Value
from sigmahat.motor.coherence import is_hidden, pass_band
from sigmahat.motor.equation import Form
from sigmahat.motor.inertia import KnownInertia
from sigmahat.motor.log_view import LogView, first_part
from sigmahat.motor.motor_fit import MotorFit, fit_motor, fit_spring
from sigmahat.motor.motor_notes import ContradictedInertia, HiddenInertia, NoTorque, SpringChanges
from sigmahat.motor.noise import count, is_only_noise, low_pass
from sigmahat.motor.quantities import Identified, Quantity
from sigmahat.motor.signals import Signals, set_point_moves, shortest
from sigmahat.motor.spring import (
    change_of_spring,
    covered,
    is_off,
    knees,
    plain_equations,
    with_two_springs,
)
from sigmahat.recording.configuration import Configuration
from sigmahat.recording.estimator_parameters import parameters
from sigmahat.recording.gaps import stretches
from sigmahat.recording.log import Array, Log, LogError
from sigmahat.recording.notes import Note
from sigmahat.recording.sampling import Samples

_FEWEST = 1000  # least number of samples kept from the longest stretch of a slow motion
_RESOLVED = 0.07
"""Largest bandwidth of the estimator, in sampling frequencies. For joints that are sampled at 250
Hz, other values reduce the coverage of the intervals. A value of 0.05 is too slow. With 0.15,
signals are not linear between samples."""
_V_A = tuple(10.0**e for e in np.arange(5.0, 13.1, 0.5))
_V_A_TICKS = 10000
_SLOWEST = 0.25  # largest sample period [s]: the duration of a block of errors
_V_A_HIGHEST = 0.1  # highest low pass of the reference velocity, in sampling frequencies


def _unusable(samples: Samples, needed: float) -> str:
    """Explains why no part of a log is usable; a part must last at least `needed` [s]."""
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
    """Identifies the motor of a log. With modality Sensor, the log needs no motor: noise, ranges
    and orders of the spring are identified.

    With torque_constant, the torque constant K_t is identified too. In this case tau must be a
    current, and the torque of the sensor is taken as exact.

    Raises LogError for a log and configuration that do not fit, or a log without a stretch that is
    long enough.
    """
    start = parameters(configuration)
    is_of_spring = start.get("modality") == "Sensor" and not torque_constant
    _check(configuration, is_of_spring, torque_constant)
    view = first_part(log, configuration, both_torques=torque_constant)
    if view.T > _SLOWEST or not view.pieces:
        raise LogError(f"{log.path}: {_unusable(view.samples, shortest(view.T) * view.T)}")
    if is_of_spring:
        return _identify_spring(view)
    return _identify_motor(view, start, torque_constant)


def _identify_motor(view: LogView, start: Mapping[str, Value], torque_constant: bool) -> Identified:
    samples, pieces, T, gamma = view.samples, view.pieces, view.T, view.gamma
    band = pass_band(view, has_sensor=torque_constant)
    noise = band.noise
    bandwidth = noise.bandwidth
    symmetric = bool(start.get("rls.symmetric", False))
    apart = _apart(pieces, count(view.parameters))
    h = apart * T
    thinned = [piece.with_acting_torque()[::apart] for piece in pieces]
    inertia = KnownInertia.of(view)
    f_0 = band.low_pass(h)
    change, hidden = None, False
    if not torque_constant:
        plain = plain_equations(thinned, h, gamma, f_0)
        change = change_of_spring(plain, thinned)
        rounding = sum(count(view.parameters, encoder) ** 2 / 12 for encoder in ("theta", "q"))
        hidden = is_hidden(plain, f_0, h, rounding, known=inertia is not None)
    springs = thinned if change is None else with_two_springs(thinned, change)
    motor = fit_motor(springs, h, gamma, symmetric, f_0, inertia)
    quantities = dict(motor.quantities)
    no_torque = all(is_only_noise(piece.tau) for piece in pieces)
    if no_torque or hidden:
        quantities = {
            name: Quantity(math.nan, math.inf, quantity.unit, determined=False)
            for name, quantity in quantities.items()
        }
    if quantities["B"].determined:  # the first bandwidth was computed with the configured B
        bandwidth = replace(noise, inertia=quantities["B"].value * abs(gamma)).bandwidth
    nominal = view.configuration.ports["tau"].torque_constant
    if torque_constant and nominal is not None:
        quantities["torque_constant"] = motor.torque_constant(nominal)
    found = _of_positions(view, motor.polynomial, quantities.get("zero"))
    # One spring for the whole log cannot be coherent with the torque if the spring changes.
    coherent = band.coherent if change is None else math.inf
    is_plain = not (no_torque or hidden or change is not None)
    return replace(
        found,
        quantities=quantities,
        tau_variance=noise.torque,
        theta_variance=noise.position,
        bandwidth=2 * math.pi * min(bandwidth, coherent, _RESOLVED / samples.T),
        coherent=coherent,
        V_a=_best_V_a(T, start, view.longest, noise.bandwidth),
        knees=knees(thinned, h, gamma, motor.polynomial, found.zero) if is_plain else (),
        torque=0.0 if no_torque else _largest_torque(view, motor.spring),
        notes=[
            *samples.notes,
            *([] if change is None else [SpringChanges(t=change * h)]),
            *_notes(motor, inertia, no_torque, hidden),
        ],
    )


def _identify_spring(view: LogView) -> Identified:
    """Identifies the spring between both positions and the torque of a sensor."""
    pieces, gamma = view.pieces, view.gamma
    apart = _apart(pieces, count(view.parameters))
    h = apart * view.T
    thinned = [piece[::apart] for piece in pieces]
    band = pass_band(view, has_sensor=True)
    symmetric = bool(view.parameters["rls.symmetric"])
    spring = fit_spring(thinned, h, gamma, symmetric, band.low_pass(h))
    found = _of_positions(view, spring.polynomial, spring.zero)
    return replace(
        found,
        quantities={"zero": spring.zero},
        tau_variance=gamma**2 * band.noise.torque,
        theta_variance=band.noise.position,
        torque=_largest_torque(view, spring.largest),
        notes=list(view.samples.notes),
    )


def _of_positions(view: LogView, polynomial: Form, zero: Quantity | None) -> Identified:
    """Returns what the positions of a log show, without any torque."""
    pieces = view.pieces
    center = _center(zero, pieces)
    middle, set_point = _set_points(pieces, has_effect=polynomial.m > 1)
    return Identified(
        quantities={},
        symmetric=polynomial.symmetric,
        n=polynomial.n,
        m=polynomial.m,
        phi=max(float(np.max(np.abs(piece.phi - center))) for piece in pieces),
        zero=center,
        set_point=set_point,
        set_point_center=middle,
        set_point_moves=set_point_moves(pieces),
        has_sensor=view.has_sensor,
        B=float(view.parameters["motor.B"]),
        D_theta=float(view.parameters["motor.D_theta"]),
    )


def _largest_torque(view: LogView, spring: float) -> float:
    """Returns the largest torque of motor or spring at the gear output [N.m].

    spring  largest torque of the spring; nan if it is not known
    """
    measured = (abs(view.gamma) * float(np.max(np.abs(piece.tau))) for piece in view.pieces)
    return max(spring if math.isfinite(spring) else 0.0, *measured)


def _notes(
    motor: MotorFit, inertia: KnownInertia | None, no_torque: bool, hidden: bool
) -> Iterator[Note]:
    """Yields notes on why the log does not show the motor."""
    if no_torque:
        yield NoTorque()
    elif hidden:
        yield HiddenInertia()
    elif motor.contradicted and inertia is not None:
        found = motor.quantities["B"].value
        yield ContradictedInertia(found=found, configured=inertia.value, prior=inertia.std)


def _set_points(pieces: Sequence[Signals], has_effect: bool) -> tuple[float, float]:
    """Computes the center of the set-points, and the largest distance from the center. The center
    is 0 if the set-points have no effect."""
    ends = [float(end(piece.set_point)) for piece in pieces for end in (np.min, np.max)]
    center = (min(ends) + max(ends)) / 2 if has_effect else 0.0
    return center, max(abs(end - center) for end in ends)


def _apart(pieces: Sequence[Signals], count: float) -> int:
    """Returns the distance of the samples for the fit: 1 if the motor moves by at least one count
    [rad] per sample (RMS), else the number of samples for two counts.

    The rounding errors must be independent from one sample to the next. In slow motion, adjacent
    samples have equal rounding errors.
    """
    moved = math.sqrt(np.mean(np.concatenate([np.diff(piece.theta) for piece in pieces]) ** 2))
    if moved >= count or moved == 0:
        return 1
    longest = max(len(piece.theta) for piece in pieces)
    return max(1, min(math.ceil(2 * count / moved), longest // _FEWEST))


def _center(zero: Quantity | None, pieces: Sequence[Signals]) -> float:
    """Returns the zero of the deformation if its distance from 0 is significant; else 0."""
    if zero is None or not zero.determined:
        return 0.0
    return zero.value if is_off(zero.value, zero.half_width, covered(pieces)) else 0.0


def _check(configuration: Configuration, is_of_spring: bool, torque_constant: bool) -> None:
    """Raises LogError if a port is missing, or if tau must be a current and is not."""
    # The spring alone needs no motor: where it is fixed, as on a test bench, theta is 0.
    needed = ["q", "tau_e_sensor"] if is_of_spring else ["theta", "q", "tau"]
    if torque_constant:
        needed.append("tau_e_sensor")
    for name in needed:
        if name not in configuration.inputs:
            why = "; a torque constant needs a measured torque" if torque_constant else ""
            raise LogError(f"{configuration.path}: identify needs [ports.{name}]{why}; add it")
    if torque_constant and configuration.ports["tau"].torque_constant is None:
        raise LogError(
            f"{configuration.path}: expected [ports.tau] in A with a torque_constant; "
            "add both, or omit --torque-constant"
        )


def _best_V_a(T: float, start: Mapping[str, Value], piece: Signals, f_0: float) -> float:
    """Finds the V_a for which the filtered velocity is nearest to a zero-phase reference."""
    theta: Array = piece.theta[:_V_A_TICKS]
    wide = min(2.5 * f_0, _V_A_HIGHEST / T)
    reference = np.gradient(low_pass(theta, wide, T), T)
    settled = slice(len(theta) // 10, -len(theta) // 10)
    nothing = np.zeros(len(theta))
    errors: dict[float, float] = {}
    for V_a in _V_A:
        filtered = {"method": "Paper2011", "filter.V_a": V_a, "modality": "Residual"}
        estimator = Estimator({**start, **filtered}, ["theta_dot"])
        velocity = estimator.run(theta=theta, q=nothing, tau=nothing)["theta_dot"]
        difference = velocity[settled] - reference[settled]
        errors[V_a] = float(np.mean(difference**2))
    return min(errors, key=errors.__getitem__)
