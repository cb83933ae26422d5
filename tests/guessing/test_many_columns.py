"""Logs with far more columns than a joint has."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sigmahat.files import toml_file
from sigmahat.guessing.guess import guess
from sigmahat.guessing.template import write
from sigmahat.logs.log import LogInMemory


def test_the_configuration_of_many_columns_can_be_read_again(tmp_path: Path) -> None:
    t = 1e-3 * np.arange(100)
    motion = {name: np.sin(50 * t) for name in ("theta", "q", "tau")}
    many = {f"a_column_with_a_long_name_that_does_not_move[{i}]": np.ones(100) for i in range(1500)}
    log = LogInMemory(tmp_path / "log", {"t": t, **motion, **many})
    text = write(log, guess(log), {"motor.B": 1.0, "motor.D_theta": 1.0})
    (tmp_path / "log.toml").write_text(text)
    assert toml_file.read(tmp_path / "log.toml")["ports"]
    assert "# " + "  and 1304 more, left out here" in text
