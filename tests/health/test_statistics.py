"""The statistics of `health`, against closed forms, scipy, and dense algebra."""

import math
from dataclasses import replace
from datetime import timedelta

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import chi2, norm, ttest_ind
from scipy.stats import t as student_t

from health.false_alarms import largest_z
from joint_results import TrueJoint, estimates
from sigmahat.health import threshold
from sigmahat.health.change import Kind, Series, largest_change, largest_episode, segments
from sigmahat.health.own import own_estimates
from sigmahat.health.scatter import variance_between
from sigmahat.health.threshold import START, limit
from sigmahat.result.sheet import Prior, Together

Array = NDArray[np.float64]


def series(values: Array, effects: Array | None = None, **more: float) -> Series:
    n = len(values)
    none = np.zeros((n, 0))
    return Series(
        np.arange(n, dtype=np.float64), values, np.ones(n), none if effects is None else effects,
        **more,
    )  # fmt: skip


def noise(seed: int, n: int) -> Array:
    return np.random.default_rng(seed).uniform(-1.5, 1.5, n)  # no value is limited


def test_the_variance_between_logs_has_a_closed_form_for_equal_differences() -> None:
    values = np.array([0.0, 3.0] * 10)
    median = chi2.median(1)
    assert variance_between(values, np.zeros(20)) == pytest.approx(9.0 / 2 / median)
    assert variance_between(values, np.full(20, 1.0)) == pytest.approx(9.0 / 2 / median - 1.0)


def test_claimed_variances_that_explain_the_differences_leave_none_between() -> None:
    assert variance_between(np.array([0.0, 3.0] * 10), np.full(20, 10.0)) == 0.0


def test_neither_a_change_nor_a_bad_log_counts_as_scatter() -> None:
    values = np.random.default_rng(1).standard_normal(401)
    values[200:] += 1000.0
    values[77] = -1e6
    assert variance_between(values, np.zeros(401)) == pytest.approx(1.0, rel=0.2)


@pytest.mark.parametrize("count", [0, 1, 2])
def test_few_logs_have_no_scatter(count: int) -> None:
    assert variance_between(np.arange(count, dtype=np.float64), np.zeros(count)) == 0.0


@pytest.mark.parametrize("count", [0, 1, 2, 4])
def test_few_logs_have_no_change(count: int) -> None:
    assert largest_change(series(np.arange(count, dtype=np.float64))) is None


def test_a_step_is_as_rare_as_the_t_test_says() -> None:
    values = noise(2, 30)
    values[18:] += 1.6
    found = largest_change(series(values))
    assert found is not None and found.kind is Kind.STEP
    before, after = values[: found.at], values[found.at :]
    expected = ttest_ind(after, before)
    assert found.z == pytest.approx(norm.isf(expected.pvalue / 2), rel=1e-9)
    assert found.size == pytest.approx(after.mean() - before.mean(), rel=1e-9)
    low, high = expected.confidence_interval()
    assert found.half_width() == pytest.approx((high - low) / 2, rel=1e-9)


def test_a_trend_is_the_slope_of_a_broken_line() -> None:
    n, begin = 60, 20
    days = np.arange(n)
    values = noise(3, n) + 0.15 * np.maximum(days - begin, 0)
    found = largest_change(series(values))
    assert found is not None and found.kind is Kind.TREND
    ramp = np.maximum(days - days[found.at - 1], 0)
    columns = np.column_stack([np.ones(n), ramp])
    (_, slope), rest, _, _ = np.linalg.lstsq(columns, values, rcond=None)
    length = n - found.at
    assert found.size == pytest.approx(slope * length, rel=1e-6)
    covariance = np.linalg.inv(columns.T @ columns) * rest[0] / (n - 2)
    assert found.std == pytest.approx(math.sqrt(covariance[1, 1]) * length, rel=1e-6)


def test_the_rate_of_false_alarms_was_measured_for_what_is_computed() -> None:
    values = noise(4, 40)
    each = largest_z(values[None])[0]
    for n in (6, 17, 40):
        found = largest_change(series(values[:n]))
        assert found is not None
        # The middle from which values are limited is the median.
        assert abs(found.z) == pytest.approx(each[n - 1], rel=1e-9)


def test_the_limit_gives_its_rate_of_false_alarms() -> None:
    """400 series of 100 logs, of which 21 % should have one; two standard deviations are 4 %."""
    z = threshold.limit(0.21 * threshold.LOGS_A_YEAR / 100, quantities=1)
    values = np.random.default_rng(5).standard_normal((400, 100))
    assert np.mean(largest_z(values).max(axis=1) > z) == pytest.approx(0.21, abs=0.06)
    assert threshold.limit(1e-3, 8) > threshold.limit(1e-3, 1) > threshold.limit(1e-2, 1)


def test_results_that_agree_too_well_are_no_change() -> None:
    values = np.concatenate([np.zeros(20), np.full(20, 1e-3)])
    exact = largest_change(series(values))
    assert exact is not None and exact.z > 10
    found = largest_change(series(values, least=0.01))
    assert found is not None and found.z == pytest.approx(1e-3 / 0.01 * math.sqrt(10), rel=0.05)


def test_one_bad_log_is_no_change() -> None:
    values = noise(6, 50)
    for bad in (25, 49):
        spoilt = values.copy()
        spoilt[bad] = 1e6
        found = largest_change(series(spoilt))
        assert found is not None and abs(found.z) < 4


def z_of_the_t_test(values: Array, at: int) -> float:
    """With the standard deviation that results of a joint have at least."""
    before, after = values[:at], values[at:]
    t = (after.mean() - before.mean()) / math.sqrt(1 / len(before) + 1 / len(after))
    freedom = len(values) - 2
    rest = np.sum((before - before.mean()) ** 2) + np.sum((after - after.mean()) ** 2)
    return float(norm.isf(student_t.sf(t / math.sqrt(rest / freedom), freedom)))


@pytest.mark.parametrize(("logs", "at"), [(24, 19), (24, 12), (24, 5), (60, 50), (120, 85)])
def test_a_large_step_is_found(logs: int, at: int) -> None:
    """Of 20 scatters; 3.5 were all that counted, however clear a step was."""
    values = noise(15, logs)
    values[at:] += 20.0
    found = largest_change(series(values))
    assert found is not None and (found.kind, found.at) == (Kind.STEP, at)
    # Next to the step, and of a step that is shorter than half of the neighbours, logs are cut.
    exact = z_of_the_t_test(values, at)
    assert max(0.55 * exact, limit(START, 8)) < found.z <= exact * (1 + 1e-9)
    assert found.size == pytest.approx(20.0, abs=1.5)


@pytest.mark.parametrize("bad", [[23], [22, 23], [21, 22, 23], [0, 1], [10, 11], [3, 12, 20]])
def test_wild_logs_are_no_change(bad: list[int]) -> None:
    values = noise(16, 24)
    values[bad] += 1000.0
    found = largest_change(series(values))
    assert found is not None and abs(found.z) < limit(START, 8)


def test_a_trend_that_goes_far_is_found() -> None:
    """200 scatters in 100 logs, which is 3.5 scatters within two."""
    values = noise(17, 160)
    values[60:] -= 2.0 * np.arange(1, 101)
    found = largest_change(series(values))
    assert found is not None and found.kind is Kind.TREND
    assert found.size == pytest.approx(-200.0, rel=0.05) and found.z < -20


def test_effects_take_the_freedom_that_they_explain() -> None:
    """By the trace of the projection with dense matrices, from none to one for each."""
    rng = np.random.default_rng(18)
    values, effect = noise(18, 30), rng.standard_normal((30, 2))
    for scale in (1e-6, 0.1, 0.3, 100.0):
        effects = scale * (effect - effect.mean(axis=0))
        rows = np.vstack([np.column_stack([np.ones(30), effects]), np.eye(2, 3, 1)])
        of_logs = (rows @ np.linalg.inv(rows.T @ rows) @ rows.T)[:30, :30]
        found = largest_change(series(values, scale * effect))
        assert found is not None
        assert found.freedom == pytest.approx(30 - np.trace(of_logs) - 1, rel=1e-9)
        if scale in (1e-6, 100.0):
            assert found.freedom == pytest.approx(28 if scale < 1 else 26, rel=1e-3)


class LeastSquares:
    """Student's t of a column, by least squares with unequal times, weights and an effect."""

    def __init__(self, n: int) -> None:
        rng = np.random.default_rng(19)
        self.days, self.stds = np.sort(rng.uniform(0, 400, n)), rng.uniform(0.5, 2.0, n)
        effect = rng.standard_normal((n, 1))
        values = self.stds * rng.uniform(-1.5, 1.5, n)
        self.series = Series(self.days, values, self.stds, effect)
        columns = np.column_stack([np.ones(n), effect - effect.mean()])
        self.rows = np.vstack([columns / self.stds[:, None], [0, 1]])
        self.y = np.append(values / self.stds, 0.0)
        hat = self.rows @ np.linalg.pinv(self.rows)
        self.freedom = n - 1 - float(np.trace(hat[:n, :n]))

    def t(self, column: Array) -> float:
        rows = np.column_stack([self.rows, np.append(column / self.stds, 0.0)])
        solution, rest, _, _ = np.linalg.lstsq(rows, self.y, rcond=None)
        variance = np.linalg.inv(rows.T @ rows)[2, 2] * rest[0] / self.freedom
        return float(abs(solution[2]) / math.sqrt(variance))

    def z(self, t: float) -> float:
        return float(norm.isf(student_t.sf(t, self.freedom)))


def test_all_change_points_at_once_are_each_by_itself() -> None:
    n = 40
    by_rows = LeastSquares(n)
    found, days, best = largest_change(by_rows.series), by_rows.days, 0.0
    assert found is not None
    for at in range(2, n - 1):
        steps = (np.arange(n) >= at).astype(float)
        ramps = np.maximum(days - days[at - 1], 0.0) / (days[-1] - days[at - 1])
        for column in (steps, ramps) if at <= n - 10 else (steps,):
            best = max(best, by_rows.t(column))
    assert abs(found.z) == pytest.approx(by_rows.z(best), rel=1e-6)


def test_all_episodes_at_once_are_each_by_itself() -> None:
    n = 30
    by_rows = LeastSquares(n)
    by_rows.y[10:18] += 2.0  # in standard deviations: no value is limited
    values = by_rows.y[:n] * by_rows.stds
    found = largest_episode(replace(by_rows.series, values=values))
    index = np.arange(n)
    t = {
        (first, end): by_rows.t(((index >= first) & (index < end)).astype(float))
        for first in range(2, n - 3)
        for end in range(first + 2, n - 1)
    }
    best = max(t, key=lambda each: t[each])
    assert found is not None and (found.first, found.end) == best
    # As rare as a tenth of the largest of 64 steps.
    z = math.sqrt(by_rows.z(t[best]) ** 2 - 2 * math.log(640))
    assert found.z == pytest.approx(z, rel=1e-6)


def test_episodes_are_a_tenth_of_the_false_alarms() -> None:
    """With a rate at which 40 of 200 series of 100 logs have a false alarm, 4 of them."""
    z = threshold.limit(0.2 * threshold.LOGS_A_YEAR / 100, quantities=1)
    values = np.random.default_rng(8).standard_normal((200, 100))
    found = [largest_episode(series(each)) for each in values]
    assert sum(each is not None and each.z > z for each in found) <= 8


def test_an_effect_that_changes_with_the_values_explains_them() -> None:
    effect = np.repeat([0.0, 1.0], 25)[:, None]
    values = noise(7, 50)
    found = largest_change(series(values + 2 * effect[:, 0]))
    assert found is not None and found.z > 6
    explained = largest_change(series(values + 2 * effect[:, 0], 2.0 * effect))
    assert explained is not None and abs(explained.z) < 3
    # An effect that hardly varies explains nothing.
    small = largest_change(series(values + 2 * effect[:, 0], 0.01 * effect))
    assert small is not None and small.z == pytest.approx(found.z, rel=0.1)


def test_a_change_that_may_be_the_gain_counts_less() -> None:
    values = noise(8, 60)
    values[30:] += 3.0
    alone, found = largest_change(series(values)), largest_change(series(values, common=2.0))
    assert alone is not None and found is not None
    assert found.z == pytest.approx(1 / math.hypot(1 / alone.z, 2.0 / alone.size))
    assert found.std == pytest.approx(math.hypot(alone.std, 2.0))


def test_segments_come_in_the_order_of_time() -> None:
    values = np.concatenate([noise(9, 40), noise(10, 40) - 4.0, noise(11, 40)])
    found = segments(series(values), 5.0)
    assert [each.at for each in found] == [40, 80]
    assert found[0].size == pytest.approx(-4.0, abs=0.6)
    assert found[1].size == pytest.approx(4.0, abs=0.6)


def without_prior(together: Together, name: str) -> tuple[Array, Array]:
    """By the inverses of dense matrices."""
    values, P = np.array(together.values[4:8]), np.array(together.covariance)[4:8, 4:8]
    i = ("sigma", "B", "D_theta", "tau_coulomb").index(name)
    prior = together.prior[name]
    information = np.linalg.inv(P)
    right = information @ values
    information[i, i] -= prior.std**-2
    right[i] -= prior.mean / prior.std**2
    found = np.linalg.inv(information)
    return found @ right, found


def test_the_prior_of_the_inertia_is_taken_away_exactly() -> None:
    joint = TrueJoint()
    told = estimates(joint, np.random.default_rng(12))
    P = np.array(told.covariance)
    P[4, 5] = P[5, 4] = -0.9 * math.sqrt(P[4, 4] * P[5, 5])
    prior = {"B": Prior(1.05e-4, 1.5e-6), "D_theta": Prior(5e-4, 1e6), "tau_coulomb": Prior(0, 1e6)}
    together = Together(
        told.phi, told.set_point, told.quantities, told.values, told.per_gain, P.tolist(), prior
    )
    own = own_estimates([together])
    values, covariance = without_prior(together, "B")
    np.testing.assert_allclose(own.values[0, 4:8], values, rtol=1e-9)
    np.testing.assert_allclose(own.covariance[0, 4:8, 4:8], covariance, rtol=1e-6, atol=1e-20)
    assert own.determines_inertia[0]


def test_an_inertia_that_the_prior_determines_is_not_of_the_log() -> None:
    told = estimates(TrueJoint(), np.random.default_rng(13))
    for std in (0.0, 1.05e-6):
        prior = {**told.prior, "B": Prior(1e-4, std)}
        together = Together(**{**vars(told), "prior": prior})
        assert not own_estimates([together]).determines_inertia[0]


def test_times_may_be_equal_or_far_apart() -> None:
    values = noise(14, 40)
    values[20:] -= 5.0
    days = np.repeat(np.arange(20.0), 2)
    days[20:] += timedelta(days=400).days
    found = largest_change(Series(days, values, np.ones(40), np.zeros((40, 0))))
    assert found is not None and found.at == 20 and found.kind is Kind.STEP
