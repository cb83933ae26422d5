"""`sigmahat init`: a configuration guessed from names and values of columns."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import tomlkit

from recorded_logs import write_log
from sigmahat.cli import main


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def columns(**names: str) -> dict[str, np.ndarray]:
    """A motion under column names by port."""
    t = 2e-3 * np.arange(1000)
    motion = np.sin(5 * t)
    return {names["time"]: t, **{name: motion for port, name in names.items() if port != "time"}}


@pytest.mark.parametrize(
    ("names", "units"),
    [
        (
            {"time": "t", "theta": "theta", "q": "q", "theta_c": "theta_c", "tau": "tau"},
            {"theta": "rad", "q": "rad", "theta_c": "rad", "tau": "N.m"},
        ),
        (
            {"time": "time [s]", "theta": "motor_pos [counts]", "q": "link_angle [deg]"}
            | {"theta_c": "lever_mm", "tau": "motor_current [A]"},
            {"theta": "counts", "q": "deg", "theta_c": "mm", "tau": "A"},
        ),
        (
            {"time": "timestamp", "theta": "motor_encoder_deg", "q": "joint_angle_deg"}
            | {"tau": "motor_torque_mNm", "tau_e_sensor": "torque_sensor_Nm"},
            {"theta": "deg", "q": "deg", "tau": "mN.m", "tau_e_sensor": "N.m"},
        ),
    ],
)
def test_guesses(names: dict[str, str], units: dict[str, str]) -> None:
    write_log({**columns(**names), "motor_velocity": np.zeros(1000)}, Path("log.csv"))
    assert main(["init", "log.csv"]) == 0
    text = Path("log.toml").read_text()
    found = tomlkit.parse(text).unwrap()
    assert found["time"]["column"] == names["time"]
    assert found["parameters"]["samplePeriod"] == pytest.approx(2e-3)
    ports = {port: (each["column"], each["unit"]) for port, each in found["ports"].items()}
    assert ports == {port: (names[port], unit) for port, unit in units.items()}
    for name in (*names.values(), "motor_velocity"):
        assert f"#   {name}: 1000 samples" in text


def test_steps_and_turns_of_encoders() -> None:
    log = columns(time="t", theta="theta_deg", q="q", tau="tau")
    log["theta_deg"] = np.mod(np.round(2000 * log["theta_deg"] * 4096 / 360) * 360 / 4096, 360)
    write_log(log, Path("log.parquet"))
    assert main(["init", "log.parquet", "--quiet"]) == 0
    found = tomlkit.parse(Path("log.toml").read_text()).unwrap()
    assert found["ports"]["theta"]["wrap"] == 360
    assert found["parameters"]["encoder"] == {"theta": 4096, "q": 0}
    assert found["parameters"]["rls"]["m"] == 1


def test_what_it_asks_for_must_be_filled_in(capsys: pytest.CaptureFixture[str]) -> None:
    write_log(columns(time="t", theta="theta_counts", q="q", tau="i_A"), Path("log.csv"))
    assert main(["init", "log.csv"]) == 0
    assert main(["estimate", "log.csv"]) == 2
    line = capsys.readouterr().err
    assert "ports.theta.counts_per_turn is 0; fill in" in line


def test_a_file_is_not_overwritten(capsys: pytest.CaptureFixture[str]) -> None:
    write_log(columns(time="t", theta="theta", q="q", tau="tau"), Path("log.csv"))
    Path("log.toml").write_text("mine")
    assert main(["init", "log.csv"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "--force" in line
    assert Path("log.toml").read_text() == "mine"
    assert main(["init", "log.csv", "--force"]) == 0


def test_no_column_that_looks_like_a_port(capsys: pytest.CaptureFixture[str]) -> None:
    write_log({"x": np.arange(9.0), "y": np.arange(9.0)}, Path("log.csv"))
    assert main(["init", "log.csv"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "x, y" in line
    assert not Path("log.toml").exists()
