"""A million ticks in double agree with the same ticks in long double."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from c_library import LONG, Array, Estimator, Library, compile_library, load

T, COUNT, GAMMA = 1e-3, 2 * np.pi / 40000, 50.0
PIECES, PIECE = 10, 10_000  # of the input, which is then repeated
BOUND = 1e-9
OUTPUTS = (
    *("sigma", "tau_e", "sigma_std", "tau_e_residual", "theta_dot", "D_theta_hat", "B_hat"),
    "tau_coulomb_hat",
)


def pieces(torque: float) -> list[Array]:
    """Samples of an AwAS whose motor data are a little wrong [each size: PIECE x 5].

    torque  of one second in it, over the usual torque
    """
    rng, t = np.random.default_rng(1), T * np.arange(PIECES * PIECE)
    fast, slow, c = 2 * np.pi * 1.7137, 2 * np.pi * 0.31313, 60 * np.sin(2 * np.pi * 0.053113 * t)
    theta = 0.2 * np.sin(fast * t) + 0.5 * np.sin(slow * t)
    v = 0.2 * fast * np.cos(fast * t) + 0.5 * slow * np.cos(slow * t)
    a = -0.2 * fast**2 * np.sin(fast * t) - 0.5 * slow**2 * np.sin(slow * t)
    phi = 0.09 * np.sin(2 * np.pi * 0.7713 * t) + 0.06 * np.sin(2 * np.pi * 2.2917 * t)
    tau_e = 14220 * (0.1 - 0.0025 / (2 * np.pi) * c) ** 2 * np.sin(2 * phi)
    tau = GAMMA * (2.3e-5 * a + 1.1e-3 * v) + 0.02 * np.sign(v) - tau_e / GAMMA
    z = np.column_stack([theta, theta + phi, c, tau, tau_e])
    z[:, :3] = np.round(z[:, :3] / COUNT) * COUNT
    z[:, 3:] += rng.uniform(-1, 1, (len(t), 2)) * (5e-3, 5e-2)
    z[40000:50000] = z[39999]  # rest
    z[50000:60000, 0] = np.clip(z[50000:60000, 0], -0.25, 0.25)  # the encoder saturates
    z[60000:61000, 3:] *= torque
    z[80000:82000:100, 1] = np.nan  # samples are lost, and a second of them
    z[82000:83000, 3] = np.inf
    return np.split(z, PIECES)


def positive(e: Estimator) -> bool:
    """Whether covariance or information, of which D is a factor, is positive definite."""
    method = e.state.method
    parts = [method.regression.posterior.information, method.regression.data]
    if e.parameters.method == 1:
        parts = [method.paper2011.rls.P]
    return all(np.min(np.array(list(each.D)[: each.size], np.longdouble)) > 0 for each in parts)


def outputs(c: Library, method: int, n: int, m: int, torque: float) -> Array:
    """OUTPUTS after each piece of a million ticks; every output of every tick is finite."""
    values = {"method": method, "rls.n": n, "rls.m": m, "regression.drift": 1e-3, "prior.B": 0.1}
    e, found, given = Estimator(c, values), [], pieces(torque)
    for k in range(10 * PIECES):
        c.set(e.parameters, "modality", 1 + k % 3 if k % PIECES == 7 else 1)
        record = e.run(given[k % PIECES])
        names = (name for name in record.dtype.names or () if name != "change_age")
        assert all(np.all(np.isfinite(record[name])) for name in names)
        assert positive(e)
        found.append([record[name][-1] for name in OUTPUTS])
    return np.array(found)


@pytest.mark.skipif(np.finfo(np.longdouble).eps > 1e-18, reason="long double is double here")
@pytest.mark.slow("a million ticks, in double and in the slower long double")
@pytest.mark.parametrize("case", [(1, 6, 3, 1e6), (2, 3, 3, 1e3)])
def test_a_million_ticks_agree_with_those_in_long_double(
    case: tuple[int, int, int, float], build: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    long = compile_library(tmp_path_factory.getbasetemp(), LONG)
    found, reference = outputs(load(build), *case), outputs(long, *case)
    size = np.maximum(np.abs(reference), np.median(np.abs(reference), axis=0))
    sigma, std = OUTPUTS.index("sigma"), OUTPUTS.index("sigma_std")
    size[:, sigma] = np.maximum(size[:, sigma], reference[:, std])  # after the torque times 1000
    difference = np.abs(found - reference) / np.where(size > 0, size, 1)
    assert dict(zip(OUTPUTS, difference.max(axis=0), strict=True)) == pytest.approx(
        dict.fromkeys(OUTPUTS, 0), abs=BOUND
    )
