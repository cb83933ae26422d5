"""Samples at ticks: a counter that goes on during a gap, and logs of too many ticks."""

from pathlib import Path

import numpy as np
import pytest

from sigmahat.logs.configuration import Configuration, Port, Time
from sigmahat.logs.log import LogError, LogInMemory
from sigmahat.logs.sampling import sample

GEAR, COUNTS, T = 80, 2**14, 2e-3
PERIOD = 2 * np.pi / GEAR  # of the counter of the motor, behind the gear [rad]
MOTOR = Port("motor", unit="counts", counts_per_turn=COUNTS, gear_ratio=GEAR, wrap=COUNTS)


def configuration(unit: str = "s") -> Configuration:
    ports = {"theta": MOTOR, "q": Port("link"), "tau": Port("torque")}
    return Configuration(Path("elbow.toml"), Time("t", unit), ports, {})


def log(gap: slice) -> tuple[LogInMemory, np.ndarray]:
    """A motor that turns its encoder many times, whose log has a gap; theta behind the gear."""
    t = T * np.arange(2000)
    theta = 0.5 * np.sin(3 * t)
    counts = np.round(theta * GEAR * COUNTS / (2 * np.pi)) % COUNTS
    columns = {"t": t, "motor": counts, "link": theta + 0.01 * np.sin(7 * t), "torque": np.cos(t)}
    kept = np.delete(np.arange(len(t)), gap)
    return LogInMemory(Path("elbow"), {name: x[kept] for name, x in columns.items()}), theta


@pytest.mark.parametrize("gap", [slice(400, 420), slice(900, 1100), slice(500, 1500)])
def test_turns_during_a_gap_are_those_of_the_other_encoder(gap: slice) -> None:
    recorded, theta = log(gap)
    samples = sample(recorded, configuration(), T)
    found = samples.values[:, 0]
    known = np.isfinite(found)
    np.testing.assert_allclose(found[known], theta[known], atol=PERIOD / COUNTS)
    turns = round((theta[gap.stop] - theta[gap.start - 1]) / PERIOD)
    noted = [note for note in samples.notes if "periods of its counter" in note]
    assert len(noted) == (abs(turns) > 0)


def test_a_unit_of_time_that_does_not_fit() -> None:
    recorded, _ = log(slice(0, 0))
    with pytest.raises(LogError, match=r"rows are 0\.12 s apart, the ticks 0\.0001 s; check time"):
        sample(recorded, configuration("min"), 1e-4)


def test_a_slow_log_and_one_with_a_pause(monkeypatch: pytest.MonkeyPatch) -> None:
    """They may have 20 ticks for a row, if they are many."""
    monkeypatch.setattr("sigmahat.logs.sampling._MOST_TICKS", 500_000)
    rows = 51_000
    columns = dict.fromkeys(("motor", "link", "torque"), np.arange(rows, dtype=np.float64))

    def ticks(t: np.ndarray) -> int:
        slow = LogInMemory(Path("slow"), {"t": t, **columns})
        return len(sample(slow, configuration(), 1e-3).values)

    assert ticks(0.01 * np.arange(rows)) == 10 * (rows - 1) + 1
    t = 1e-3 * np.arange(rows)
    t[9000:] += 500
    assert ticks(t) == rows + 500_000
    t[9000:] += 5_000
    words = r"expected at most 1020000; the longest gap is 5500 s: split the log at the pause"
    with pytest.raises(LogError, match=words):
        ticks(t)
