"""From clean signals to a log: encoders, torque as it is logged, what the owner knows."""

from __future__ import annotations

import numpy as np

from rivals.joints.parameters import Joint
from rivals.joints.simulation import SAMPLE_PERIOD, Run, rounded
from rivals.records import Array, JointLog, Known

STD_B = 0.05
STD_D = 0.2
STD_GAIN = 0.015
"""Relative standard deviations of the data sheets, as drawn, and as the methods are given them."""


def log(kind: str, seed: int, run: Run, joint: Joint, rng: np.random.Generator) -> JointLog:
    """The log of a run of a joint; `rng` draws the noise."""
    instruments = joint.instruments[joint.observed]
    theta, phi = run.signals["theta"], run.signals["phi"]
    torque = run.command if instruments.commanded else run.late
    noise = instruments.noise * rng.standard_normal(len(theta))
    return JointLog(
        kind=kind,
        seed=seed,
        sample_period=SAMPLE_PERIOD,
        theta=rounded(theta, instruments.counts_theta),
        q=rounded(theta + phi, instruments.counts_q),
        tau=instruments.gain * torque + noise,
        theta_c=run.signals["theta_c"],
        tau_e=run.signals["tau_e"],
        stiffness=run.signals["stiffness"],
        known=_known(joint, phi, run.signals["tau_e"]),
    )


def _known(joint: Joint, phi: Array, tau_e: Array) -> Known:
    sheet, i = joint.sheet, joint.observed
    motor, instruments = joint.motors[i], joint.instruments[i]
    return Known(
        gamma=motor.gear,
        B=sheet.B * motor.B,
        D_theta=sheet.D * motor.D,
        relative_std_B=STD_B,
        relative_std_D_theta=STD_D,
        relative_std_gain=STD_GAIN,
        tau_coulomb=sheet.coulomb * motor.friction.at_rest,
        noise_tau=instruments.noise,
        counts_theta=instruments.counts_theta,
        counts_q=instruments.counts_q,
        range_phi=sheet.phi * float(np.abs(phi).max()),
        range_tau_e=sheet.tau_e * float(np.abs(tau_e).max()),
    )
