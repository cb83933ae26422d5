"""Messages of a joint that moves a load, as a robot would send them, and their configuration."""

from __future__ import annotations

import socket

import numpy as np

T = 0.002
COUNTS, GEAR = 4096, 20

CONFIGURATION = f"""\
[time]
column = "t"
[ports.theta]
column = "arm/motor"
unit = "counts"
counts_per_turn = {COUNTS}
gear_ratio = {GEAR}
wrap = {COUNTS}
[ports.q]
column = "arm/link[0]"
unit = "deg"
sign = -1
zero = 2.5
[ports.tau]
column = "arm/torque"
[parameters]
method = "FilteredRegression"
samplePeriod = {T}
motor.gamma = {GEAR}
motor.B = 1e-3
motor.D_theta = 1e-2
range.phi = 0.06
prior.tau_e = 30
"""


def messages(samples: int, seed: int = 1) -> list[dict[str, float | int]]:
    """Of a joint with 400 N.m/rad that moves a load, at T."""
    noise = np.random.default_rng(seed)
    t = T * np.arange(samples)
    theta = 0.8 * np.sin(3 * t) + 0.2 * np.sin(11 * t)
    q = theta + 0.03 * np.sin(5 * t) + 0.02 * np.sin(13 * t)
    counts = np.round(theta * GEAR * COUNTS / (2 * np.pi)) % COUNTS
    speed = 2.4 * np.cos(3 * t) + 2.2 * np.cos(11 * t)
    acceleration = -7.2 * np.sin(3 * t) - 24.2 * np.sin(11 * t)
    torque = GEAR * (1e-3 * acceleration + 1e-2 * speed) + 400 * (theta - q) / GEAR
    torque += noise.normal(0, 3e-3, samples)
    names = ("t", "arm/motor", "arm/link[0]", "arm/torque")
    rows = np.column_stack([t, counts, 2.5 - np.degrees(q), torque]).tolist()
    return [dict(zip(names, row, strict=True)) for row in rows]


def free_port() -> int:
    """A port of this computer that nobody uses."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])
