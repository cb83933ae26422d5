"""The residual, (6)-(8), after lost samples.

test_stiffness_estimator.py compares it with that of the oracle in every tick.
"""

import pytest

from c_library import Library

GAMMA, T, K_I = 50.0, 1e-4, 200.0


def test_after_lost_samples_the_residual_continues_from_its_last_value(c: Library) -> None:
    # GIVEN a settled residual WHEN samples were lost and it is resumed
    # THEN it keeps its value, also in the next step under the same load
    motor = c.new("sh_motor_parameters", B=2.3e-5, D_theta=1e-3, gamma=GAMMA)
    residual = c.new("sh_torque_residual")
    step = c.lib.sh_torque_residual_step
    c.lib.sh_torque_residual_start(residual, 0.2)
    for _ in range(2000):
        step(residual, motor, 0.0, 0.0, 0.2, K_I, T)
    before = residual.r_e
    c.lib.sh_torque_residual_resume(residual, 0.2)
    assert residual.r_e == before
    assert step(residual, motor, 0.0, 0.0, 0.2, K_I, T) == pytest.approx(GAMMA * before, rel=1e-6)
