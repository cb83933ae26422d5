"""A million ticks in double agree with the same ticks in long double."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from c_library import LONG, Array, Estimator, Library, compile_library, load
from regression_joint import Joint, T

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
    joint = Joint(frequency=0.7713, deformation=0.1, D_theta=1.1e-3, tau_coulomb=0.02)
    z = replace(joint, duration=T * (PIECES * PIECE - 1)).measurements()
    z[40000:50000] = z[39999]  # rest
    z[50000:60000, 0] = np.clip(z[50000:60000, 0], 0.3, 1.3)  # the encoder saturates
    z[60000:61000, 3:] *= torque
    z[80000:82000:100, 1] = np.nan  # samples are lost, and a second of them
    z[82000:83000, 3] = np.inf
    return np.split(z, PIECES)


def positive(e: Estimator) -> bool:
    """Whether covariance or information, of which D is a factor, is positive definite."""
    method = e.state.method
    parts = [method.regression.posterior.information, method.regression.samples.data]
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
@pytest.mark.complete
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
