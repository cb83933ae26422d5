"""Slow motion with a noisy torque: noise is not learned as friction, and the interval holds.

The bound is the posterior of a regression with the same columns without noise (Cramer and Rao, with
priors van Trees): no estimator can know the stiffness better from these data. There is no
column of the delay: it contains the derivative of the noise, which is not removed.
"""

import numpy as np
import pytest
from numpy.typing import NDArray

from c_library import Array, Estimator, Library
from dense_regression import START
from dense_signals import GROUPS, Filtered, Inputs
from plant_runs import run_awas, times
from recorded_logs import COLUMNS, RETRACTED, T

TRUE = ("theta", "q", "theta_c", "tau", "tau_e", "sigma")
MEASURED = tuple(COLUMNS.values())
PRIORS = {
    **{**START, "prior.B": 0.0, "prior.torque_gain": 0.0, "prior.damping": 4e-3},
    **{"prior.load_friction": 0.05, "prior.eccentric": 3e-4, "prior.delay": 0.0},
}


def bound(c: Library, p: dict[str, float], run: dict[str, Array], at: NDArray[np.intp]) -> Array:
    """Least standard deviation of the stiffness at samples `at`, after all data [N.m/rad]."""
    z = np.column_stack([run[name] for name in TRUE[:5]])
    everything = slice(0, len(z))
    inputs = Inputs(p, z, [everything], None)
    filtered = Filtered(c, p, inputs, z, everything, False)
    kinds = [kind for kind, _, _ in inputs.columns]
    load = -p["prior.load_friction"] * np.abs(run["tau_e"]) * filtered.sign
    filtered.rows[:, kinds.index("LOAD")] = filtered.filtered(np.append(load[1:], 0.0), 0, True)
    filtered.rows[:, kinds.index("DRIVE")] *= np.abs(filtered.sides[:, 0])
    used = [i for i, kind in enumerate(kinds) if GROUPS.get(kind, 0) == 0]
    x = filtered.rows[:, used] / (p["motor.gamma"] * p["noise.tau"])
    P = np.linalg.inv(np.eye(len(used)) + x.T @ x)
    dF = inputs.dF[at][:, used]
    std: Array = np.sqrt(np.einsum("ij,jk,ik->i", dF, P, dF))
    return std


def slow_run(frequency: float, coulomb: float, noise: float, seed: int) -> dict[str, Array]:
    """40 s of the AwAS, the noise of the torque so many times the noise of the paper."""
    t = times(T, 40.0)
    torques = [0.3 * np.sin(2 * np.pi * frequency * t), 8 * np.sin(0.2 * np.pi * t), 0 * t]
    start = {**RETRACTED, "motor.tau_coulomb": coulomb, "noise.seed": seed}
    start["noise.tau_variance"] = 1e-5 * noise**2
    return run_awas(T, np.column_stack(torques), start, {*MEASURED, *TRUE})


@pytest.mark.slow("a run of 40 s is simulated and estimated")
@pytest.mark.parametrize(
    ("frequency", "coulomb", "noise"),
    [(0.1, 0.0, 1.0), (0.2, 0.02, 1.0), (0.1, 0.02, 5.0), (0.2, 0.0, 5.0)],
)
def test_noise_is_not_friction(c: Library, frequency: float, coulomb: float, noise: float) -> None:
    p = {**PRIORS, "noise.tau": 3.2e-3 * noise}
    run = slow_run(frequency, coulomb, noise, seed=9)
    found = Estimator(c, p).run(np.column_stack([run[name] for name in MEASURED]))
    late = np.arange(2000, len(run["sigma"]))
    inside = np.abs(found["sigma"] - run["sigma"]) <= 1.96 * found["sigma_std"]
    assert np.mean(inside[late]) >= 0.9
    last = np.arange(len(run["sigma"]) - 10000, len(run["sigma"]), 100)
    ratio = np.mean(found["sigma_std"][last] / bound(c, p, run, last))
    assert 1 <= ratio <= (6 if noise < 2 else 2)
    assert abs(found["load_friction_hat"][-1]) <= 0.1
