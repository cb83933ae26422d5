"""`sigmahat init` derives a configuration from the names and values of the columns of a log."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomlkit
from numpy.typing import NDArray

from command_line import Shell
from recorded_logs import in_memory, write_log
from sigmahat.files import toml_file
from sigmahat.guess.columns import read_columns
from sigmahat.guess.guess import guess
from sigmahat.guess.template import write
from sigmahat.recording.configuration import read_configuration
from sigmahat.recording.estimator_parameters import parameters
from sigmahat.recording.log import LogInMemory
from sigmahat.recording.several_joints import of_joint

T = 2e-3 * np.arange(1000)
MOTION = np.sin(5 * T)
LOG = {"t": T, "theta": MOTION, "q": MOTION, "tau": MOTION}


def read(path: str = "log.toml", joint: str = "") -> Any:
    return of_joint(tomlkit.parse(Path(path).read_text()), joint).unwrap()


def test_steps_and_turns_of_encoders(shell: Shell) -> None:
    degrees = np.mod(np.round(2000 * MOTION * 4096 / 360) * 360 / 4096, 360)
    log = {"t": T, "theta_deg": degrees, "q_deg": MOTION, "motor_Nm": MOTION}
    write_log(log, Path("log.parquet"))
    shell.run("init log.parquet")
    found = read()
    theta = found["ports"]["theta"]
    assert (theta["wrap"], theta["unit"], theta["gear_ratio"]) == (360, "deg", 2000)
    assert found["parameters"]["encoder"] == {"q": 0}
    assert parameters(read_configuration("log.toml"))["encoder.theta"] == 4096 * 2000
    # The counts follow from the step, so another gear needs no other edit.
    text = Path("log.toml").read_text().replace("gear_ratio = 2000", "gear_ratio = 50")
    Path("log.toml").write_text(text)
    assert parameters(read_configuration("log.toml"))["encoder.theta"] == 4096 * 50
    assert found["parameters"]["rls"]["m"] == 1


def test_what_it_asks_for_must_be_filled_in(shell: Shell) -> None:
    counts = np.round(4e4 * MOTION)  # integers are counts, not radians
    write_log({"t": T, "theta": counts, "q_deg": MOTION, "i_q": MOTION}, Path("log.csv"))
    shell.run("init log.csv")
    for key in ("theta.gear_ratio", "theta.counts_per_turn", "tau.torque_constant"):
        assert f"ports.{key} is 0; fill in" in shell.refused("estimate log.csv")
        name = key.split(".")[1]
        text = Path("log.toml").read_text()
        Path("log.toml").write_text(text.replace(f"{name} = 0 ", f"{name} = 2 "))
    shell.run("estimate log.csv")


def test_a_file_is_not_overwritten(shell: Shell) -> None:
    write_log(LOG, Path("log.csv"), "mine")
    assert "--force" in shell.refused("init log.csv")
    shell.run("init log.csv --force")


def test_the_configuration_is_beside_its_log(shell: Shell) -> None:
    """GIVEN logs of the same name in two folders, THEN each has a configuration of its own."""
    for folder in ("monday", "tuesday"):
        Path(folder).mkdir()
        write_log(LOG, Path(folder, "run.csv"))
        said = shell.run(f"init {folder}/run.csv")
        assert f"Check {folder}/run.toml" in said and "--config" not in said
        assert read(f"{folder}/run.toml")["ports"].keys() == {"theta", "q", "tau"}
        assert f"{folder}/run.toml: ports.theta.unit" in shell.refused(f"check {folder}/run.csv")
    assert not Path("run.toml").exists()


def test_names_of_several_lines_stay_comments(shell: Shell) -> None:
    name = "a\nmotor.B = 9 #.parquet"
    log = {
        "t": T,
        "a\nmotor.B = 9 #": MOTION,
        **{f"x\ny = 9 #{k}": v for k, v in LOG.items() if k != "t"},
    }
    write_log(log, Path(name))
    shell.run(f"init '{name}' --config log.toml")
    found = read()
    assert {*found} == {"time", "ports", "parameters"}
    assert found["parameters"]["motor"]["B"] != 9


def test_no_column_that_looks_like_a_port(shell: Shell) -> None:
    """GIVEN columns of unknown meaning, THEN the configuration lists each column with its range."""
    write_log({"x": np.arange(9.0) % 4, "note": np.array(list("abcdefghi"))}, Path("log.csv"))
    shell.run("init log.csv")
    text = Path("log.toml").read_text()
    assert "#   x: 9 samples, 0 to 3; a few values only" in text
    assert "#   note: 9 samples; text" in text
    assert set(read()["ports"]) == {"theta", "q", "tau"}
    assert read()["parameters"]["setPoint"] == {"offset": 0, "scale": 1}  # unlike the AwAS
    assert "motor.gamma is 0; fill in the gear ratio" in shell.refused("estimate log.csv")
    text = text.replace("motor.gamma = 0", "motor.gamma = 9")
    Path("log.toml").write_text(text)
    assert "samplePeriod is 0; fill in the time between" in shell.refused("estimate log.csv")
    Path("log.toml").write_text(text.replace("samplePeriod = 0", "samplePeriod = 0.1"))
    assert "unknown column 'FILL IN'" in shell.refused("estimate log.csv")


def test_a_set_point_of_two_settings_and_a_column_with_a_text(shell: Shell) -> None:
    setting = np.where(T < 1, 10.0, 20.0)
    text = np.where(T[7] == T, "ERR", MOTION.astype(str))
    log = {**LOG, "q": text, "link_deg": MOTION, "theta_c_mm": setting}
    write_log(log, Path("log.csv"))
    assert "column 'q' holds text ('ERR' in row 8), expected numbers" in shell.run("init log.csv")
    assert read()["ports"]["theta_c"]["column"] == "theta_c_mm"


def two_joints(*names: str, **more: NDArray[np.floating]) -> None:
    """Writes a log with motor and link of a hip and a knee. `names` selects some of the columns."""
    log = {"t": T, **more}
    for joint, w in (("hip", 5), ("knee", 3)):
        log[f"{joint}_motor_pos_rad"] = np.sin(w * T)
        log[f"{joint}_link_pos_rad"] = 1.01 * np.sin(w * T)
        log[f"{joint}_current_A"] = np.cos(w * T)
    write_log({name: log[name] for name in names or log}, Path("leg.csv"))


def port_columns(path: str, joint: str = "") -> dict[str, str]:
    return {name: port["column"] for name, port in read(path, joint)["ports"].items()}


def test_all_joints_in_one_file(shell: Shell) -> None:
    two_joints()
    shell.run("init leg.csv")
    text = Path("leg.toml").read_text()
    for once in ("samplePeriod", "motor.B"):
        assert text.count(once) == 1
    for of_each in ("torque_constant = 0", "motor.gamma = 0"):  # motors and gears differ
        assert text.count(f"\n{of_each}   # FILL IN") == 2
    for joint in ("hip", "knee"):
        assert port_columns("leg.toml", joint) == {
            "theta": f"{joint}_motor_pos_rad",
            "q": f"{joint}_link_pos_rad",
            "tau": f"{joint}_current_A",
        }
    shell.run("init leg.csv --joint knee --config knee.toml")
    assert port_columns("knee.toml") == port_columns("leg.toml", "knee")
    line = shell.refused("init leg.csv --joint kne --config kne.toml")
    assert "unknown joint 'kne'; did you mean 'knee'" in line


def test_the_temperature_of_a_motor_is_proposed(shell: Shell) -> None:
    warm = 35 + 0.1 * T
    two_joints(knee_motor_temperature_degC=warm)
    shell.run("init leg.csv")
    assert read("leg.toml", "knee")["temperature"]["column"] == "knee_motor_temperature_degC"
    assert "temperature" not in read("leg.toml", "hip")
    for columns, chosen in (
        ({"temp": warm}, "temp"),
        ({"ambient_temp": warm}, None),
        ({"link_temp": warm}, None),
        ({"temp": warm + 273}, None),
        ({"temp_1": warm, "temp_2": warm}, None),
        ({"motor_temp": warm, "board_temp": warm}, "motor_temp"),
    ):
        write_log({**LOG, **columns}, Path("log.csv"))
        shell.run("init log.csv --force")
        assert read().get("temperature", {}).get("column") == chosen


def test_a_motor_never_goes_with_the_link_of_another_joint(shell: Shell) -> None:
    two_joints("t", "hip_motor_pos_rad", "knee_link_pos_rad")
    shell.run("init leg.csv")
    hip, knee = (port_columns("leg.toml", joint) for joint in ("hip", "knee"))
    assert (hip["theta"], hip["q"]) == ("hip_motor_pos_rad", "FILL IN")
    assert (knee["theta"], knee["q"]) == ("FILL IN", "knee_link_pos_rad")


def test_the_gear_ratio_of_theta_is_that_of_the_motor() -> None:
    text = 'ports = {theta = {column = "a", gear_ratio = -70}, q = {column = "b"}}\n[parameters]\n'
    for given, gamma in (("", 70), ("motor.gamma = 0", 70), ("motor.gamma = 35", 35)):
        assert parameters(in_memory(f"{text}{given}\n"))["motor.gamma"] == gamma


@pytest.mark.parametrize(
    ("step", "unit", "period"), [(2.0, "ms", "0.002"), (1000.0, "us", "0.001"), (2e-3, None, "")]
)
def test_a_time_in_another_unit_is_doubted(
    step: float, unit: str | None, period: str, shell: Shell
) -> None:
    """GIVEN a time column in ms or us that is named like seconds, THEN `init` names the unit."""
    motion = np.sin(np.arange(1000) / 100)
    columns = {"theta": motion, "q": 0.9 * motion, "tau": motion**2}
    write_log({"time_s": step * np.arange(1000), **columns}, Path("log.csv"))
    text = shell.run("init log.csv")
    if unit is None:
        assert "implausible" not in text
    else:
        assert f'If time_s is in {unit}, set time.unit = "{unit}"' in text
        assert f"samplePeriod = {period}" in text
        assert "implausible" in Path("log.toml").read_text()


@pytest.mark.parametrize(("name", "column"), [("time", "time"), ("column 1", None)])
def test_rows_that_are_written_twice_do_not_hide_the_times(name: str, column: str | None) -> None:
    rows = np.sort(np.append(np.arange(len(T)), np.arange(0, len(T), 20)))
    log = {name: T[rows], **{each: LOG[each][rows] for each in ("theta", "q", "tau")}}
    (found,) = guess(read_columns(LogInMemory(Path("log"), log))).values()
    assert found.time == column


def test_the_configuration_of_many_columns_can_be_read_again(tmp_path: Path) -> None:
    many = {
        f"a_column_with_a_long_name_that_does_not_move[{i}]": np.ones(1000) for i in range(1500)
    }
    log = LogInMemory(tmp_path / "log", {**LOG, **many})
    columns = read_columns(log)
    text = write(log, columns, guess(columns))
    (tmp_path / "log.toml").write_text(text)
    assert toml_file.read(tmp_path / "log.toml")["ports"]
    assert "# " + "  and 1304 more, left out here" in text
