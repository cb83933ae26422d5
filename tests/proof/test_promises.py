"""Numerical promises of an estimator as a whole: docs/proof/promises.md."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from c_library import Array, Estimator, Library, diagonal
from edges import c, measurements, often, parameters

__all__ = ["c"]  # a fixture

PAPER2011, REGRESSION = 1, 2
OUTLIER = 11


def check_outputs(record: NDArray[np.void], largest_a: float, confidence: float) -> None:
    """The bounds of the outputs of every tick."""
    for name in record.dtype.names or ():
        if name in ("sigma_std", "tau_e_std"):  # infinite if their squares overflow, never NaN
            assert np.all(record[name] >= 0), name
        else:
            assert np.all(np.isfinite(record[name])), name
    assert np.all(record["rho"] >= 0)
    assert np.all((record["a"] >= 0) & (record["a"] <= largest_a))
    assert np.all(record["misfit"] >= 1)
    sure = record[record["confident"] == 1]
    assert np.all(sure["sigma_std"] < confidence * np.abs(sure["sigma"]))
    assert np.all(sure["sigma"] >= 0)


def check_skipped(before: NDArray[np.void], record: NDArray[np.void]) -> None:
    """A skipped tick changes no output but `valid`, and those that tell an outlier."""
    every = np.concatenate([before, record])
    every["valid"] = 0
    for k in np.flatnonzero(record["valid"] == 0):
        kept = every[k : k + 1].copy()
        if every["doubt"][k + 1] == OUTLIER:
            kept["doubt"], kept["confident"] = OUTLIER, 0
        assert kept.tobytes() == every[k + 1].tobytes()


def check_paper2011(state: Any, P_0: float) -> None:
    rls, filters = state.method.paper2011.rls, state.method.paper2011.filters
    D = diagonal(rls.P)
    assert np.all((D >= 0) & (D <= P_0))
    assert all(map(math.isfinite, (*rls.eta, *rls.eta_low, *rls.P.U)))
    for axis in (filters.theta, filters.q):
        assert min(axis.P11, axis.P12, axis.P22) >= 0
        assert all(map(math.isfinite, (axis.lag, axis.x_dot, axis.P11, axis.P12, axis.P22)))
    assert math.isfinite(filters.residual.r_e)


def check_gap(estimator: Estimator, data: st.DataObject) -> None:
    """Samples that are skipped change nothing in the state but their number."""
    before, skipped = estimator.lasting(), estimator.state.skipped
    bad: Array = np.zeros((3, 5))
    bad[:, data.draw(st.integers(0, 4))] = data.draw(
        st.sampled_from([math.nan, math.inf, -math.inf, 2e12])
    )
    assert estimator.repeat(bad, 3) == 0
    assert estimator.state.skipped == skipped + 3
    estimator.state.skipped = skipped
    assert estimator.lasting() == before


def informations(state: Any) -> Iterator[tuple[Any, float]]:
    """The factors of the information, each with a bound that no entry of D may go below."""
    regression = state.method.regression
    for posterior in (regression.posterior, regression.refit.posterior):
        yield posterior.information, 1.0
    for data in (regression.samples.data, regression.bank.constant, regression.bank.friction):
        yield data, 0.0  # process noise may reduce it below what it began with


def check_regression(state: Any) -> None:
    regression = state.method.regression
    for a, least in informations(state):
        used = a.size * (a.size - 1) // 2 + 2 * a.size
        D, U = np.array(list(a.D)[: a.size]), np.array(list(a.U)[:used])
        assert np.all(np.isfinite(D) & (D > 0) & (least <= D))
        assert np.all(np.isfinite(U))
        assert math.isfinite(a.squares)
    feedback = regression.feedback
    numbers = (feedback.sigma, feedback.y, feedback.delay)
    assert all(map(math.isfinite, (*numbers, *regression.coefficients.beta, *regression.block.sum)))
    for posterior in (regression.posterior, regression.refit.posterior):
        assert 0 < posterior.weight <= 1
        for number in (posterior.removed, posterior.spread, posterior.surplus):
            assert 0 <= number < math.inf
    assert 1 <= regression.misfit.variance_factor < math.inf
    assert 0 <= regression.misfit.square < math.inf
    assert abs(regression.signals.motion.direction) <= 1


@often
@given(data=st.data())
@pytest.mark.parametrize("method", [PAPER2011, REGRESSION])
def test_every_output_and_the_state_stay_in_their_bounds(
    c: Library, method: int, data: st.DataObject
) -> None:
    values, z = data.draw(parameters(method, c.real)), data.draw(measurements())
    estimator = Estimator(c, values)
    p = estimator.parameters
    for part in np.array_split(z, 3):
        before = np.frombuffer(c.ffi.buffer(estimator.estimate), c.dtype("sh_estimate")).copy()
        record = estimator.run(part)
        check_outputs(np.concatenate([before, record]), max(1.0, p.rls.c), p.limit.relative_std)
        check_skipped(before, record)
        if method == PAPER2011:
            check_paper2011(estimator.state, p.rls.P_0)
        else:
            check_regression(estimator.state)
    check_gap(estimator, data)


@often
@given(data=st.data())
def test_filtered_regression_takes_samples_again_after_any_others(
    c: Library, data: st.DataObject
) -> None:
    gentle = np.zeros((20, 5))
    gentle[:, :2] = 0.01 * np.sin(0.1 * np.arange(20))[:, None] * [1.0, 1.1]
    values, z = data.draw(parameters(REGRESSION, c.real)), data.draw(measurements())
    fresh, used = Estimator(c, values), Estimator(c, values)
    used.run(z)
    used.run(np.full((1, 5), math.nan))  # no sample is an outlier of those before a gap
    assert used.repeat(gentle, 20) > 0 or fresh.repeat(gentle, 20) == 0
