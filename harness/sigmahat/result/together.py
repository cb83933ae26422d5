"""Takes the estimates of an estimator with their covariance, for a comparison with other logs."""

from collections.abc import Sequence

import numpy as np

from sigmahat.estimator.estimator import Estimator
from sigmahat.estimator.instances import QUANTITIES
from sigmahat.result.curve_of_log import Reach
from sigmahat.result.sheet import Prior, Together

_PLACES = (0.1, 0.3, 0.5, 0.7, 0.9)
"""Places of the points in the range of the deformation: at its ends the curve is hardly known."""


def together(estimator: Estimator, reaches: Sequence[Reach]) -> Together | None:
    """Returns the stiffness in the range of the data, and motor data and effects.

    estimator  for one joint
    reaches    range of the deformation at each set-point

    Returns None for a method that claims no uncertainty, and without data.
    """
    at = np.array([(_place(each, x), each.set_point) for each in reaches for x in _PLACES])
    found = estimator.covariance(at[:, 0], at[:, 1]) if len(at) else None
    if found is None:
        return None
    (p,) = estimator.parameters
    points = estimator.evaluate(at[:, 0], at[:, 1])
    covariance, count = found.covariance.copy(), len(at)
    # The regression does not know errors of the deformation and of the place of a knee.
    gain = float(p["prior.torque_gain"]) * found.per_gain[:count]
    whole = points["sigma_std"] ** 2 - gain**2
    diagonal = np.arange(count)
    covariance[diagonal, diagonal] = np.maximum(whole, np.diag(covariance)[:count])
    motor = {name: float(p[f"motor.{name}"]) for name in ("B", "D_theta")}
    prior = {name: Prior(mean, mean * float(p[f"prior.{name}"])) for name, mean in motor.items()}
    prior["tau_coulomb"] = Prior(0.0, float(p["prior.tau_coulomb"]))
    return Together(
        phi=at[:, 0].tolist(),
        set_point=at[:, 1].tolist(),
        quantities=list(QUANTITIES),
        values=found.values.tolist(),
        per_gain=found.per_gain.tolist(),
        covariance=covariance.tolist(),
        prior=prior,
    )


def _place(reach: Reach, place: float) -> float:
    low, high = reach.phi
    return low + place * (high - low)
