"""Meaning and unit of a column follow from its name, or from its values if the name is unclear."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from checked_logs import log_by_hand
from foreign_joint import GEAR, Motion, T, joint
from sigmahat.guess.columns import Facts, interval, look_at, read_columns
from sigmahat.guess.guess import JointGuess, guess
from sigmahat.guess.words import meaning
from sigmahat.recording.log import LogInMemory
from sigmahat.recording.readers.formats import open_log

N = 7000


@pytest.mark.parametrize(
    ("name", "quantity", "side", "unit"),
    [
        ("/joint_states/knee_motor/position", "position", "motor", None),
        ("/joint_states.position[knee_link]", "position", "link", None),
        ("/right_knee_drive/current.data", "current", "motor", None),
        ("/right_knee_drive/current.time", "time", "motor", None),
        ("field.position0", "position", None, None),
        ("iq_A", "current", None, "A"),
        ("motor_torque_mNm", "torque", "motor", "mN.m"),
        ("timestamp", "time", None, None),
        ("Motorstrom in mA", "current", "motor", "mA"),
        ("Abtriebswinkel [Grad]", "position", "link", "deg"),
        ("angle_moteur_deg", "position", "motor", "deg"),
        ("coppia_motore_Nm", "torque", "motor", "N.m"),
        ("posicion_motor_pulsos", "position", "motor", "counts"),
        ("tiempo_ms", "time", None, "ms"),
        ("mota_kakudo", "position", "motor", None),
        ("guanjie_jiaodu_deg", "position", None, "deg"),
        ("thetaM", "position", "motor", None),
        ("q_dot", "velocity", None, None),
        ("speed [U/min]", "velocity", None, None),
        ("current_position", "position", None, None),
        ("series_elastic_torque", "torque", None, None),
        ("calibrated", None, None, None),
        ("Motortemperatur [°C]", "temperature", "motor", None),
        ("joint.link.position [arcmin]", "position", "link", "arcmin"),
        ("joint.motor.torque [mN*m]", "torque", "motor", "mN.m"),
        ("exo_torque_Nm_per_kg", "torque", None, None),
        ("as5048_u14", None, None, None),
        ("motor_angle_u16", "position", "motor", None),
        ("motor_q_i1", "position", "motor", None),
        ("モータ角度[deg]", "position", "motor", "deg"),
        ("リンク角度", "position", "link", None),
        ("モータトルク[Nm]", "torque", "motor", "N.m"),
        ("电机位置(度)", "position", "motor", "deg"),
        ("连杆位置(度)", "position", "link", "deg"),
        ("电机电流(A)", "current", "motor", "A"),
        ("qpos_0", "position", None, None),
        ("qvel_0", "velocity", None, None),
        ("actuator_force_0", "torque", "motor", None),
    ],
)
def test_names(name: str, quantity: str | None, side: str | None, unit: str | None) -> None:
    said = meaning(name)
    assert (said.quantity, said.side, said.unit) == (quantity, side, unit)


def facts(values: np.ndarray) -> Facts:
    return look_at(LogInMemory(Path("log"), {"x": values}), "x", "position")[0]


@pytest.mark.parametrize("period", [4096, 2**32, 20_000, 360.0, 2 * np.pi])
def test_a_counter_that_starts_again(period: float) -> None:
    whole = isinstance(period, int)
    x = 0.9 * period * np.sin(4 * T * np.arange(N)) + 0.3 * period
    x = np.mod(np.round(x).astype(np.int64) if whole else x, period)
    assert facts(x).wrap == pytest.approx(period)
    assert facts(x).integer == whole


def test_what_only_jumps_does_not_start_again() -> None:
    steps = np.repeat([0.0, 400.0, 0.0, 400.0], N // 4)
    assert facts(steps + np.random.default_rng(1).normal(0, 1, N // 4 * 4)).wrap is None
    assert facts(np.sin(T * np.arange(N))).wrap is None


EVEN, RNG = T * np.arange(N), np.random.default_rng(2)
KEPT = np.r_[0:3000, 4500:N]


@pytest.mark.parametrize(
    ("times", "period"),
    [
        (EVEN[KEPT], T),
        ((EVEN + RNG.uniform(-0.3 * T, 0.3 * T, N))[KEPT], T),
        (EVEN[RNG.uniform(size=N) > 0.15], T),
        (np.floor(1500 * EVEN) / 1000, 1.5 * T),  # a period of 1.5 ms, rounded to 1 ms
        (1.7e9 + EVEN, T),
    ],
    ids=["gap", "gap and jitter", "lost rows", "coarse clock", "since 1970"],
)
def test_the_sampling_period(times: np.ndarray, period: float) -> None:
    assert interval(times) == pytest.approx(period, rel=2e-4)


def only(columns: dict[str, np.ndarray]) -> JointGuess:
    (found,) = guess(read_columns(LogInMemory(Path("log"), columns))).values()
    return found


@pytest.fixture(scope="module")
def m() -> Motion:
    return joint(False)


@pytest.mark.parametrize(
    ("step", "unit"),
    [(1_000_000, "ns"), (1000, "us"), (1, "ms"), (0.001, "s"), (5, "ms"), (1.157e-7, "day")],
)
def test_the_unit_of_times_by_their_steps(step: float, unit: str, m: Motion) -> None:
    found = only({"t": step * np.arange(N), "theta": m.theta, "q": m.q, "tau": m.tau})
    assert (found.time, found.clock.unit) == ("t", unit)


def test_a_velocity_tells_the_unit_of_its_position(m: Motion) -> None:
    columns = {
        "t": m.t,
        "motor_pos": m.theta * GEAR / (2 * np.pi),
        "motor_speed_rpm": m.velocity * GEAR * 60 / (2 * np.pi),
        "link_pos": m.q / (2 * np.pi),
        "motor_torque": -m.tau,
    }
    ports = only(columns).ports
    assert [ports[name].unit for name in ("theta", "q")] == ["turn", "turn"]
    # The log of a soft joint shows only an approximate gear ratio, so the user must set the ratio.
    assert ports["theta"].gear_ratio is None
    assert ports["theta"].moves == pytest.approx(GEAR, rel=0.05)
    assert ports["tau"].sign == -1


def test_signs_and_zeros(m: Motion) -> None:
    columns = {"t": m.t, "motor_rad": m.theta, "link_deg": 200 - np.degrees(m.q), "tau": m.tau}
    ports = only({**columns, "load_cell_Nm": -m.tau_e}).ports
    assert ports["q"].sign == -1
    assert ports["q"].zero == pytest.approx(200 - np.degrees(m.q).mean(), rel=1e-4)
    assert ports["tau_e_sensor"].sign == -1


def test_a_hand_on_the_link_leaves_the_sign_of_the_torque_open() -> None:
    """GIVEN a motor that holds its position by control, WHEN a hand moves the link, THEN `init`
    derives no sign of the torque. The power of the motor torque is negative in this case."""
    log = dict(log_by_hand(0.05))
    assert np.mean(log["current"] * np.gradient(log["motor_counts"])) < 0
    port = only(log).ports["tau"]
    assert port.column == "current" and port.sign == 1
    assert port.notes["sign"].startswith("CHECK: the log does not show it")


def test_a_torque_beside_an_angle_is_measured(m: Motion) -> None:
    found = only({"t": m.t, "angle_rad": m.q, "torque_Nm": 40 * m.q})
    assert set(found.ports) == {"q", "tau_e_sensor"}


@pytest.mark.parametrize("suffix", ["", "_setpoint", "_ref"])
def test_what_was_asked_for_is_not_what_was_measured(suffix: str, m: Motion) -> None:
    columns = {"t": m.t, f"motor_pos{suffix}": m.target, "motor_position": m.theta, "q": m.q}
    ports = only({**columns, "tau": m.tau}).ports
    assert ports["q"].column == "q"
    assert suffix == "" or ports["theta"].column == "motor_position"
    assert "theta_c" not in ports or suffix == ""


def test_times_that_stand_in_two_rows_each_are_times(m: Motion) -> None:
    log = {"time": T * np.arange(N), "theta": m.theta, "q": m.q, "tau": m.tau}
    found = only({name: np.repeat(values, 2) for name, values in log.items()})
    assert (found.time, found.clock.interval) == ("time", T)


@pytest.mark.parametrize("sign", [1, -1])
def test_the_current_of_a_weight_is_no_offset(m: Motion, sign: int) -> None:
    """Of an arm under gravity, the current never comes near 0."""
    current = sign * (3.0 + m.tau / np.ptp(m.tau))
    found = only({"t_s": T * np.arange(N), "theta": m.theta, "q": m.q, "current": current})
    assert found.ports["tau"].zero == 0
    assert "may be that of a weight" in found.ports["tau"].notes["zero"]


def test_a_torque_far_from_zero_has_an_offset_to_check(m: Motion) -> None:
    counts = np.round(2043 + 500 * m.tau / np.abs(m.tau).max())
    found = only({"t_s": T * np.arange(N), "theta": m.theta, "q": m.q, "adc_i": counts})
    assert abs(found.ports["tau"].zero - 2043) < 100
    assert found.ports["tau"].notes["zero"].startswith("CHECK")


def test_a_name_that_only_suggests_a_side_leaves_it_to_the_motion(m: Motion) -> None:
    columns = {"t_s": T * np.arange(N), "as5048": m.q, "angle": m.theta, "tau": m.tau}
    ports = only(columns).ports
    assert (ports["theta"].column, ports["q"].column) == ("angle", "as5048")


@pytest.mark.parametrize(
    "name",
    ["axis0.controller.input_pos", "ctrl_0", "joint_control_output_2", "t_ff", "v_des", "p_des"],
)
def test_a_command_is_no_measurement(name: str) -> None:
    assert meaning(name).reference


def test_the_signed_one_of_two_currents_is_the_torque(tmp_path: Path) -> None:
    motion = joint(has_lever=False)
    columns = {
        "t": motion.t,
        "motor_deg": np.degrees(motion.theta),
        "link_deg": np.degrees(motion.q),
        "current_motor": np.abs(motion.tau),
        "q_axis_current": motion.tau,
    }
    (found,) = guess(read_columns(LogInMemory(tmp_path / "log.csv", columns))).values()
    assert found.ports["tau"].column == "q_axis_current"


def test_a_current_without_a_sign_is_named(tmp_path: Path) -> None:
    motion = joint(has_lever=False)
    columns = {
        "t": motion.t,
        "motor_deg": np.degrees(motion.theta),
        "link_deg": np.degrees(motion.q),
        "motor_current_A": np.abs(motion.tau),
    }
    (found,) = guess(read_columns(LogInMemory(tmp_path / "log.csv", columns))).values()
    assert "never negative" in found.ports["tau"].notes["sign"]


def test_points_in_time_are_the_time_whatever_their_name(tmp_path: Path) -> None:
    t = np.datetime64("2026-03-12T10:00:00", "us") + 4000 * np.arange(100)
    times = pa.array(t.astype("datetime64[us]"))
    table = {"motor_deg": np.sin(np.arange(100)), "__index_level_0__": times}
    pq.write_table(pa.table(table), tmp_path / "log.parquet")
    columns = read_columns(open_log(tmp_path / "log.parquet"))
    assert columns.signals[0].clock == "__index_level_0__"
    assert columns.signals[0].samples.interval == pytest.approx(0.004)
