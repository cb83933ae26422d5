"""Section 14 of FilteredRegression: one bad sample is harmless, and legitimate jumps pass."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from c_library import Array, Estimator, Library
from regression_joint import SETTINGS, Joint, MisfitJoint, T

REGRESSION = {"method": 2, "rls.n": 3, "prior.B": 0.05}
OUTLIER = 11
THETA, Q, TAU = 0, 1, 3
AT = 4.0  # [s]
KINDS = {"torque": TAU, "link": Q, "motor": THETA}


def spoilt(joint: Joint, signal: int, size: float, samples: int, begin: int) -> Array:
    """Measurements with an error: of a torque in units of its rms."""
    z = joint.measurements()
    size *= np.sqrt(np.mean(z[:, TAU] ** 2)) if signal == TAU else 1.0
    z[begin : begin + samples, signal] += size
    return z


def wrong(found: NDArray[np.void], joint: Joint) -> NDArray[np.bool_]:
    error = np.abs(found["sigma"] - joint.sigma)
    surely = (error > 0.05 * joint.sigma) & (error > 3 * found["sigma_std"])
    return np.asarray(found["confident"].astype(bool) & surely)


@pytest.mark.parametrize("samples", [1, 50])
@pytest.mark.parametrize(
    ("kind", "size"),
    [
        *(("torque", size) for size in (30.0, -300.0, 3e6)),
        *((kind, size) for kind in ("link", "motor") for size in (0.01, -0.1, 1e3)),
    ],
)
def test_bad_samples_are_harmless(c: Library, kind: str, size: float, samples: int) -> None:
    """GIVEN an error at any of three times, THEN `valid` and `doubt` tell it while it lasts, no
    estimate is confident and wrong, and the estimate is back 0.2 s later."""
    for seed, begin in ((1, 4000), (2, 3011), (3, 5777)):
        joint = Joint(duration=7.0, seed=seed, tau_coulomb=0.01, frequency=0.3 * seed)
        z = spoilt(joint, KINDS[kind], size, samples, begin)
        clean, found = (Estimator(c, REGRESSION).run(x) for x in (joint.measurements(), z))
        bad = found["valid"] == 0
        assert np.all(bad[begin : begin + min(samples, 20)])
        assert not np.any(bad[:begin]) and not np.any(bad[begin + 120 :])
        assert np.all(found["doubt"][bad] == OUTLIER) and not np.any(found["confident"][bad])
        assert not np.any(found["doubt"][~bad] == OUTLIER)
        assert not np.any(wrong(found, joint))
        later = slice(begin + 200, None)
        assert np.max(np.abs(found["sigma"] / joint.sigma - 1)[later]) < 0.05
        assert np.mean(found["confident"][later]) > 0.98 * np.mean(clean["confident"][later])


def test_a_bad_first_sample_is_forgotten(c: Library) -> None:
    joint = Joint(duration=3.0, tau_coulomb=0.01)
    z = joint.measurements()
    z[0, TAU] = 30.0
    found = Estimator(c, REGRESSION).run(z)
    assert np.flatnonzero(found["valid"] == 0).tolist() == list(range(1, 120))
    assert abs(found["sigma"][-1] / joint.sigma[-1] - 1) < 0.02


@pytest.mark.parametrize("decimated", [1, 10])
def test_a_level_that_persists_is_accepted_within_0_2_s(c: Library, decimated: int) -> None:
    """GIVEN a load that hangs on the link from one sample on, in a log at 1 kHz or 100 Hz."""
    joint = MisfitJoint(duration=8.0)
    z = joint.measurements()
    later = joint.t >= AT
    z[later, Q] -= 0.05
    z[later, TAU] += 140.0 * 0.05 / 50.0
    values = {**SETTINGS, "samplePeriod": T * decimated, "regression.bandwidth": 100.0}
    found = Estimator(c, values).run(z[::decimated])
    refused = np.flatnonzero(found["valid"] == 0) * T * decimated
    assert refused[0] >= AT and refused[-1] < AT + 0.2
    assert found["confident"][-1] and abs(found["sigma"][-1] / joint.sigma[-1] - 1) < 0.05


@pytest.mark.parametrize("tails", [2.0, 3.0])
def test_noise_with_heavy_tails_passes(c: Library, tails: float) -> None:
    joint = replace(MisfitJoint(), noise=0.0)
    z = joint.measurements()
    z[:, TAU] += 2e-3 * np.random.default_rng(1).standard_t(tails, size=len(z))
    found = Estimator(c, SETTINGS).run(z)
    assert np.count_nonzero(found["valid"] == 0) <= 3


@pytest.mark.parametrize("held", [4, 10])
def test_samples_that_are_repeated_pass(c: Library, held: int) -> None:
    z = MisfitJoint().measurements()
    z = z[np.arange(len(z)) // held * held]
    assert np.all(Estimator(c, SETTINGS).run(z)["valid"])


def test_motion_after_a_long_rest_passes(c: Library) -> None:
    """GIVEN a minute at rest, without noise: the largest innovation of late is 0."""
    z = MisfitJoint(duration=4.0).measurements()
    rest = z[:1].repeat(60_000, 0)
    rest[:, TAU] = 0.0
    estimator = Estimator(c, SETTINGS)
    assert estimator.repeat(rest, len(rest)) == len(rest)
    assert np.all(estimator.run(z)["valid"])


def test_the_gate_begins_anew_after_lost_samples(c: Library) -> None:
    """GIVEN a log that goes on elsewhere after a lost sample, THEN it is accepted at once."""
    z = MisfitJoint(duration=4.0).measurements()
    z[2000] = np.nan
    z[2001:, (THETA, Q)] += 5.0
    found = Estimator(c, SETTINGS).run(z)
    assert np.flatnonzero(found["valid"] == 0).tolist() == [2000]


def test_paper2011_has_no_gate(c: Library) -> None:
    z = spoilt(Joint(duration=2.0), TAU, 300.0, 1, 1000)
    assert np.all(Estimator(c, {"method": 1}).run(z)["valid"])
