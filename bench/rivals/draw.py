"""Draws joints at random, from ranges that are stated here. The ranges favour no method.

A range is log-uniform if its name begins with LOG_, else uniform. Implausible draws are repeated: a
motor that does not match its load, a resonance that is too low or too high, an encoder too coarse
for the deformation, a motor too weak for its arm.

Do not use the seeds of docs/rivals.md, 9001 to 9040, for tuning: the commit that added the joints
fixed these seeds, before any method was run. The seeds of a second test, 9101 to 9140, were also
fixed before their run. All other seeds are for development.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from rivals.joint import (
    DrawnJoint,
    DrawnSpring,
    DriveCommand,
    Friction,
    Instruments,
    Link,
    Motor,
    Tendons,
)
from rivals.records import STD_B, STD_D, STD_GAIN, Array

Range = tuple[float, float]
Rng = np.random.Generator
Complex = NDArray[np.complex128]
T = TypeVar("T")

G = 9.81  # [m/s2]
SAMPLE_PERIOD = 1e-3  # [s]
DURATION = 20.0  # [s]
TIMES: Array = SAMPLE_PERIOD * np.arange(round(DURATION / SAMPLE_PERIOD), dtype=np.float64)
KINDS = ("series_elastic", "variable_stiffness", "arm")

# The motor.
LOG_GEAR: Range = (30.0, 160.0)
LOG_B: Range = (1e-5, 2e-4)  # [kg.m2]
LOG_PEAK_BY_B: Range = (3e3, 15e3)  # peak torque by inertia [rad/s2]
LOG_D_BY_B: Range = (1.0, 30.0)  # [1/s]
LOG_STICTION_TIME: Range = (1e-3, 1e-2)  # [s]

# Friction of the joint, with one of the models M1 to M6. Torques by the peak torque.
LOG_DRY: Range = (0.005, 0.08)
STATIC_SHARE: Range = (0.0, 0.6)  # fraction of the dry friction at rest that vanishes in motion
LOG_V_S: Range = (0.05, 2.0)  # [rad/s]
ALPHA: Range = (1.0, 3.0)
LOAD: Range = (0.0, 0.1)
QUADRATIC: Range = (0.0, 0.05)  # by 1 / peak

# The spring, and the load that it carries.
LOG_STIFFNESS: Range = (100.0, 10000.0)  # [N.m/rad]
LOG_STIFFNESS_VARIABLE: Range = (100.0, 400.0)  # at the lowest tension [N.m/rad]
LOG_STIFFNESS_ARM: Range = (500.0, 10000.0)  # [N.m/rad]
HARDENING: Range = (0.0, 0.5)  # largest relative increase of stiffness, half of the joints
DAMPING_RATIO: Range = (0.002, 0.03)  # of the link on its spring, motor held
LOG_LINK: Range = (0.05, 1.0)  # [kg.m2]
LOG_LOAD_BY_MOTOR: Range = (0.25, 8.0)  # load inertia divided by motor inertia, at the gear output
FREQUENCY: Range = (2.0, 25.0)  # of the link on its spring, motor held [Hz]

# The tendons.
LEVER: Range = (0.05, 0.08)  # [m]
EYELET_BY_LEVER: Range = (2.0, 3.0)
SPREAD: Range = (0.3, 0.7)  # [rad]
STIFFEST: Range = (1.5, 4.0)  # stiffness at the highest tension divided by stiffness at the lowest
OF_TENDONS: Range = (0.1, 0.4)  # fraction of the joint stiffness that tendons cause
RANGE_THETA_C: Range = (1.0, 6.0)  # [rad]
KNOTS = 2.5  # time between knots; the stiffness motor moves linearly in between [s]

# The arm.
LENGTHS: Range = (0.25, 0.45)  # [m]
LOG_MASS_1: Range = (0.5, 2.5)  # [kg]
LOG_MASS_2: Range = (0.6, 3.0)  # with its load [kg]
CENTRE: Range = (0.4, 0.7)  # by the length
POSE: Range = (0.2, 1.2)  # of both motors, around which they move [rad]
GRAVITY_KNOWN: Range = (0.9, 1.1)  # compensated gravity torque divided by true torque
TIP = 0.02  # radius [m]
HOLDS: float = 1.8  # least ratio of peak torque to the largest gravity torque
TOUCHES: Range = (0.05, 0.25)  # fraction of the time with a reference of the tip below the floor

# Instruments and log.
BITS = (14, 19)  # resolution of the encoders of link and motor, at the gear output
COUNTS = 30  # least number of encoder counts in the expected deformation
LOG_NOISE: Range = (0.005, 0.03)  # by the peak torque
DELAY: Range = (0.0, 2e-3)  # [s]
LAG: Range = (2e-4, 6e-4)  # [s]
COULOMB_KNOWN: Range = (1.0, 2.0)  # largest plausible value divided by true value
MARGIN: Range = (1.05, 1.5)  # expected maximum divided by true maximum, of deformation and torque

# What the drives do.
FADE = 1.0  # duration of the smooth start of a motion [s]
EFFORT: Range = (0.4, 0.8)  # of the peak torque
LINES = 10  # of a multisine
LOWEST = 0.3  # line [Hz]
HIGHEST: Range = (0.6, 1.3)  # highest torque frequency divided by link frequency
BANDWIDTH: Range = (1.5, 4.0)  # of position control [Hz]
LARGEST_SPEED = 500.0  # of a motor [rad/s]
LARGEST_GAIN = 60.0  # kd divided by inertia, for stable control with delays [1/s]
LARGEST_SWING: Range = (0.3, 1.0)  # [rad]
CENTRING = 0.3  # bandwidth of position control in addition to a fed-forward torque [Hz]
SPRING_STANDS = 1.5  # largest spring torque divided by the peak torque of the motor
LARGEST_PHI = 0.2  # [rad]


def drawn(kind: str, seed: int) -> DrawnJoint:
    """Draws a joint of one of KINDS; each kind has its own random numbers."""
    draw = (_series_elastic, _variable_stiffness, _arm)[KINDS.index(kind)]
    return draw(np.random.default_rng([seed, KINDS.index(kind), 0]))


def _log(rng: Rng, limits: Range) -> float:
    return float(np.exp(rng.uniform(*np.log(limits))))


def _even(rng: Rng, limits: Range) -> float:
    return float(rng.uniform(*limits))


def _within(value: float, limits: Range) -> bool:
    return limits[0] <= value <= limits[1]


def _until(draw: Callable[[], T], good: Callable[[T], bool]) -> T:
    """Repeats a draw until the condition `good` is true, and returns this draw."""
    return next(filter(good, iter(draw, None)))


def _friction(rng: Rng, peak: float) -> Friction:
    model = int(rng.integers(1, 7))
    dry = _log(rng, LOG_DRY) * peak
    static = _even(rng, STATIC_SHARE) if model in (2, 4, 5, 6) else 0.0
    m, e, ms, es = rng.uniform(*LOAD, 4)
    mq, eq = rng.uniform(*QUADRATIC, 2) / peak
    if model in (3, 4):
        e, es = m, ms
    loaded, slow, quadratic = model >= 3, model >= 4, model == 6
    return Friction(
        K_c=(1 - static) * dry,
        K_cs=static * dry,
        v_s=_log(rng, LOG_V_S),
        alpha=_even(rng, ALPHA),
        K_m=loaded * float(m),
        K_e=loaded * float(e),
        K_ms=slow * float(ms),
        K_es=slow * float(es),
        K_mq=quadratic * float(mq),
        K_eq=quadratic * float(eq),
    )


def _motor(rng: Rng, load: float, holds: float = 0.0) -> Motor:
    """Draws a motor for an inertia `load` [kg.m2] that can hold a torque `holds` [N.m]."""

    def draw() -> Motor:
        B = _log(rng, LOG_B)
        peak = B * _log(rng, LOG_PEAK_BY_B)
        return Motor(
            gear=_log(rng, LOG_GEAR),
            B=B,
            D=B * _log(rng, LOG_D_BY_B),
            peak=peak,
            friction=_friction(rng, peak),
            stiction_time=_log(rng, LOG_STICTION_TIME),
        )

    def good(motor: Motor) -> bool:
        matches = _within(load / motor.inertia, LOG_LOAD_BY_MOTOR)
        return matches and motor.gear * motor.peak >= HOLDS * holds

    return _until(draw, good)


def _spring(rng: Rng, stiffness: float, load: float, torque: float) -> DrawnSpring:
    """Draws a spring that is linear, or hardens at the deformation by the given torque [N.m]."""
    more = _even(rng, HARDENING) * int(rng.integers(2))
    return DrawnSpring(
        stiffness, stiffness * more / 3 / (torque / stiffness) ** 2, _damping(rng, stiffness, load)
    )


def _damping(rng: Rng, stiffness: float, load: float) -> float:
    return 2 * _even(rng, DAMPING_RATIO) * math.sqrt(stiffness * load)


def _stiffness(rng: Rng, limits: Range, load: float) -> float:
    return _until(
        lambda: _log(rng, limits), lambda k: _within(math.sqrt(k / load) / 2 / math.pi, FREQUENCY)
    )


def _sheet(rng: Rng) -> dict[str, float]:
    return {
        "motor.B": 1 + STD_B * float(rng.standard_normal()),
        "motor.D_theta": 1 + STD_D * float(rng.standard_normal()),
        "prior.tau_coulomb": _even(rng, COULOMB_KNOWN),
        "range.phi": _even(rng, MARGIN),
        "prior.tau_e": _even(rng, MARGIN),
    }


def _instruments(rng: Rng, peak: float, phi: float) -> Instruments:
    """Draws instruments with encoders that can resolve the deformation phi [rad]."""

    def encoder() -> int:
        return 1 << int(rng.integers(BITS[0], BITS[1] + 1))

    def sees(counts: int) -> bool:
        return counts == 2 ** BITS[1] or phi >= COUNTS * (2 * math.pi / counts)

    return Instruments(
        commanded=bool(rng.integers(2)),
        delay=_even(rng, DELAY),
        lag=_even(rng, LAG),
        gain=1 + STD_GAIN * float(rng.standard_normal()),
        noise=_log(rng, LOG_NOISE) * peak,
        counts_theta=_until(encoder, sees),
        counts_q=_until(encoder, sees),
    )


@dataclass(frozen=True)
class _Multisine:
    """A sum of sines with mean zero."""

    frequencies: Array  # [Hz]
    amplitudes: Array
    phases: Array  # [rad]

    @property
    def s(self) -> Complex:
        return 2j * np.pi * self.frequencies.astype(np.complex128)

    def harmonics(self, response: Complex) -> Array:
        """Computes the output of a linear system, given its complex response to each sine."""
        angles = 2 * np.pi * np.outer(TIMES, self.frequencies) + self.phases
        summed: Array = np.imag(np.exp(1j * angles) @ (self.amplitudes * response))
        return summed

    def values(self) -> Array:
        """Computes the multisine at TIMES, with an amplitude that rises smoothly from 0."""
        fade = np.clip(TIMES / FADE, 0, 1)
        smooth: Array = fade * fade * (3 - 2 * fade)
        return smooth * self.harmonics(np.ones(LINES, np.complex128))


def _multisine(rng: Rng, highest: float) -> _Multisine:
    frequencies = np.geomspace(LOWEST, highest, LINES) * rng.uniform(0.9, 1.1, LINES)
    return _Multisine(frequencies, np.ones(LINES), rng.uniform(0, 2 * math.pi, LINES))


def _peak(values: Array) -> float:
    return float(np.abs(values).max())


def _gains(motor: Motor, load: float, bandwidth: float) -> tuple[float, float]:
    """Computes the control gains kp and kd of a motor with a load [kg.m2] for a bandwidth [Hz]."""
    omega = 2 * math.pi * bandwidth
    total = (motor.inertia + load) / motor.gear
    kd = min(2 * 0.7 * omega * total, LARGEST_GAIN * motor.B * motor.gear)
    return kd * omega / 1.4, kd


def _torque_drive(
    rng: Rng, motor: Motor, load: float, stiffness: float
) -> tuple[DriveCommand, float]:
    """Draws a multisine of torque, and computes the deformation of a linear joint [rad]."""
    own_frequency = math.sqrt(stiffness / load) / 2 / math.pi
    sines = _multisine(rng, max(_even(rng, HIGHEST) * own_frequency, 3 * LOWEST))
    s = sines.s  # 2 pi j f
    c = stiffness * (1 + 1e-3 * s)
    phi_by_theta = -load * s**2 / (load * s**2 + c)
    own = motor.inertia * s**2 + motor.gear**2 * motor.D * s
    theta_by_torque = motor.gear / (own - c * phi_by_theta)
    speed = motor.gear * _peak(sines.harmonics(s * theta_by_torque))
    phi = _peak(sines.harmonics(phi_by_theta * theta_by_torque))
    most = min(SPRING_STANDS * motor.gear * motor.peak / stiffness, LARGEST_PHI)
    effort = _even(rng, EFFORT) * motor.peak / _peak(sines.values())
    scale = min(effort, LARGEST_SPEED / speed, most / phi)
    kp, kd = _gains(motor, load, CENTRING)
    return DriveCommand(
        scale * sines.values(), np.zeros_like(TIMES), kp, kd, motor.peak
    ), scale * phi


def _position_drive(
    rng: Rng, motor: Motor, load: float, stiffness: float, centre: float = 0.0
) -> tuple[DriveCommand, float]:
    """Draws position control along a multisine, and computes the deformation by inertia [rad]."""
    bandwidth = _even(rng, BANDWIDTH)
    sines = _multisine(rng, bandwidth)
    sines = replace(sines, amplitudes=1 / sines.frequencies)
    acceleration = _peak(sines.harmonics(sines.s**2))
    torque = (motor.inertia + load) / motor.gear * acceleration
    scale = min(
        _even(rng, EFFORT) * motor.peak / torque,
        LARGEST_SPEED / motor.gear / _peak(sines.harmonics(sines.s)),
        _even(rng, LARGEST_SWING) / _peak(sines.values()),
        LARGEST_PHI * stiffness / load / acceleration,
    )
    kp, kd = _gains(motor, load, bandwidth)
    drive = DriveCommand(np.zeros_like(TIMES), centre + scale * sines.values(), kp, kd, motor.peak)
    return drive, scale * load * acceleration / stiffness


def _single(rng: Rng, load: float, stiffness: float) -> dict[str, Any]:
    """Draws a joint with one motor and a rod as link, without a spring. In half of the cases the
    axis is horizontal, if the motor can lift the link."""
    motor = _motor(rng, load)
    length = _even(rng, LENGTHS)
    mass = 3 * load / length**2
    link = Link(mass, length, length / 2, mass * length**2 / 12)
    lifts = HOLDS * link.mass * G * link.centre <= motor.gear * motor.peak
    gravity = G if lifts and rng.integers(2) else 0.0
    make = _torque_drive if rng.integers(2) else _position_drive
    drive, phi = make(rng, motor, load, stiffness)
    return {
        "motors": (motor,),
        "links": (link,),
        "gravity": gravity,
        "drives": (drive,),
        "instruments": (_instruments(rng, motor.peak, phi),),
        "sheet": _sheet(rng),
    }


def _series_elastic(rng: Rng) -> DrawnJoint:
    """Draws a series elastic joint with a linear or hardening spring."""
    load = _log(rng, LOG_LINK)
    stiffness = _stiffness(rng, LOG_STIFFNESS, load)
    parts = _single(rng, load, stiffness)
    (motor,) = parts["motors"]
    return DrawnJoint(springs=(_spring(rng, stiffness, load, motor.gear * motor.peak),), **parts)


def _tendons(rng: Rng, stiffness: float, load: float) -> Tendons:
    lever = _even(rng, LEVER)
    eyelet = lever * _even(rng, EYELET_BY_LEVER)
    range_theta_c = _even(rng, RANGE_THETA_C)
    share, stiffest = _even(rng, OF_TENDONS), _even(rng, STIFFEST)
    damping = _damping(rng, stiffness, load)
    plain = Tendons(lever, eyelet, _even(rng, SPREAD), 1, 0, 0, range_theta_c, damping)
    # The stiffness of a joint is linear in stiffness and tension of its tendons.
    by_tension = replace(plain, stiffness=0, tension=1).joint_stiffness()
    k = share * stiffness / plain.joint_stiffness()
    return replace(
        plain,
        stiffness=k,
        tension=(1 - share) * stiffness / by_tension,
        travel=(stiffest - 1) * stiffness / by_tension / k / range_theta_c,
    )


def _variable_stiffness(rng: Rng) -> DrawnJoint:
    """Draws a joint with two tendons, whose stiffness motor turns during the simulation."""
    load = _log(rng, LOG_LINK)
    stiffness = _stiffness(rng, LOG_STIFFNESS_VARIABLE, load)
    tendons = _tendons(rng, stiffness, load)
    parts = _single(rng, load, stiffness)
    knots = np.arange(0, DURATION + KNOTS, KNOTS)
    theta_c = np.interp(TIMES, knots, rng.uniform(0, tendons.range_theta_c, len(knots)))
    return DrawnJoint(tendons=tendons, theta_c=theta_c, **parts)


def _links(rng: Rng) -> tuple[Link, Link]:
    def draw(masses: Range) -> Link:
        mass, length = _log(rng, masses), _even(rng, LENGTHS)
        return Link(mass, length, _even(rng, CENTRE) * length, mass * length**2 / 12)

    return _until(
        lambda: (draw(LOG_MASS_1), draw(LOG_MASS_2)),
        lambda links: all(_within(load, LOG_LINK) for load in _loads(links)),
    )


def _loads(links: tuple[Link, Link]) -> tuple[float, float]:
    """Computes the inertia about both axes, with a right angle at the elbow [kg.m2]."""
    upper, lower = links
    at_elbow = lower.about_axis
    return upper.about_axis + lower.mass * upper.length**2 + at_elbow, at_elbow


def _gravity_torques(links: tuple[Link, Link], q_1: Array, q_2: Array) -> tuple[Array, Array]:
    """Computes the torques that hold the arm at two angles [N.m]; the second angle is relative to
    the first link."""
    upper, lower = links
    elbow = G * lower.mass * lower.centre * np.sin(q_1 + q_2)
    at_shoulder = G * (upper.mass * upper.centre + lower.mass * upper.length) * np.sin(q_1)
    return at_shoulder + elbow, elbow


def _arm(rng: Rng) -> DrawnJoint:
    """Draws an arm with two flexible joints, one of which is in the log. The reference position of
    the tip is below the floor for some of the time, but not at the beginning."""
    links = _links(rng)
    loads = _loads(links)
    quarter = np.full(1, math.pi / 2)
    holds = [float(each[0]) for each in _gravity_torques(links, quarter, 0 * quarter)]
    stiffness = [_stiffness(rng, LOG_STIFFNESS_ARM, load) for load in loads]
    motors = [_motor(rng, load, hold) for load, hold in zip(loads, holds, strict=True)]
    centres = [float(each) for each in rng.uniform(*POSE, 2)]
    parts = zip(motors, loads, stiffness, centres, strict=True)
    made = [_position_drive(rng, *each) for each in parts]
    q_1, q_2 = (drive.reference for drive, _ in made)
    height = -links[0].length * np.cos(q_1) - links[1].length * np.cos(q_1 + q_2) - TIP
    floor = float(np.quantile(height, _even(rng, TOUCHES)))
    if height[0] <= floor + TIP:
        return _arm(rng)
    weights = _gravity_torques(links, q_1, q_2)
    drives, instruments, springs = [], [], []
    for motor, (drive, phi), weight, k, load in zip(
        motors, made, weights, stiffness, loads, strict=True
    ):
        known = _even(rng, GRAVITY_KNOWN) * weight / motor.gear
        drives.append(replace(drive, feed_forward=known))
        instruments.append(_instruments(rng, motor.peak, phi + float(np.ptp(weight)) / 2 / k))
        springs.append(_spring(rng, k, load, motor.gear * motor.peak))
    return DrawnJoint(
        motors=tuple(motors),
        springs=tuple(springs),
        links=links,
        gravity=G,
        floor=floor,
        start=tuple(centres),
        drives=tuple(drives),
        observed=int(rng.integers(2)),
        instruments=tuple(instruments),
        sheet=_sheet(rng),
    )
