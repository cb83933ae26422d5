"""A counter that goes on during a gap."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sigmahat.files import toml_file
from sigmahat.logs.configuration import checked_configuration
from sigmahat.logs.log import LogError
from sigmahat.logs.readers.formats import open_log
from sigmahat.logs.sampling import sample

GEAR, COUNTS, T = 80, 2**14, 2e-3
PERIOD = 2 * np.pi / GEAR  # of the counter of the motor, behind the gear [rad]


def log(folder: Path, gap: slice, unit: str = "s") -> tuple[Path, Path, np.ndarray]:
    """A motor that turns its encoder many times, whose log has a gap; theta behind the gear."""
    t = T * np.arange(2000)
    theta = 0.5 * np.sin(3 * t)
    q = theta + 0.01 * np.sin(7 * t)
    counts = np.round(theta * GEAR * COUNTS / (2 * np.pi)) % COUNTS
    kept = np.ones(len(t), dtype=bool)
    kept[gap] = False
    rows = np.column_stack([t, counts, q, np.cos(t)])[kept]
    path = folder / "elbow.csv"
    np.savetxt(path, rows, delimiter=",", header="t,motor,link,torque", comments="")
    configuration = folder / "elbow.toml"
    configuration.write_text(f"""\
[time]
column = "t"
unit = "{unit}"
[ports.theta]
column = "motor"
unit = "counts"
counts_per_turn = {COUNTS}
gear_ratio = {GEAR}
wrap = {COUNTS}
[ports.q]
column = "link"
[ports.tau]
column = "torque"
""")
    return path, configuration, theta


@pytest.mark.parametrize("gap", [slice(400, 420), slice(900, 1100), slice(500, 1500)])
def test_turns_during_a_gap_are_those_of_the_other_encoder(gap: slice, tmp_path: Path) -> None:
    path, file, theta = log(tmp_path, gap)
    samples = sample(open_log(path), checked_configuration(toml_file.read(file), file), T)
    found = samples.values[:, 0]
    known = np.isfinite(found)
    np.testing.assert_allclose(found[known], theta[known], atol=PERIOD / COUNTS)
    turns = round((theta[gap.stop] - theta[gap.start - 1]) / PERIOD)
    noted = [note for note in samples.notes if "periods of its counter" in note]
    assert len(noted) == (abs(turns) > 0)


def test_a_unit_of_time_that_does_not_fit(tmp_path: Path) -> None:
    path, file, _ = log(tmp_path, slice(0, 0), unit="min")
    configuration = checked_configuration(toml_file.read(file), file)
    with pytest.raises(LogError, match=r"rows are 0\.12 s apart, the ticks 0\.0001 s; check time"):
        sample(open_log(path), configuration, 1e-4)
