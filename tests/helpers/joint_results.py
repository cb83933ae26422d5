"""Results of logs of a joint, made without an estimator: normal errors of known size."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta, timezone

import numpy as np

from sigmahat.health.logs import LogResult
from sigmahat.result.excitation import Excitation
from sigmahat.result.sheet import Prior, Together

START = datetime(2026, 3, 2, 8, tzinfo=timezone.utc)
PHI = (-0.008, -0.004, 0.0, 0.004, 0.008)  # [rad]
QUANTITIES = ("B", "D_theta", "tau_coulomb", "load_friction", "hysteresis", "lost_torque")
SCATTER = 0.01  # of stiffness and inertia from log to log, relative


@dataclass(frozen=True)
class TrueJoint:
    """What the estimates scatter around."""

    k: float = 400.0  # [N.m/rad]
    B: float = 1e-4  # [kg.m2]
    D_theta: float = 5e-4  # [N.m.s/rad]
    tau_coulomb: float = 0.03  # [N.m]
    load_friction: float = 0.08  # [1]
    gap: float = 0.0  # half width of the dead zone [rad]
    gain: float = 1.0  # torque that is read over the true one
    velocity: float = 1.0  # of the motion [rad/s]


def estimates(joint: TrueJoint, rng: np.random.Generator, prior_B: float = 1.0) -> Together:
    """Estimates of one log, and the covariance that belongs to their errors.

    prior_B  relative; 0: the inertia is taken as exact
    """
    of_gain = joint.gain * np.array([joint.k, joint.B, joint.D_theta, joint.tau_coulomb])
    relative = np.exp(rng.standard_normal(4) * (SCATTER, SCATTER, 0.02, 0.03))
    k, B, D_theta, tau_coulomb = (of_gain * relative).tolist()
    exact = prior_B == 0
    if exact:
        B = joint.B
    load = joint.load_friction * float(np.exp(0.05 * rng.standard_normal()))
    lost = k * joint.gap
    values = [*[k] * len(PHI), B, D_theta, tau_coulomb, load, 0.0, lost]
    stds = [SCATTER * k] * len(PHI)
    stds += [0.0 if exact else SCATTER * B, 0.02 * D_theta, 0.03 * tau_coulomb, 0.05 * load]
    stds += [0.0, 0.05 * lost]
    covariance = np.diag(np.square(stds))
    covariance[: len(PHI), : len(PHI)] = (SCATTER * k) ** 2  # one error of the whole curve
    return Together(
        phi=list(PHI),
        set_point=[0.0] * len(PHI),
        quantities=list(QUANTITIES),
        values=values,
        per_gain=[*values[:8], 0.0, 0.0, lost],
        covariance=covariance.tolist(),
        prior={
            "B": Prior(joint.B, prior_B * joint.B),
            "D_theta": Prior(joint.D_theta, joint.D_theta),
            "tau_coulomb": Prior(0.0, 1.0),
        },
    )


def logs(
    joints: Sequence[TrueJoint], seed: int, name: str = "knee", prior_B: float = 1.0
) -> list[LogResult]:
    """One log a day, of each joint in turn."""
    rng = np.random.default_rng(seed)
    return [
        LogResult(
            joint=name,
            time=START + timedelta(days=day),
            place=f"{name}/{day}",
            digests=[f"{name} {day}"],
            together=estimates(joint, rng, prior_B),
            excitation=Excitation(joint.velocity, 10 * joint.velocity, 5.0 * joint.gain),
            torque_gain=0.02,
            doubt="None",
        )
        for day, joint in enumerate(joints)
    ]


def changed(joint: TrueJoint, before: int, after: int, **changes: float) -> list[TrueJoint]:
    """A joint for some days, and with other values for the days after."""
    return [joint] * before + [replace(joint, **changes)] * after
