"""`init` asks what neither names nor samples show, and the commands refuse an open question."""

from pathlib import Path

import numpy as np
import pytest

from command_line import Shell
from foreign_joint import GEAR, STIFFNESS, Motion, joint
from recorded_logs import write_log
from sigmahat.guess.columns import interval, read_columns
from sigmahat.guess.guess import JointGuess, guess
from sigmahat.guess.template import write
from sigmahat.recording.configuration import QUESTIONS, read_configuration
from sigmahat.recording.log import LogInMemory
from sigmahat.recording.readers.formats import open_log
from sigmahat.result.estimate import estimate

SIDE = ("gear_ratio", "tau")


@pytest.fixture(scope="module")
def m() -> Motion:
    return joint(False)


def only(columns: dict[str, np.ndarray]) -> JointGuess:
    (found,) = guess(read_columns(LogInMemory(Path("log"), columns))).values()
    return found


def fill_in(path: Path, answers: dict[str, str]) -> None:
    text = path.read_text()
    for question, answer in answers.items():
        assert question in text
        text = text.replace(question, answer)
    path.write_text(text)


def test_the_side_of_the_gear_is_asked(m: Motion, shell: Shell) -> None:
    log = {"t": m.t, "knee_motor_pos_rad": m.theta, "knee_link_pos_rad": m.q}
    effort = GEAR * m.tau + np.random.default_rng(1).normal(0, 0.1, len(m.t))
    write_log({**log, "knee_effort": effort}, Path("log.csv"))
    shell.run("init log.csv")
    line = shell.refused("check log.csv")
    assert "ports.tau.unit is FILL IN; fill in N.m" in line
    fill_in(Path("log.toml"), {'unit = "FILL IN"': 'unit = "N.m"'})
    line = shell.refused("check log.csv")
    assert "ports.tau.gear_ratio is 0; fill in 1 if tau is the torque of the motor" in line
    gear = f"gear_ratio = {GEAR:g}"
    fill_in(Path("log.toml"), {"gear_ratio = 0": gear, "gamma = 0": f"gamma = {GEAR:g}"})
    shell.run("identify log.csv")
    said = shell.run("check log.csv")
    assert "tau is the torque of the joint, after a gear of 80, in N.m" in said
    result = estimate(open_log(Path("log.csv")), read_configuration("log.toml"))
    assert result.sigma == pytest.approx(STIFFNESS, rel=0.04)


NAMES = [
    ("t", "motor_pos_rad", "link_pos_rad", "motor_torque_Nm"),
    ("time_s", "theta_m [deg]", "theta_l [deg]", "tau_m [N.m]"),
    ("Time (s)", "Motor Angle (rad)", "Joint Angle (rad)", "Joint Torque (Nm)"),
    ("t_s", "q_motor_rad", "q_link_rad", "tau_motor_Nm"),
    ("timestamp [s]", "Motorwinkel [Grad]", "Abtriebswinkel [Grad]", "Motormoment [Nm]"),
    ("temps_s", "position_moteur_rad", "position_articulation_rad", "couple_moteur_Nm"),
    ("tempo_s", "posizione_motore_rad", "posizione_giunto_rad", "coppia_motore_Nm"),
    ("tiempo_s", "posicion_motor_grados", "posicion_eslabon_grados", "par_motor_Nm"),
    ("t", "motorPosDeg", "linkPosDeg", "jointTorqueNm"),
    ("t", "drive.angle_deg", "output.angle_deg", "drive.torque_mNm"),
    ("t", "knee_motor_rad", "knee_link_rad", "knee_motor_current_A"),
    ("t", "actuator_position_rad", "link_position_rad", "motor_current_mA"),
    ("t", "x1_rad", "x2_rad", "motor_torque_Nm"),
]


@pytest.mark.parametrize("names", NAMES, ids=lambda names: names[1])
def test_nothing_is_asked_but_the_data_sheet(names: tuple[str, ...], m: Motion) -> None:
    """GIVEN units in all names and a torque whose side is said, THEN only gear and torque constant
    are asked."""
    time, motor, link, torque = names
    angles = [
        np.degrees(x) if "deg" in name.lower() or "gra" in name.lower() else x
        for name, x in ((motor, m.theta), (link, m.q))
    ]
    log = LogInMemory(Path("log"), {time: m.t, motor: angles[0], link: angles[1], torque: m.tau})
    columns = read_columns(log)
    lines = write(log, columns, guess(columns)).splitlines()
    asked = {line.split(" = ")[0] for line in lines if "FILL IN" in line and line[0] != "#"}
    assert asked <= {"motor.gamma", "gear_ratio", "torque_constant"}
    sides = [line for line in lines if "gear_ratio = 0" in line and QUESTIONS[SIDE] in line]
    assert not sides


@pytest.mark.parametrize("torque", ["motor_torque_Nm", "motor_current_A", "couple_moteur_Nm"])
def test_nothing_is_asked_that_the_names_say(torque: str, m: Motion) -> None:
    found = only({"t": m.t, "motor_rad": m.theta, "link_deg": np.degrees(m.q), torque: m.tau})
    assert not any(port.is_asked for port in found.ports.values())
    assert found.ports["tau"].gear_ratio == 1


def test_decimals_are_no_encoder(m: Motion) -> None:
    """GIVEN positions with five decimals, THEN one question asks for the unit of both."""
    log = {"t": m.t, "motor": np.round(m.theta, 5), "link": np.round(m.q, 5), "torque": m.tau}
    ports = only(log).ports
    assert ports["theta"].is_asked and ports["q"].unit == "as theta"


def test_binary_steps_decide_also_when_the_text_is_rounded(m: Motion) -> None:
    step = 2 * np.pi / 2**20
    link = np.round(np.round(m.q / step) * step, 7)
    ports = only({"t": m.t, "theta": m.theta, "q": link, "tau_Nm": m.tau}).ports
    assert (ports["q"].unit, ports["q"].notes["unit"]) == ("rad", "by its steps, 1/1048576 turn")
    assert ports["theta"].unit == "rad"


@pytest.mark.parametrize("sign", [1, -1])
def test_a_deformation_is_a_port(sign: int, m: Motion, shell: Shell) -> None:
    phi = sign * (m.q - m.theta)
    log = {"t": m.t, "motor_pos_rad": m.theta, "spring_deflection_deg": np.degrees(phi)}
    torque = m.tau + np.random.default_rng(1).normal(0, 2e-3, len(m.t))
    write_log({**log, "motor_torque_Nm": torque}, Path("log.csv"))
    shell.run("init log.csv")
    assert read_configuration("log.toml").ports["phi"].sign == sign
    fill_in(Path("log.toml"), {"gamma = 0": f"gamma = {GEAR:g}"})
    shell.run("identify log.csv")
    result = estimate(open_log(Path("log.csv")), read_configuration("log.toml"))
    assert result.sigma == pytest.approx(STIFFNESS, rel=0.04)


def test_a_torque_constant_in_mNm_is_named(m: Motion, shell: Shell) -> None:
    log = {"t": m.t, "motor_rad": m.theta, "link_rad": m.q, "current_A": m.tau / 0.08}
    write_log(log, Path("log.csv"))
    shell.run("init log.csv")
    answers = {"torque_constant = 0": "torque_constant = 80", "gamma = 0": f"gamma = {GEAR:g}"}
    fill_in(Path("log.toml"), answers)
    said = shell.run("check log.csv", status=1)
    assert "ports.tau.torque_constant: the torque constant is 80 N.m/A" in said
    assert "try 0.08" in said


def test_a_torque_without_a_signal(m: Motion, shell: Shell) -> None:
    log = {"t": m.t, "elbow_motor_pos_rad": m.theta, "elbow_link_pos_rad": m.q}
    write_log({**log, "elbow_motor_effort": 0 * m.t}, Path("log.csv"))
    assert "'elbow_motor_effort' is the same throughout" in shell.run("init log.csv")


def test_jitter_does_not_add_digits_to_the_period() -> None:
    t = 2e-3 * np.arange(20_000) + np.random.default_rng(1).normal(0, 1e-5, 20_000)
    assert interval(t) == 2e-3
