"""The methods that are compared, by name: each has a file of its own, with its source."""

from __future__ import annotations

from collections.abc import Callable

from rivals.methods import (
    filtered_regression,
    idim_iv,
    kalman,
    least_squares,
    mujoco_sysid,
    paper2011,
)
from rivals.records import Estimate, JointLog

METHODS: dict[str, Callable[[JointLog], Estimate]] = {
    "FilteredRegression": filtered_regression.estimate,
    "Paper2011": paper2011.estimate,
    "least_squares": least_squares.estimate,
    "idim_iv": idim_iv.estimate,
    "kalman": kalman.estimate,
    "mujoco_sysid": mujoco_sysid.estimate,
}
