"""Finds the motion that shows the stiffness of a set of joints best, within common limits.

The log of each motion is simulated. To compare motions, `estimate` evaluates it with the data of
the simulated joint; to predict the result, `identify` comes first, as for a recorded log.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import tomlkit

from sigmahat.experiments.pool import run_all
from sigmahat.files import toml_file
from sigmahat.motion.joints_of_log import Array, Joint, Limits, Multisine, Ranges
from sigmahat.motor.identify import identify
from sigmahat.motor.quantities import WIDE
from sigmahat.motor.write import update
from sigmahat.recording.configuration import checked_configuration
from sigmahat.recording.log import LogError, LogInMemory
from sigmahat.result.curve import stiffness_in_the_middle
from sigmahat.result.estimate import estimate

_RATIOS = (1.0, 1.618, 2.713, 4.237)  # ratios of the frequencies: no multiples of each other
_PHASES = (0.0, 1.0, 2.0, 3.0)
_OF_RESONANCE = (0.15, 0.3, 0.5)  # ratio of the highest frequency to the lowest resonance
_EXPONENTS = (1.0, 2.0)  # amplitudes fall with the frequency to this power
_HIGHEST = 5.0  # [Hz] no motion of a stiff joint is faster
_CYCLES = 2.0  # least number of cycles of the slowest sine
_RAMP = 0.15  # largest duration of a ramp, relative to the duration of the motion
_LONGEST_RAMP = 2.0  # [s]
_COARSE = 0.02  # [s] sample period for the search of peaks
_REST, _STEPS = 1e-6, 6
_MARGIN = 0.97  # share of the limits, for joints between the tried joints
_ROOM = 1.2  # ratio of a range to the largest value, as `identify` writes it
_NONE = 1e-9  # least friction, because an estimator takes a prior of 0 as exact
_COMPARED, _PROMISED = 6, 20  # number of joints: to compare candidates, and to predict the result

NOT_SHOWN = 1.0  # largest ratio of half width to stiffness of a motion that shows the stiffness
NOISE = 0.003  # default noise of the torque: standard deviation divided by the limit of the torque


@dataclass(frozen=True)
class Sensors:
    gear_ratio: float
    counts: tuple[float, float]  # counts of both encoders per turn at the gear output
    torque_gain: float  # relative standard deviation of the gain of the torque: prior.torque_gain
    noise: float  # noise of the torque of the motor at the gear output [N.m]
    T: float  # time between samples [s]


def relative_half_width(joint: Joint, motion: Multisine, sensors: Sensors) -> float:
    """Half of the 95 % interval of the stiffness in the middle, divided by the stiffness.

    `identify` and `estimate` evaluate a simulated log. Infinite if they refuse this log.
    """
    log, document = _log(joint, motion, sensors), _document(sensors)
    try:
        update(document, identify(log, checked_configuration(document, log.path)))
    except LogError:
        return float("inf")
    return _half_width(log, document)


def compared_half_width(joint: Joint, motion: Multisine, sensors: Sensors) -> float:
    """As `relative_half_width`, but without `identify`, which takes ten times as long as the rest.

    The estimator knows noise, ranges and motor of the simulated joint, the motor with wide priors.
    Where `identify` would determine the inertia, the half width is smaller than here.
    """
    log, document = _log(joint, motion, sensors), _document(sensors)
    theta, q, tau = (log.read(name) for name in ("theta", "q", "tau"))
    gear_ratio = abs(sensors.gear_ratio)
    values = {
        "motor.B": joint.B / gear_ratio**2,
        "motor.D_theta": max(joint.D_theta, _NONE) / gear_ratio**2,
        "prior.B": WIDE,
        "prior.D_theta": WIDE,
        "prior.tau_coulomb": max(joint.tau_coulomb, _NONE) / gear_ratio,
        "prior.tau_e": _ROOM * gear_ratio * _peak(tau),
        "noise.tau": sensors.noise / gear_ratio,
        "range.phi": _ROOM * _peak(q - theta),
    }
    for name, value in values.items():
        toml_file.set_dotted(document["parameters"], name, tomlkit.item(value))
    return _half_width(log, document)


def _document(sensors: Sensors) -> tomlkit.TOMLDocument:
    """Creates the configuration of a simulated log, before `identify`."""
    document = tomlkit.document()
    document["ports"] = {name: {"column": name} for name in ("theta", "q", "tau")}
    document["parameters"] = {
        "method": "FilteredRegression",
        "motor": {"gamma": sensors.gear_ratio},
        "samplePeriod": sensors.T,
        "encoder": {"theta": sensors.counts[0], "q": sensors.counts[1]},
        "prior": {"torque_gain": sensors.torque_gain},
    }
    return document


def _half_width(log: LogInMemory, document: tomlkit.TOMLDocument) -> float:
    try:
        curve = estimate(log, checked_configuration(document, log.path)).curve
    except LogError:
        return float("inf")
    if not curve.branches:
        return float("inf")
    _, sigma, interval = stiffness_in_the_middle(curve.branches[0])
    assert interval is not None  # FilteredRegression gives an interval
    return (interval[1] - interval[0]) / 2 / max(abs(sigma), 1e-300)


def _log(joint: Joint, motion: Multisine, sensors: Sensors) -> LogInMemory:
    theta, velocity, acceleration = motion.at(motion.times(sensors.T))
    phi, torque = joint.respond(theta, velocity, acceleration, sensors.T)
    noise = sensors.noise * np.random.default_rng(1).standard_normal(len(theta))
    columns = {
        "theta": _rounded(theta, sensors.counts[0]),
        "q": _rounded(theta + phi, sensors.counts[1]),
        "tau": (torque + noise) / sensors.gear_ratio,
    }
    return LogInMemory(Path("motion"), columns)


def _rounded(angle: Array, counts: float) -> Array:
    step = 2 * np.pi / counts if counts else 0.0
    return step * np.round(angle / step) if step else angle


@dataclass(frozen=True)
class Design:
    motion: Multisine
    peaks: Limits  # largest values of all joints that were tried
    half_widths: Sequence[float]
    """Half widths of the stiffness in the middle of the data, divided by the stiffness, sorted."""

    @property
    def not_shown(self) -> int:
        """Number of the joints whose stiffness the motion does not show."""
        return sum(each > NOT_SHOWN for each in self.half_widths)

    def quantile(self, share: float) -> float:
        """A half width that this fraction of the joints does not exceed."""
        return float(np.quantile(self.half_widths, share))


def design(
    joints: Ranges,
    limits: Limits,
    sensors: Sensors,
    duration: float,
    progress: Callable[[int], object] = lambda done: None,
) -> Design:
    """The sum of four sines with the smallest geometric mean of the half widths.

    progress  is given the number of joints that were tried since the last call, of `trials()`

    Raises LogError if no motion of this duration keeps the limits and stays below the resonance.
    """
    corners = list(joints.corners())
    candidates = list(_candidates(corners, limits, duration))
    if not candidates:
        raise LogError(_why_none(corners, limits, duration))
    compared = list(joints.draw(_COMPARED, np.random.default_rng(1)))
    found = np.empty((len(candidates), _COMPARED))
    for place in np.ndindex(found.shape):
        found[place] = compared_half_width(compared[place[1]], candidates[place[0]], sensors)
        progress(1)
    # Mean of the logarithms: all joints that the motion does not show have equal weight.
    means = np.mean(np.log(np.minimum(found, NOT_SHOWN)), axis=1)
    best = candidates[int(np.argmin(means))]
    drawn = list(joints.draw(_PROMISED, np.random.default_rng(2)))
    jobs = [partial(relative_half_width, joint, best, sensors) for joint in drawn]
    widths = run_all(jobs, progress=progress)
    return Design(best, _peaks(best, [*corners, *drawn]), sorted(widths))


def _why_none(joints: Sequence[Joint], limits: Limits, duration: float) -> str:
    """Explains why no motion is possible: the duration is too short, or the torque too large."""
    lowest = min(each.resonance for each in joints)
    shortest = _shortest(_frequencies(lowest, _OF_RESONANCE[-1]))
    if duration < shortest:
        return (
            f"no motion of {duration:g} s stays below the lowest resonance of the joints, "
            f"{lowest:.3g} Hz; expected {shortest:.3g} s or more"
        )
    torque = max(each.weight + each.tau_coulomb for each in joints)
    deformation = max(each.weight / each.k for each in joints)
    return (
        f"limits of {limits.torque:g} N.m and {limits.deformation:g} rad leave no room for a "
        f"motion: weight and friction alone need up to {torque:.3g} N.m, and the weight deforms up "
        f"to {deformation:.3g} rad; expected wider limits"
    )


def _frequencies(resonance: float, share: float) -> list[float]:
    """Frequencies of the sines [Hz]; the highest one is `share` times the lowest resonance."""
    highest = min(share * resonance, _HIGHEST)
    return [highest * ratio / _RATIOS[-1] for ratio in _RATIOS]


def _shortest(frequencies: Sequence[float]) -> float:
    """Shortest duration with enough cycles of the slowest sine between the ramps [s]."""
    ramps = 2 * _RAMP  # together, of the duration
    cycles = _CYCLES / frequencies[0]
    return min(cycles, cycles * (1 - ramps) + 2 * _LONGEST_RAMP)


def trials() -> int:
    """Returns the largest number of joints that are tried."""
    return len(_OF_RESONANCE) * len(_EXPONENTS) * _COMPARED + _PROMISED


def _candidates(joints: Sequence[Joint], limits: Limits, duration: float) -> Iterator[Multisine]:
    lowest = min(each.resonance for each in joints)
    ramp = min(_LONGEST_RAMP, _RAMP * duration)
    for share in _OF_RESONANCE:
        frequencies = _frequencies(lowest, share)
        if duration < _shortest(frequencies):
            continue
        for exponent in _EXPONENTS:
            amplitudes = [f**-exponent for f in frequencies]
            motion = Multisine(amplitudes, frequencies, _PHASES, duration, ramp)
            scaled = _within(motion, joints, limits)
            if scaled is not None:
                yield scaled


def _within(motion: Multisine, joints: Sequence[Joint], limits: Limits) -> Multisine | None:
    """Scales a motion to the limits; None if even a joint at rest exceeds the limits."""
    position, velocity, _ = motion.at(motion.times(_COARSE))
    scale = _MARGIN * min(limits.angle / _peak(position), limits.velocity / _peak(velocity))
    rest = _peaks(motion.scaled(_REST * scale), joints)
    room_of_torque = _MARGIN * limits.torque - rest.torque
    room_of_deformation = _MARGIN * limits.deformation - rest.deformation
    if min(room_of_torque, room_of_deformation) <= 0:
        return None
    for _ in range(_STEPS):  # the peaks are almost linear in the scale
        peaks = _peaks(motion.scaled(scale), joints)
        factor = min(
            room_of_torque / max(peaks.torque - rest.torque, 1e-300),
            room_of_deformation / max(peaks.deformation - rest.deformation, 1e-300),
        )
        if factor >= 1:
            return motion.scaled(scale)
        scale *= factor * _MARGIN
    return None


def _peaks(motion: Multisine, joints: Sequence[Joint]) -> Limits:
    position, velocity, acceleration = motion.at(motion.times(_COARSE))
    moved = [joint.respond(position, velocity, acceleration, _COARSE) for joint in joints]
    deformation, torque = (max(map(_peak, each)) for each in zip(*moved, strict=True))
    return Limits(_peak(position), _peak(velocity), torque, deformation)


def _peak(signal: Array) -> float:
    return float(np.max(np.abs(signal)))
