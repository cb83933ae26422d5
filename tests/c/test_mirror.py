"""A joint that moves in the other direction has the same stiffness."""

import numpy as np
import pytest

from c_library import Estimator, Library
from reference_joints import table1_recording


@pytest.mark.parametrize("method", [1, 2])
def test_a_mirrored_motion_has_mirrored_torques(c: Library, method: int) -> None:
    """All positions but that of the other motor, and all torques, with the other sign."""
    z = table1_recording().measurements()[:4000]
    mirror = np.array([-1.0, -1.0, 1.0, -1.0, -1.0])
    values = {"method": method, "rls.n": 3, "prior.B": 0.1}
    found, mirrored = (Estimator(c, values).run(each) for each in (z, mirror * z))
    assert np.array_equal(mirrored["sigma"], found["sigma"])
    for name in ("tau_e", "theta_dot", "phi", "epsilon"):
        assert np.array_equal(mirrored[name], -found[name]), name
