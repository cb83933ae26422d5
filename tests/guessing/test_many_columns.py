"""Logs with far more columns than a joint has."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sigmahat.files import toml_file
from sigmahat.guessing.columns import Column
from sigmahat.guessing.facts import look_at
from sigmahat.guessing.guess import guess
from sigmahat.guessing.roles import assign
from sigmahat.guessing.template import write
from sigmahat.guessing.words import meaning
from sigmahat.logs.log import LogInMemory


def test_the_configuration_of_many_columns_can_be_read_again(tmp_path: Path) -> None:
    t = 1e-3 * np.arange(100)
    motion = {name: np.sin(50 * t) for name in ("theta", "q", "tau")}
    many = {f"a_column_with_a_long_name_that_does_not_move[{i}]": np.ones(100) for i in range(1500)}
    log = LogInMemory(tmp_path / "log", {"t": t, **motion, **many})
    (found,) = guess(log).values()
    text = write(log, found, {"motor.B": 1.0, "motor.D_theta": 1.0})
    (tmp_path / "log.toml").write_text(text)
    assert toml_file.read(tmp_path / "log.toml")["ports"]
    assert "# " + "  and 1304 more, left out here" in text


def test_columns_with_names_of_ports_are_compared_wherever_they_are() -> None:
    t = 1e-3 * np.arange(1000)
    motion = np.sin(50 * t)
    noise = np.random.default_rng(1).normal(size=(40, 1000))
    arrays = {f"joint_position_{i}": row for i, row in enumerate(noise)}
    arrays |= {"link_position": motion, "motor_position": 1.01 * motion, "motor_torque": motion**2}
    log = LogInMemory(Path("log"), arrays)
    columns = [Column(n, meaning(n), look_at(log, n)[0], None, x) for n, x in arrays.items()]
    roles = assign(columns, 1e-3)
    found = {port: role.column.name for port, role in roles.ports.items()}
    assert found["theta"] == "motor_position" and found["q"] == "link_position"
    assert found["tau"] == "motor_torque"
