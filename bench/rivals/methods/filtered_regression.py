"""FilteredRegression of this package, with parameters as docs/filtered-regression.md advises.

What the data sheet says becomes ranges, priors and noise; all else keeps its start value.
"""

from __future__ import annotations

from rivals.records import Estimate, JointLog
from rivals.replayed import replayed
from rivals.spring import spring


def estimate(log: JointLog) -> Estimate:
    """The estimate on line: at each sample from those up to it."""
    known = log.known
    found, seconds = replayed(
        log,
        {
            "method": "FilteredRegression",
            "range.phi": known.range_phi,
            "range.setPoint": spring(log).range_theta_c,
            "prior.tau_e": known.range_tau_e,
            "prior.B": known.relative_std_B,
            "prior.D_theta": known.relative_std_D_theta,
            "prior.tau_coulomb": known.tau_coulomb,
            "prior.torque_gain": known.relative_std_gain,
        },
    )
    confident = found["confident"].astype(bool)
    return Estimate(found["sigma"], found["sigma_std"], confident, seconds)
