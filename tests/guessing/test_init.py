"""`sigmahat init`: a configuration guessed from names and values of columns."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import tomlkit

from recorded_logs import write_log
from sigmahat.cli import main
from sigmahat.fmi.instance import Fmu
from sigmahat.logs.configuration import read_configuration
from sigmahat.logs.joints import of_joint
from sigmahat.logs.replay import parameters


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
    assert found["ports"]["theta"]["unit"] == "deg"
    assert found["ports"]["theta"]["gear_ratio"] == 2000
    assert found["parameters"]["encoder"] == {"theta": 4096 * 2000, "q": 0}
    assert found["parameters"]["rls"]["m"] == 1


def test_what_it_asks_for_must_be_filled_in(capsys: pytest.CaptureFixture[str]) -> None:
    log = columns(time="t", theta="theta", q="q_deg", tau="i_q")
    log["theta"] = np.round(4e4 * log["theta"])  # whole numbers are counts, and not radians
    write_log(log, Path("log.csv"))
    assert main(["init", "log.csv"]) == 0
    text = Path("log.toml").read_text()
    for key in ("theta.gear_ratio", "theta.counts_per_turn", "tau.torque_constant"):
        capsys.readouterr()
        assert main(["estimate", "log.csv"]) == 2
        assert f"ports.{key} is 0; fill in" in capsys.readouterr().err
        name = key.split(".")[1]
        text = text.replace(f"{name} = 0 ", f"{name} = 2 ")
        Path("log.toml").write_text(text)
    assert main(["estimate", "log.csv", "--quiet"]) == 0


def test_a_file_is_not_overwritten(capsys: pytest.CaptureFixture[str]) -> None:
    write_log(columns(time="t", theta="theta", q="q", tau="tau"), Path("log.csv"))
    Path("log.toml").write_text("mine")
    assert main(["init", "log.csv"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "--force" in line
    assert Path("log.toml").read_text() == "mine"
    assert main(["init", "log.csv", "--force"]) == 0


def test_no_column_that_looks_like_a_port(capsys: pytest.CaptureFixture[str]) -> None:
    """A skeleton, with every column and its range."""
    write_log({"x": np.arange(9.0) % 4, "note": np.array(list("abcdefghi"))}, Path("log.csv"))
    assert main(["init", "log.csv"]) == 0
    text = Path("log.toml").read_text()
    assert "#   x: 9 samples, 0 to 3; a few values only" in text
    assert "#   note: 9 samples; text" in text
    assert set(tomlkit.parse(text).unwrap()["ports"]) == {"theta", "q", "tau"}
    capsys.readouterr()
    assert main(["estimate", "log.csv"]) == 2
    assert "motor.gamma is 0; fill in the gear ratio" in capsys.readouterr().err
    Path("log.toml").write_text(text.replace("motor.gamma = 0", "motor.gamma = 9"))
    assert main(["estimate", "log.csv"]) == 2
    assert "unknown column 'FILL IN'" in capsys.readouterr().err


def two_joints() -> dict[str, np.ndarray]:
    """Motor and link of a hip; a knee of which only the link is there."""
    t = 2e-3 * np.arange(1000)
    hip, knee = np.sin(5 * t), np.sin(3 * t)
    return {
        "t": t,
        "hip_motor_pos_rad": hip,
        "hip_link_pos_rad": 1.01 * hip,
        "hip_current_A": np.cos(5 * t),
        "knee_motor_pos_rad": knee,
        "knee_link_pos_rad": 1.02 * knee,
        "knee_current_A": np.cos(3 * t),
    }


def port_columns(path: str, joint: str = "") -> dict[str, str]:
    document = of_joint(tomlkit.parse(Path(path).read_text()), joint).unwrap()
    return {name: port["column"] for name, port in document["ports"].items()}


def test_all_joints_in_one_file() -> None:
    write_log(two_joints(), Path("leg.csv"))
    assert main(["init", "leg.csv"]) == 0
    text = Path("leg.toml").read_text()
    for once in ("torque_constant = 0", "samplePeriod", "motor.B"):
        assert text.count(once) == 1
    for joint in ("hip", "knee"):
        assert port_columns("leg.toml", joint) == {
            "theta": f"{joint}_motor_pos_rad",
            "q": f"{joint}_link_pos_rad",
            "tau": f"{joint}_current_A",
        }
    assert main(["init", "leg.csv", "--joint", "knee", "--config", "knee.toml"]) == 0
    assert port_columns("knee.toml") == port_columns("leg.toml", "knee")


def test_a_joint_that_is_not_clear(capsys: pytest.CaptureFixture[str]) -> None:
    write_log(two_joints(), Path("leg.csv"))
    assert main(["init", "leg.csv", "--joint", "kne"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "unknown joint 'kne'; did you mean 'knee'" in line
    assert not list(Path().glob("*.toml"))


def test_a_motor_never_goes_with_the_link_of_another_joint() -> None:
    log = two_joints()
    write_log({n: log[n] for n in ("t", "hip_motor_pos_rad", "knee_link_pos_rad")}, Path("l.csv"))
    assert main(["init", "l.csv"]) == 0
    assert port_columns("l.toml", "hip")["theta"] == "hip_motor_pos_rad"
    assert port_columns("l.toml", "hip")["q"] == "FILL IN"
    assert port_columns("l.toml", "knee")["q"] == "knee_link_pos_rad"
    assert port_columns("l.toml", "knee")["theta"] == "FILL IN"


def test_the_gear_ratio_of_theta_is_that_of_the_motor(estimator_fmu: Path) -> None:
    text = '[ports.theta]\ncolumn = "a"\ngear_ratio = -70\n[ports.q]\ncolumn = "b"\n'
    with Fmu(estimator_fmu) as fmu:
        for given, gamma in (("", 70), ("motor.gamma = 0", 70), ("motor.gamma = 35", 35)):
            Path("log.toml").write_text(f"{text}[parameters]\n{given}\n")
            assert parameters(fmu, read_configuration(Path("log.toml")))["motor.gamma"] == gamma


@pytest.mark.parametrize(
    ("step", "unit", "period"), [(2.0, "ms", "0.002"), (1000.0, "us", "0.001"), (2e-3, None, "")]
)
def test_a_time_in_another_unit_is_doubted(
    step: float, unit: str | None, period: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """GIVEN times in ms or us under a name that says s, THEN init names the likely unit."""
    t = step * np.arange(1000)
    motion = np.sin(np.arange(1000) / 100)
    values = {"time_s": t, "theta": motion, "q": 0.9 * motion, "tau": motion**2}
    write_log(values, Path("log.csv"))
    main(["init", "log.csv"])
    text = capsys.readouterr().out
    if unit is None:
        assert "implausible" not in text
    else:
        assert f'If time_s is in {unit}, set time.unit = "{unit}"' in text
        assert f"samplePeriod = {period}" in text
        assert "implausible" in Path("log.toml").read_text()
