"""noise.c: the variance of a row, and the false information in its columns."""

from typing import Any

import pytest

from c_library import Library
from c_parts import RESIDUAL, SENSOR, columns, estimate, posterior_of_prior

SIGMA = 100.0  # [N.m/rad]
SQUARE = 12e-4  # of the counts of both encoders: rounding of phi has the variance 1e-4 rad2
ROUNDING = 1.0  # variance of the torque by this rounding, SIGMA^2 1e-4 [(N.m)2]


def noise(c: Library, signals: Any, friction: float, values: dict[str, float]) -> Any:
    """The `sh_row_noise` of a row, with the stiffness SIGMA."""
    feedback = c.new("sh_feedback", sigma=SIGMA)
    return c.lib.sh_noise_of_row(signals, feedback, friction, c.parameters(values))


def test_white_noise_is_averaged_over_the_samples_of_a_row(c: Library) -> None:
    """In motion: R = (1 + 0.5^2) / K, by rounding and by the sensor; K = 5 samples."""
    signals = c.new("sh_signals", count_q=SQUARE**0.5, decimation=5)
    found = noise(c, signals, 0.0, {"modality": SENSOR, "noise.tau_e": 0.5})
    assert (found.R, found.lasting) == pytest.approx((0.25, 1.0))


def test_at_rest_rounding_is_always_the_same(c: Library) -> None:
    """R_n = R (1 + c n / R)^2, with R = 1 + 1, c = 1, and n = 6 samples at rest: 2 * 16."""
    signals = c.new("sh_signals", count=SQUARE**0.5, decimation=1, history={"resting": 6.0})
    found = noise(c, signals, 0.0, {"modality": SENSOR, "noise.tau_e": 1.0})
    assert (found.R, found.lasting) == pytest.approx((32.0, 16.0))


MOTOR = {"modality": RESIDUAL, "motor.gamma": 2.0, "motor.B": 0.25, "noise.tau": 0.5}
"""gamma s_tau = 1 N.m, and gamma^2 B = 1 kg.m2."""


def with_motor(c: Library, rough: float) -> Any:
    """G_0 and G are 1/4. Friction of one sample is divided by 3/16 w T = 1."""
    return c.new(
        "sh_signals",
        **{"count_q": SQUARE**0.5, "decimation": 1, "gain": 0.25, "gain_second": 0.25},
        **{"design": {"w": 16.0, "T": 1 / 3}, "history": {"rough": rough, "unsure": 2.0}},
    )


def test_noise_beyond_rounding_counts_by_three_tenths(c: Library) -> None:
    """Noise of theta doubles the noise behind the filter, X = 2: (1 + 1) (1 + 0.3) = 2.6. The
    torque has 0.25 of the 0.5 behind the filter."""
    found = noise(c, with_motor(c, 1.0), 0.0, MOTOR)
    assert (found.R, found.torque, found.share) == pytest.approx((2.6, 0.25, 0.5))


def test_friction_of_unknown_sign_adds_to_the_variance(c: Library) -> None:
    """R = 2 + 0.75, and the sign is unknown for 2 samples: the factor is (1 + 2 * 0.75 / 2.75)^2.
    The torque has 0.25 of the 0.25 + 0.75 behind the filter."""
    found = noise(c, with_motor(c, 0.0), 0.75, MOTOR)
    assert (found.R, found.lasting) == pytest.approx((4.25**2 / 2.75, (4.25 / 2.75) ** 2))
    assert (found.friction, found.share) == (0.75, 0.25)


def test_the_variance_of_friction_is_its_square_and_its_own_variance(c: Library) -> None:
    """(gamma prior u_f)^2 (beta^2 + P) = (2 * 3 * 0.5)^2 (2^2 + 1/4). The posterior has the
    information 1 of the prior and 3 of a sample."""
    signals, at = c.new("sh_signals"), c.lib.SH_FILTER_UNKNOWN
    signals.filters.input[at], signals.filters.behind[2][at] = 0.75, 0.25
    dry, posterior = columns(c, {"COULOMB": 3.0}), posterior_of_prior(c, 1)
    c.lib.sh_posterior_take(posterior, [1.0, 0.0, 8 / 3], 1, 3.0)
    beta, _ = estimate(c, posterior, 1)
    p = c.parameters({"motor.gamma": 2.0, "prior.tau_coulomb": 3.0})
    found = c.lib.sh_noise_of_friction(signals, dry, posterior, beta, p)
    assert found == pytest.approx(9.0 * 4.25)
    c.set(p, "modality", SENSOR)
    assert c.lib.sh_noise_of_friction(signals, dry, posterior, beta, p) == 0.0


def test_rounding_is_false_information(c: Library) -> None:
    """About sigma: G_0 (count^2 + count_q^2) / 12 = 2 (12 + 24) / 12. About b:
    (gamma^2 B prior.B)^2 G V = (4 * 3 * 0.5)^2 2 V, and V = 1 + 0.056 * 0.5 * 12 / 12, as the motor
    moves with half of the samples."""
    signals = c.new("sh_signals", gain=2.0, gain_second=2.0, count=12**0.5, count_q=24**0.5)
    assert c.lib.sh_noise_of_deformation(signals) == pytest.approx(6.0)
    row = c.new("sh_row", rough=1.0, moved=0.5)
    p = c.parameters({"motor.gamma": 2.0, "motor.B": 3.0, "prior.B": 0.5})
    assert c.lib.sh_noise_of_inertia(signals, row, p) == pytest.approx(36.0 * 2.0 * 1.028)
