"""The AwAS as its nominal data say it is, (28)-(30), along a recorded motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.master import Recording


def nominal(recording: Recording) -> dict[str, NDArray[np.float64]]:
    """Lever arm r [m], flexibility torque tau_e [N.m] and stiffness sigma [N.m/rad].

    The data are the parameters model.* of the estimator MODEL. The motion is phi and theta_c of
    the plant, as they are and not as the encoders see them: what MODEL finds is judged by it.
    """
    data = recording.estimators["MODEL"].parameters
    k_s, r_0, b = (float(data[f"model.{name}"]) for name in ("k_s", "r_0", "b"))
    phi = recording.plant["phi"]
    r = r_0 - b * recording.plant["theta_c"]  # (30)
    return {
        "r": r,
        "tau_e": k_s * r**2 * np.sin(2 * phi),  # (28)
        "sigma": 2 * k_s * r**2 * np.cos(2 * phi),  # (29)
    }
