"""Data of a joint and its sensors, from a log or from a configuration alone."""

import numpy as np

from sigmahat.motion.design import NOISE, Sensors
from sigmahat.motion.joints_of_log import Joint, Limits, Ranges
from sigmahat.motor.noise import low_pass
from sigmahat.motor.signals import signals_of
from sigmahat.recording.configuration import Configuration
from sigmahat.recording.estimator_parameters import all_parameters
from sigmahat.recording.log import Log, LogError
from sigmahat.recording.sampling import sample
from sigmahat.result.curve import stiffness_in_the_middle
from sigmahat.result.estimate import Estimate, estimate

_COUNTS = 400_000.0  # counts per turn at the gear output, without a configuration
_PERIOD = 1e-3  # [s]
_WITHIN = 1.2  # values of a log are multiplied and divided by this factor
_LINK_BELOW = 20.0  # [Hz] motion of the link below this frequency is used


def sensors(configuration: Configuration | None, limits: Limits) -> Sensors:
    """The sensors of a configuration; missing values are assumed."""
    noise = NOISE * limits.torque
    if configuration is None:
        return Sensors(1.0, (_COUNTS, _COUNTS), 0.02, noise, _PERIOD)
    every = all_parameters(configuration)
    names = ("motor.gamma", "encoder.theta", "encoder.q", "prior.torque_gain", "samplePeriod")
    gamma, theta, q, gain, T = (float(every[name]) for name in names)
    if "noise.tau" in configuration.parameters:
        noise = abs(gamma) * float(every["noise.tau"])
    return Sensors(gamma, (theta, q), gain, noise, T or _PERIOD)


def of_log(log: Log, configuration: Configuration, start: float) -> Ranges:
    """The joint of a log: the stiffness within its interval, all other values within 20 %.

    start  position of the motor from which the next motion begins [rad]

    Raises LogError for a log that does not show stiffness and inertia of the link.
    """
    found = estimate(log, configuration)
    if not found.curve.branches:
        raise LogError(f"{log.path}: {found.headline}; omit --after, and give only the limits")
    _, sigma, interval = stiffness_in_the_middle(found.curve.branches[0])
    low, high = interval or (sigma, sigma)
    M, D_q, weight, angle = _link(log, configuration, found)
    if min(low, M) <= 0:
        raise LogError(
            f"{log.path}: expected a positive stiffness and link inertia, got {low:.3g} to "
            f"{high:.3g} N.m/rad and {M:.3g} kg.m2; run `sigmahat check`, or omit --after"
        )
    gamma = float(found.parameters["motor.gamma"])
    B, D_theta = gamma**2 * found.motor["B_hat"], gamma**2 * found.motor["D_theta_hat"]
    tau_coulomb = abs(gamma) * found.motor["tau_coulomb_hat"]
    values = M, D_q, weight, angle + start, max(B, 1e-9), D_theta, tau_coulomb
    least, most = (
        [each if i == 3 else max(each, 0.0) * factor for i, each in enumerate(values)]
        for factor in (1 / _WITHIN, _WITHIN)
    )
    return Ranges(Joint(low, *least), Joint(high, *most))


def _link(
    log: Log, configuration: Configuration, found: Estimate
) -> tuple[float, float, float, float]:
    """Fits inertia, friction, largest torque of the weight, and its angle at q = 0.

    The torque of the spring moves the link: M q'' + D_q q' + weight sin(q + angle) = -tau_e, (2).
    """
    T, setting = found.T, found.curve.branches[0].set_point
    rows, torques = [], []
    for piece in signals_of(sample(log, configuration, T), found.parameters):
        torque, _ = found.curve.polynomial.at(piece.phi, setting)
        below = min(_LINK_BELOW, 0.1 / T)
        q, torque = (low_pass(each, below, T) for each in (piece.theta + piece.phi, torque))
        velocity = np.gradient(q, T)
        rows.append(np.column_stack([np.gradient(velocity, T), velocity, np.sin(q), np.cos(q)]))
        torques.append(torque)
    if not rows:
        raise LogError(f"{log.path}: expected a longer part without a gap in the samples")
    X, y = np.concatenate(rows), -np.concatenate(torques)
    M, D_q, sine, cosine = np.linalg.lstsq(X, y, rcond=1e-9)[0].tolist()
    return M, D_q, float(np.hypot(sine, cosine)), float(np.arctan2(cosine, sine))
