"""Conversion of log rows to samples: a counter that moves during a gap, and very long logs."""

import re
from pathlib import Path

import numpy as np
import pytest

from recorded_logs import configured, in_memory
from sigmahat.recording.configuration import Configuration, Port, Time
from sigmahat.recording.estimator_parameters import parameters
from sigmahat.recording.log import LogError, LogInMemory
from sigmahat.recording.sampling import Samples, sample

GEAR, COUNTS, T = 80, 2**14, 2e-3
PERIOD = 2 * np.pi / GEAR  # period of the motor counter, after the gear [rad]
MOTOR = Port("motor", unit="counts", counts_per_turn=COUNTS, gear_ratio=GEAR, wrap=COUNTS)
PORTS = {"theta": MOTOR, "q": Port("link"), "tau": Port("torque")}
Columns = dict[str, np.ndarray]


def sampled(columns: Columns, ports: dict[str, Port], period: float = T) -> Samples:
    """Samples of a log with the time column "t" and one column for each port."""
    setup = Configuration(Path("log.toml"), Time("t"), ports, {})
    return sample(LogInMemory(Path("log"), columns), setup, period)


def log(gap: slice) -> tuple[Columns, np.ndarray]:
    """A log with a gap, of a motor that makes many turns; theta is the angle after the gear."""
    t = T * np.arange(2000)
    theta = 0.5 * np.sin(3 * t)
    counts = np.round(theta * GEAR * COUNTS / (2 * np.pi)) % COUNTS
    columns = {"t": t, "motor": counts, "link": theta + 0.01 * np.sin(7 * t), "torque": np.cos(t)}
    kept = np.delete(np.arange(len(t)), gap)
    return {name: x[kept] for name, x in columns.items()}, theta


@pytest.mark.parametrize("gap", [slice(400, 420), slice(900, 1100), slice(500, 1500)])
def test_turns_during_a_gap_are_those_of_the_other_encoder(gap: slice) -> None:
    recorded, theta = log(gap)
    samples = sampled(recorded, PORTS)
    found = samples.values[:, 0]
    known = np.isfinite(found)
    np.testing.assert_allclose(found[known], theta[known], atol=PERIOD / COUNTS)
    turns = round((theta[gap.stop] - theta[gap.start - 1]) / PERIOD)
    noted = [note for note in samples.notes if "periods of its counter" in note.in_words]
    assert len(noted) == (abs(turns) > 0)


def test_rows_that_are_lost_are_ticks_without_a_value_as_empty_cells_are() -> None:
    t, lost = T * np.arange(1000), np.r_[400:700]
    empty = np.sin(t)
    empty[lost] = np.nan
    for columns in ({"t": np.delete(t, lost), "x": np.delete(empty, lost)}, {"t": t, "x": empty}):
        found = sampled(columns, {"q": Port("x")})
        np.testing.assert_array_equal(found.values[:, 0], empty)
        said = found.notes[-1].in_words
        assert "300 ticks skipped in 1 gaps, the longest of 0.6 s at 0.8 s" in said


def test_slow_and_uneven_columns_are_interpolated() -> None:
    """GIVEN a column with a value in every tenth row only, and rows with jittering times."""
    t = T * (np.arange(1000) + np.random.default_rng(1).uniform(-0.2, 0.2, 1000))
    slow = np.where(np.arange(1000) % 10, np.nan, 5 * t)
    ports = {"theta": Port("x"), "theta_c": Port("slow")}
    found = sampled({"t": t, "x": 3 * t, "slow": slow}, ports)
    at = t[0] + T * np.arange(len(found.values))
    np.testing.assert_allclose(found.values[:980], np.outer(at, [3, 5])[:980], atol=3e-3 * T)
    said = "\n".join(note.in_words for note in found.notes)
    assert re.search(r"theta: 9\d\d ticks interpolated", said)
    assert re.search(r"theta_c: 9\d\d ticks interpolated, its samples are 0.0[12]\d* s apart", said)


def test_a_column_with_times_of_its_own() -> None:
    t = T * np.arange(1000)
    columns = {"t": t, "x": t**2, "slow_t": t[::10], "slow": t[::10] ** 3}
    found = sampled(columns, {"q": Port("x"), "theta_c": Port("slow", time="slow_t")}).values
    np.testing.assert_array_equal(found[:, 0], t**2)
    np.testing.assert_array_equal(found[::10, 1], t[::10] ** 3)


@pytest.mark.parametrize(("period", "rate"), [(0.001, None), (0.01, 100.0)])
def test_filters_are_not_faster_than_the_samples(period: float, rate: float | None) -> None:
    start = parameters(in_memory(configured(f"samplePeriod = {period}")))
    assert start.get("regression.bandwidth") == start.get("residual.K_I") == rate


def test_a_slow_log_and_one_with_a_pause(monkeypatch: pytest.MonkeyPatch) -> None:
    """A log with very many ticks may have at most 20 ticks for each row."""
    monkeypatch.setattr("sigmahat.recording.sampling._MOST_TICKS", 500_000)
    rows = 51_000
    columns = dict.fromkeys(("motor", "link", "torque"), np.arange(rows, dtype=np.float64))

    def ticks(t: np.ndarray) -> int:
        return len(sampled({"t": t, **columns}, PORTS, 1e-3).values)

    assert ticks(0.01 * np.arange(rows)) == 10 * (rows - 1) + 1
    t = 1e-3 * np.arange(rows)
    t[9000:] += 500
    assert ticks(t) == rows + 500_000
    t[9000:] += 5_000
    words = r"expected at most 1020000; the longest gap is 5500 s: split the log there"
    with pytest.raises(LogError, match=words):
        ticks(t)
