"""The residual, (6)-(8), against closed forms and simple motions."""

from __future__ import annotations

import numpy as np
import pytest

import oracle
from c_library import Array, Library

B, D_THETA, GAMMA = 2.3e-5, 1e-3, 50.0
T, K_I = 1e-4, 200.0


def run(
    c: Library, theta: Array, theta_dot: Array, tau: Array, T: float = T, K_I: float = K_I
) -> Array:
    """gamma r_e at every sample [size: samples]."""
    motor = c.new("sh_motor_parameters", B=B, D_theta=D_THETA, gamma=GAMMA)
    residual = c.new("sh_torque_residual", r_e=5.0)
    c.lib.sh_torque_residual_start(residual, tau[0])
    estimate = [0.0]
    for k in range(1, len(theta)):
        estimate.append(
            c.lib.sh_torque_residual_step(
                residual,
                motor,
                theta[k] - theta[k - 1],
                theta_dot[k] - theta_dot[k - 1],
                tau[k],
                K_I,
                T,
            )
        )
    assert residual.r_e * GAMMA == estimate[-1]
    return np.array(estimate)


def test_after_lost_samples_the_residual_continues_from_its_last_value(c: Library) -> None:
    # GIVEN a settled residual WHEN samples were lost and it is resumed
    # THEN it keeps its value, also in the next step under the same load
    motor = c.new("sh_motor_parameters", B=B, D_theta=D_THETA, gamma=GAMMA)
    residual = c.new("sh_torque_residual")
    step = c.lib.sh_torque_residual_step
    c.lib.sh_torque_residual_start(residual, 0.2)
    for _ in range(2000):
        step(residual, motor, 0.0, 0.0, 0.2, K_I, T)
    before = residual.r_e
    c.lib.sh_torque_residual_resume(residual, 0.2)
    assert residual.r_e == before
    assert step(residual, motor, 0.0, 0.0, 0.2, K_I, T) == pytest.approx(GAMMA * before, rel=1e-6)


@pytest.mark.parametrize(("T", "K_I"), [(1e-3, 300.0), (1e-4, 10.0), (1e-2, 199.0)])
def test_against_the_printed_form(c: Library, T: float, K_I: float) -> None:
    # (8) with I_tau and r(k) as printed, against the C code, which computes it in differences
    rng = np.random.default_rng(2)
    theta, theta_dot, tau = rng.normal(size=(3, 1000))
    p = {**oracle.DEFAULTS, "samplePeriod": T, "residual.K_I": K_I}
    want = oracle.residual_torque(p, oracle.exact(theta), oracle.exact(theta_dot), tau)
    got = run(c, theta, theta_dot, tau, T=T, K_I=K_I)
    assert oracle.relative_error(got, oracle.rounded(want)) < 1e-9
