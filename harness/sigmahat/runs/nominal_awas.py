"""The AwAS as its nominal data describe it, (28)-(30), along a recorded motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.master import Recording

MOTION = ("phi", "theta_c")
"""What has to be recorded of the plant."""
MODEL = "MODEL"
"""The estimator whose parameters model.* are the nominal data."""


def nominal_awas(recording: Recording) -> dict[str, NDArray[np.float64]]:
    """Lever arm r [m], flexibility torque tau_e [N.m] and stiffness sigma [N.m/rad].

    Each has the shape (N + 1,) of the recording. The motion is that of the plant itself and not as
    the encoders measure it, because the estimate of MODEL is compared with the result.
    """
    data = recording.estimators[MODEL].parameters
    k_s, r_0, b = (float(data[f"model.{name}"]) for name in ("k_s", "r_0", "b"))
    phi, theta_c = (recording.plant[name] for name in MOTION)
    r = r_0 - b * theta_c  # (30)
    return {
        "r": r,
        "tau_e": k_s * r**2 * np.sin(2 * phi),  # (28)
        "sigma": 2 * k_s * r**2 * np.cos(2 * phi),  # (29)
    }
