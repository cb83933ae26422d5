"""A log of a series elastic knee in counts, degrees and amperes, and wrong configurations of it.

The twelve wrong configurations are from the issue that asked for `sigmahat check`.
"""

from collections.abc import Mapping
from functools import cache

import numpy as np
from numpy.typing import NDArray

from plant_runs import run_plant, times

Array = NDArray[np.float64]

GEAR, COUNTS, ZERO, CONSTANT = 100.0, 4096.0, 1500.0, 0.05
KNEE = {
    "motor.B": 1e-4,
    "motor.D_theta": 5e-4,
    "motor.gamma": GEAR,
    "motor.tau_coulomb": 0.03,
    "link.M": 0.5,
    "link.D_q": 0.1,
    "spring.k_1": 1000.0,
    "encoder.theta": COUNTS * GEAR,
    "encoder.q": 262144.0,
}
SINES = ((0.15, 0.31, 0.0), (0.12, 1.3, 0.4), (0.08, 4.1, 1.0))
"""Amplitude [N.m], frequency [Hz] and phase of the torque of the motor."""

RIGHT = """\
[time]
column = "t"
[ports.theta]
column = "motor_counts"
unit = "counts"
counts_per_turn = 4096
gear_ratio = 100
zero = 1500
[ports.q]
column = "link_deg"
unit = "deg"
[ports.tau]
column = "current"
unit = "A"
torque_constant = 0.05
[parameters]
samplePeriod = 0.001
method = "FilteredRegression"
motor.B = 1.05e-4
motor.D_theta = 5.5e-4
motor.gamma = 100
prior.B = 0.1
encoder.q = 262144
range.phi = 0.03
prior.tau_e = 20
rls.n = 1
rls.m = 1
"""
WRONG: Mapping[str, tuple[str, str, tuple[str, ...]]] = {
    "torque sign": ("torque_constant", "sign = -1\ntorque_constant", ("ports.tau.sign",)),
    "link sign": ('unit = "deg"', 'unit = "deg"\nsign = -1', ("ports.q.sign",)),
    "link offset 1 degree": (
        'unit = "deg"',
        'unit = "deg"\nzero = 1.0',
        ("ports.q.zero", "ports.theta.zero"),
    ),
    "encoder zero 0": ("zero = 1500\n", "", ("ports.q.zero", "ports.theta.zero")),
    "degrees as rad": ('unit = "deg"', 'unit = "rad"', ("ports.q.unit",)),
    "counts per turn x 4": ("4096", "16384", ("ports.theta.counts_per_turn",)),
    "theta without its gear": ("gear_ratio = 100\n", "", ("ports.theta.gear_ratio",)),
    "gamma 50 instead of 100": ("gamma = 100", "gamma = 50", ("motor.gamma",)),
    "gamma 80": ("gamma = 100", "gamma = 80", ("motor.gamma",)),
    "torque 10 ms late": ('"current"', '"late_current"', ("ports.tau.delay",)),
    "torque geared twice": (
        "torque_constant",
        "gear_ratio = 100\ntorque_constant",
        ("ports.tau.gear_ratio",),
    ),
    "torque constant + 10 %": ("= 0.05\n", "= 0.055\n", ("ports.tau.torque_constant",)),
}
"""Wrong configurations by name: text in RIGHT, replacement, keys of which `check` must name one.
"""


def joint_log(plant: Mapping[str, float], T: float, load: float = 0.0) -> dict[str, Array]:
    """20 s of RealJointPlant: t, theta, q, tau in rad and N.m, under a torque on the link [N.m]."""
    t = times(T, 20.0)
    tau = sum(A * np.sin(2 * np.pi * f * t + phase) for A, f, phase in SINES)
    torques = np.column_stack([tau, np.full_like(t, load)])
    record = ("theta_measured", "q_measured", "tau_measured")
    run = run_plant("RealJointPlant", ("tau", "tau_ext"), T, torques, plant, record)
    return {"t": t, **{name.removesuffix("_measured"): run[name] for name in record}}


def as_recorded(log: Mapping[str, Array]) -> dict[str, Array]:
    """A log of joint_log in counts, degrees and amperes."""
    return {
        "t": log["t"],
        "motor_counts": np.round(log["theta"] / (2 * np.pi) * COUNTS * GEAR) + ZERO,
        "link_deg": np.degrees(log["q"]),
        "current": log["tau"] / CONSTANT,
    }


@cache
def knee_log() -> Mapping[str, Array]:
    """The columns of the log."""
    log = as_recorded(joint_log(KNEE, 1e-3))
    current = log["current"]
    return {**log, "late_current": np.concatenate([np.full(10, current[0]), current[:-10]])}


def _sines(amplitude: float) -> tuple[Array, Array, Array, Array]:
    """20 s at 1 kHz: times, a position and its derivatives [rad, s]."""
    t = times(1e-3, 20.0)
    waves = [(amplitude / n, 2 * np.pi * f) for n, f in enumerate((0.23, 0.61, 1.07), 1)]
    theta = np.sum([A * np.sin(w * t) for A, w in waves], axis=0)
    velocity = np.sum([A * w * np.cos(w * t) for A, w in waves], axis=0)
    return t, theta, velocity, np.sum([-A * w**2 * np.sin(w * t) for A, w in waves], axis=0)


def _motor_torque(velocity: Array, acceleration: Array) -> Array:
    """Torque of inertia and friction of the knee's motor [N.m]."""
    friction = KNEE["motor.D_theta"] * GEAR * velocity
    friction += KNEE["motor.tau_coulomb"] * np.tanh(velocity / 0.02)
    return KNEE["motor.B"] * GEAR * acceleration + friction


def log_by_hand(hold: float) -> Mapping[str, Array]:
    """The knee, moved by a hand, in closed form: the motion of the motor, then (1) and (3) for q.

    hold  stiffness with which the drive holds the motor at 0, as a part of that of the spring [1];
          0 for a drive without current
    """
    t, theta, velocity, acceleration = _sines(0.3)
    K = KNEE["spring.k_1"]
    tau = -hold * K * (theta + 0.02 * velocity) / GEAR
    tau_e = GEAR * (_motor_torque(velocity, acceleration) - tau)
    noise = 1e-5 * np.random.default_rng(1).standard_normal(len(t))
    return as_recorded({"t": t, "theta": theta, "q": theta + tau_e / K, "tau": tau + noise})


def log_of_teaching() -> Mapping[str, Array]:
    """The knee with a weight that its torque compensates, moved by a hand, in closed form. The
    cogging of the motor, 2 mN.m, is not in the motor equation of `check`."""
    t, theta, velocity, acceleration = _sines(0.4)
    tau = 30.0 * np.sin(theta) / GEAR
    cogging = 2e-3 * np.sin(40 * theta)
    tau_e = GEAR * (_motor_torque(velocity, acceleration) + cogging - tau)
    noise = 1e-4 * np.random.default_rng(1).standard_normal(len(t))
    q = theta + tau_e / KNEE["spring.k_1"]
    return as_recorded({"t": t, "theta": theta, "q": q, "tau": tau + noise})


def log_under_gravity(change: float) -> Mapping[str, Array]:
    """The knee with a weight, in slow motion, in closed form. The stiffness of the knee changes at
    8 s.

    change  of the stiffness, relative: 1 doubles it
    """
    t, theta, velocity, acceleration = _sines(0.4)
    load = 12.0 * np.sin(theta) + acceleration  # torque of a weight and 1 kg.m2 [N.m]
    K = KNEE["spring.k_1"] * np.where(t < 8.0, 1.0, 1.0 + change)
    tau = _motor_torque(velocity, acceleration) + load / GEAR
    noise = 1e-3 * np.random.default_rng(1).standard_normal(len(t))
    return as_recorded({"t": t, "theta": theta, "q": theta - load / K, "tau": tau + noise})


def log_of_a_hardening_spring(zero: float) -> Mapping[str, Array]:
    """The knee under a weight that loads it to one side, in slow motion, in closed form. At 20 mrad
    the secant stiffness has doubled.

    zero  deformation at which the spring has no torque [rad]
    """
    t, theta, velocity, acceleration = _sines(0.4)
    load = 20.0 + 12.0 * np.sin(theta) + acceleration  # torque of a weight and 1 kg.m2 [N.m]
    deformations = np.linspace(-0.1, 0.1, 20001)
    torques = KNEE["spring.k_1"] * deformations * (1.0 + (deformations / 0.02) ** 2)
    q = theta + zero + np.interp(-load, torques, deformations)
    tau = _motor_torque(velocity, acceleration) + load / GEAR
    noise = 1e-3 * np.random.default_rng(1).standard_normal(len(t))
    return as_recorded({"t": t, "theta": theta, "q": q, "tau": tau + noise})


def stiff_log() -> dict[str, Array]:
    """The knee with a spring that is rigid, in slow motion without any load, in closed form."""
    t, theta, velocity, acceleration = _sines(0.3)
    noise = np.random.default_rng(1).standard_normal((2, len(t)))
    q = theta + 3e-5 * noise[0]
    tau = _motor_torque(velocity, acceleration) + 1e-4 * noise[1]
    return {"t": t, "theta": theta, "q": q, "tau": tau}


def log_with_rests() -> Mapping[str, Array]:
    """The knee with a weight, between poses, in closed form: a second of motion and one of rest.

    At rest, static friction holds up to 0.8 times the Coulomb friction, drawn for each rest.
    """
    T, rng = 1e-3, np.random.default_rng(2)
    t = times(T, 30.0)
    poses = np.concatenate([[0.0], rng.uniform(-0.6, 0.6, 16)])
    k, s = (t // 2.0).astype(int), np.minimum(t % 2.0, 1.0)
    step = np.diff(poses)[k]
    theta = poses[k] + step * s**3 * (10 - 15 * s + 6 * s**2)
    velocity = step * 30 * s**2 * (1 - s) ** 2
    acceleration = step * 60 * s * (1 - s) * (1 - 2 * s)
    load = 12.0 * np.cos(theta) + acceleration  # torque of a weight and 1 kg.m2 [N.m]
    held = KNEE["motor.tau_coulomb"] * rng.uniform(-0.8, 0.8, 16)[k] * (t % 2.0 > 1.0)
    tau = _motor_torque(velocity, acceleration) + load / GEAR + held
    noise = 1e-3 * rng.standard_normal(len(t))
    q = theta - load / KNEE["spring.k_1"]
    return as_recorded({"t": t, "theta": theta, "q": q, "tau": tau + noise})
