"""A log read at once and a stream read value by value give the same values, to the last bit."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from sigmahat.recording.configuration import Configuration, Port, Time
from sigmahat.recording.counters import Unwrapping, WholePeriods
from sigmahat.recording.resampling import PortSamples, resample

T = 1e-3
TURN = 4096
MOTOR = Port("motor", unit="counts", counts_per_turn=TURN, gear_ratio=50, wrap=TURN)
PERIOD = 2 * np.pi / 50  # of the counter, after the gear [rad]
JOINT = Configuration(
    Path("knee.toml"), Time("t"), {"theta": MOTOR, "q": Port("q")}, {"range.phi": 0.02}
)
counts = arrays(np.float64, st.integers(1, 40), elements=st.integers(0, TURN - 1))


@given(counts)
def test_a_counter_of_a_log_and_of_a_stream(values: np.ndarray) -> None:
    log, stream = Unwrapping(TURN), Unwrapping(TURN)
    at_once = log.unwrap(values)
    assert at_once.tolist() == [stream.unwrap_one(value) for value in values.tolist()]
    assert log.jumps == stream.jumps
    assert np.all(np.abs(np.diff(at_once)) <= TURN / 2)
    np.testing.assert_array_equal(at_once % TURN, values)


@given(arrays(np.bool_, st.integers(1, 40)).filter(np.any), st.integers(-3, 3))
def test_whole_periods_of_a_log_and_of_a_stream(seen: np.ndarray, first: int) -> None:
    """GIVEN a counter that begins in another turn, and makes one turn at each tick of a gap."""
    q = 0.3 * np.sin(np.arange(len(seen)))
    truth = np.column_stack([q - 0.01, q])
    in_gap = ~seen & np.maximum.accumulate(seen)
    values = truth.copy()
    values[:, 0] += PERIOD * (first + np.cumsum(in_gap))
    lost = np.flatnonzero(~seen)
    values[lost, lost % 2] = np.nan  # theta and q in turn
    at_once, one_by_one = values.copy(), values.copy()
    log, stream = WholePeriods.of(JOINT), WholePeriods.of(JOINT)
    assert log is not None and stream is not None
    missed = log.put_right(at_once)
    for row in one_by_one:
        stream.put_right_one(row)
    assert log.at_start == stream.at_start == -first
    assert all(each.periods < 0 and seen[each.tick] for each in missed)
    np.testing.assert_array_equal(at_once[seen], one_by_one[seen])
    np.testing.assert_allclose(at_once[seen], truth[seen], atol=1e-12)


@pytest.mark.parametrize("jitter", [0.0, 5e-7, 3e-4])
def test_values_at_the_ticks_of_a_log_and_of_a_stream(jitter: float) -> None:
    """GIVEN samples that are early or late, and gaps shorter and longer than three periods."""
    rng = np.random.default_rng(1)
    t = T * np.arange(300) + jitter * rng.uniform(-1, 1, 300)
    values = np.sin(40 * t)
    kept = np.setdiff1d(np.arange(300), [50, 70, 71, *range(100, 110)])
    at_once = resample(t[kept], values[kept], T, 299, longest_gap=3 * T)
    stream = PortSamples("q", Port("q"), T, 3 * T)
    for each in kept:
        stream.add(t[each], values[each])
    one_by_one = [stream.value_at(tick) for tick in range(299)]
    np.testing.assert_array_equal(at_once.values, np.array(one_by_one, dtype=np.float64))
    assert at_once.interpolated == stream.interpolated
    assert 8 <= np.count_nonzero(np.isnan(at_once.values)) <= 12
