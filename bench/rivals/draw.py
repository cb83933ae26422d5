"""Draws joints at random, from ranges that are stated here. Nothing is tuned to any method.

A range is log-uniform if its name begins with LOG_, else uniform. Draws that no designer would make
are drawn again: a motor that does not match its load, a joint that swings slower or faster than
joints do, an encoder that cannot see the deformation.

The seeds of docs/rivals.md are 9001 to 9040 and 9101 to 9140. Both were fixed in a commit before
any method saw one of their joints. Nobody tunes on them. All other seeds are for development.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from rivals.joint import Drive, Friction, Instruments, Joint, Link, Motor, Sheet, Spring
from rivals.records import Array

Range = tuple[float, float]
Rng = np.random.Generator
Complex = NDArray[np.complex128]
T = TypeVar("T")

G = 9.81  # [m/s2]
SAMPLE_PERIOD = 1e-3  # [s]
DURATION = 20.0  # [s]
TIMES: Array = SAMPLE_PERIOD * np.arange(round(DURATION / SAMPLE_PERIOD), dtype=np.float64)

# The motor.
LOG_GEAR: Range = (30.0, 160.0)
LOG_B: Range = (1e-5, 2e-4)  # [kg.m2]
LOG_PEAK_BY_B: Range = (3e3, 15e3)  # peak torque by inertia [rad/s2]
LOG_D_BY_B: Range = (1.0, 30.0)  # [1/s]
LOG_STICTION_TIME: Range = (1e-3, 1e-2)  # [s]

# Its friction, with one of the models M1 to M6. Torques by the peak torque.
LOG_DRY: Range = (0.005, 0.08)
STATIC_SHARE: Range = (0.0, 0.6)  # share of the dry friction at rest that motion takes away
LOG_V_S: Range = (0.05, 2.0)  # [rad/s]
ALPHA: Range = (1.0, 3.0)
LOAD: Range = (0.0, 0.1)
QUADRATIC: Range = (0.0, 0.05)  # by 1 / peak

# The spring, and the link.
LOG_STIFFNESS: Range = (100.0, 10000.0)  # [N.m/rad]
HARDENING: Range = (0.0, 0.5)  # more stiffness at the largest deformation, in half of the joints
DAMPING_RATIO: Range = (0.002, 0.03)  # of the link on its spring, motor held
LOG_LINK: Range = (0.05, 1.0)  # inertia about the axis [kg.m2]
LOG_LOAD_BY_MOTOR: Range = (0.25, 8.0)  # inertia of the link by that of the motor behind the gear
FREQUENCY: Range = (2.0, 25.0)  # of the link on its spring, motor held [Hz]
LENGTHS: Range = (0.25, 0.45)  # of the link [m]
LIFTS: float = 1.8  # peak torque by the largest torque of gravity, at least

# Instruments and log.
BITS = (14, 19)  # of the encoders: of the link, and of the motor behind the gear
COUNTS = 30  # of both encoders for the expected deformation, at least
LOG_NOISE: Range = (0.005, 0.03)  # by the peak torque
DELAY: Range = (0.0, 2e-3)  # [s]
LAG: Range = (2e-4, 6e-4)  # [s]
COULOMB_KNOWN: Range = (1.0, 2.0)  # largest plausible by true
MARGIN: Range = (1.05, 1.5)  # largest expected by largest, of deformation and torque

# The drives.
FADE = 1.0  # [s] that a motion takes to begin
EFFORT: Range = (0.4, 0.8)  # of the peak torque
LINES = 10  # of a multisine
LOWEST = 0.3  # line [Hz]
HIGHEST: Range = (0.6, 1.3)  # line of a torque by the frequency of the link on its spring
BANDWIDTH: Range = (1.5, 4.0)  # of position control [Hz]
LARGEST_SPEED = 500.0  # of a motor [rad/s]
LARGEST_GAIN = 60.0  # kd by inertia, so that control is stable in spite of delays [1/s]
LARGEST_SWING: Range = (0.3, 1.0)  # [rad]
CENTRING = 0.3  # bandwidth of the control that keeps a joint near zero under a torque [Hz]
SPRING_STANDS = 1.5  # torque of the spring by that of the motor at its peak, at most
LARGEST_PHI = 0.2  # [rad]

# Relative standard deviations of the data sheets, as drawn, and as the methods are given them.
STD_B = 0.05
STD_D = 0.2
STD_GAIN = 0.015


def drawn(seed: int) -> Joint:
    """A series elastic joint. Its link is a rod.

    The axis is horizontal if the motor can lift the link, in half of these cases.
    """
    rng = np.random.default_rng([seed, 0, 0])
    load = _log(rng, LOG_LINK)
    stiffness = _stiffness(rng, load)
    motor = _motor(rng, load)
    length = _even(rng, LENGTHS)
    link = Link(3 * load / length**2, length)
    can_lift = LIFTS * link.mass * G * link.centre <= motor.gear * motor.peak
    gravity = G if can_lift and rng.integers(2) else 0.0
    make = _torque_drive if rng.integers(2) else _position_drive
    drive, phi = make(rng, motor, load, stiffness)
    instruments, sheet = _instruments(rng, motor.peak, phi), _sheet(rng)
    spring = _spring(rng, stiffness, load, motor.gear * motor.peak)
    return Joint(motor, spring, link, gravity, drive, instruments, sheet)


def _log(rng: Rng, limits: Range) -> float:
    return float(np.exp(rng.uniform(*np.log(limits))))


def _even(rng: Rng, limits: Range) -> float:
    return float(rng.uniform(*limits))


def _within(value: float, limits: Range) -> bool:
    return limits[0] <= value <= limits[1]


def _until(draw: Callable[[], T], good: Callable[[T], bool]) -> T:
    """The first draw that is good."""
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


def _motor(rng: Rng, load: float) -> Motor:
    """A motor for a link of this inertia [kg.m2]."""

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

    return _until(draw, lambda motor: _within(load / motor.inertia, LOG_LOAD_BY_MOTOR))


def _stiffness(rng: Rng, load: float) -> float:
    """A stiffness with which a link of this inertia [kg.m2] swings as joints do [N.m/rad]."""
    return _until(
        lambda: _log(rng, LOG_STIFFNESS),
        lambda k: _within(math.sqrt(k / load) / 2 / math.pi, FREQUENCY),
    )


def _spring(rng: Rng, stiffness: float, load: float, torque: float) -> Spring:
    """A spring that is linear, or hardens at the deformation under this torque [N.m]."""
    more = _even(rng, HARDENING) * int(rng.integers(2))
    k_3 = stiffness * more / 3 / (torque / stiffness) ** 2
    damping = 2 * _even(rng, DAMPING_RATIO) * math.sqrt(stiffness * load)
    return Spring(stiffness, k_3, damping)


def _sheet(rng: Rng) -> Sheet:
    return Sheet(
        B=1 + STD_B * float(rng.standard_normal()),
        D=1 + STD_D * float(rng.standard_normal()),
        coulomb=_even(rng, COULOMB_KNOWN),
        phi=_even(rng, MARGIN),
        tau_e=_even(rng, MARGIN),
    )


def _instruments(rng: Rng, peak: float, phi: float) -> Instruments:
    """Encoders that see the deformation phi [rad]."""

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
    """Sum of sines around zero."""

    frequencies: Array  # [Hz]
    amplitudes: Array
    phases: Array  # [rad]

    @property
    def s(self) -> Complex:
        return 2j * np.pi * self.frequencies.astype(np.complex128)

    def harmonics(self, response: Complex) -> Array:
        """The response of a linear system, from its complex response to each line; 0 at rest."""
        angles = 2 * np.pi * np.outer(TIMES, self.frequencies) + self.phases
        summed: Array = np.imag(np.exp(1j * angles) @ (self.amplitudes * response))
        return summed

    def values(self) -> Array:
        """At TIMES; it fades in."""
        fade = np.clip(TIMES / FADE, 0, 1)
        smooth: Array = fade * fade * (3 - 2 * fade)
        return smooth * self.harmonics(np.ones(LINES, np.complex128))


def _multisine(rng: Rng, highest: float) -> _Multisine:
    frequencies = np.geomspace(LOWEST, highest, LINES) * rng.uniform(0.9, 1.1, LINES)
    return _Multisine(frequencies, np.ones(LINES), rng.uniform(0, 2 * math.pi, LINES))


def _peak(values: Array) -> float:
    return float(np.abs(values).max())


def _gains(motor: Motor, load: float, bandwidth: float) -> tuple[float, float]:
    """kp and kd of a motor with a load [kg.m2] for a bandwidth [Hz]."""
    omega = 2 * math.pi * bandwidth
    total = (motor.inertia + load) / motor.gear
    kd = min(2 * 0.7 * omega * total, LARGEST_GAIN * motor.B * motor.gear)
    return kd * omega / 1.4, kd


def _linear(motor: Motor, load: float, stiffness: float, s: Complex) -> tuple[Complex, Complex]:
    """Motor position and deformation by torque of a linear joint at s = 2 pi j f."""
    c = stiffness * (1 + 1e-3 * s)
    phi_by_theta = -load * s**2 / (load * s**2 + c)
    own = motor.inertia * s**2 + motor.gear**2 * motor.D * s
    theta = motor.gear / (own - c * phi_by_theta)
    return theta, phi_by_theta * theta


def _torque_drive(rng: Rng, motor: Motor, load: float, stiffness: float) -> tuple[Drive, float]:
    """A multisine of torque, and the deformation of a linear joint under it [rad]."""
    own = math.sqrt(stiffness / load) / 2 / math.pi
    sines = _multisine(rng, max(_even(rng, HIGHEST) * own, 3 * LOWEST))
    theta_by_torque, phi_by_torque = _linear(motor, load, stiffness, sines.s)
    speed = motor.gear * _peak(sines.harmonics(sines.s * theta_by_torque))
    phi = _peak(sines.harmonics(phi_by_torque))
    most = min(SPRING_STANDS * motor.gear * motor.peak / stiffness, LARGEST_PHI)
    effort = _even(rng, EFFORT) * motor.peak / _peak(sines.values())
    scale = min(effort, LARGEST_SPEED / speed, most / phi)
    kp, kd = _gains(motor, load, CENTRING)
    return Drive(scale * sines.values(), np.zeros_like(TIMES), kp, kd), scale * phi


def _position_drive(rng: Rng, motor: Motor, load: float, stiffness: float) -> tuple[Drive, float]:
    """Position control along a multisine, and the deformation by the inertia alone [rad]."""
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
    drive = Drive(np.zeros_like(TIMES), scale * sines.values(), kp, kd)
    return drive, scale * load * acceleration / stiffness
