"""`sigmahat check`: wrong configurations of one good log, and good logs."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from checked_logs import GEAR, KNEE, RIGHT, SINES, WRONG, Array, joint_log, knee_log
from recorded_logs import CONFIGURATION, awas_log, write_log
from sigmahat.checks.check import check
from sigmahat.checks.findings import Checked, Kind, Severity
from sigmahat.checks.text import sentence
from sigmahat.cli import main
from sigmahat.fmi.instance import Slave, installed
from sigmahat.joint.curve import stiffness_in_the_middle
from sigmahat.logs.configuration import read_configuration
from sigmahat.logs.job import Replay
from sigmahat.logs.log import LogInMemory


def checked(columns: Mapping[str, Array], text: str, folder: Path) -> Checked:
    path = folder / "log.toml"
    path.write_text(text)
    return check(LogInMemory(Path("log"), columns), read_configuration(path))


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_key_is_named_first(name: str, tmp_path: Path) -> None:
    old, new, keys = WRONG[name]
    assert old in RIGHT
    found = checked(knee_log(), RIGHT.replace(old, new), tmp_path)
    if name == "torque constant + 10 %":  # no log can show it
        assert not found.is_wrong
        assert keys[0] in [each.key for each in found.of(Severity.RESTS_ON)]
    else:
        (first,) = found.of(Severity.WRONG)
        assert first.key in keys
        assert first.key in sentence(first)


PROPOSED = {
    "torque sign": 1.0,
    "link sign": 1.0,
    "link offset 1 degree": pytest.approx(0.0, abs=0.01),
    "degrees as rad": "deg",
    "counts per turn x 4": 4096.0,
    "theta without its gear": 100.0,
    "gamma 80": 100.0,
    "torque 10 ms late": pytest.approx(0.010, abs=0.0005),
    "torque geared twice": 1.0,
}


@pytest.mark.parametrize("name", PROPOSED)
def test_the_proposed_value_is_the_right_one(name: str, tmp_path: Path) -> None:
    old, new, _ = WRONG[name]
    found = checked(knee_log(), RIGHT.replace(old, new), tmp_path)
    assert found.of(Severity.WRONG)[0].proposed == PROPOSED[name]


def test_a_proposed_delay_puts_the_torque_right(tmp_path: Path) -> None:
    late = RIGHT.replace('"current"', '"late_current"\ndelay = 0.010')
    assert not checked(knee_log(), late, tmp_path).is_wrong


@pytest.mark.parametrize("gear", [10.0, 1000.0, 0.01, -100.0, 101.0])
@pytest.mark.parametrize("gamma", [True, False])
def test_a_wrong_gear_ratio_is_named_with_the_right_one(
    gear: float, gamma: bool, tmp_path: Path
) -> None:
    """Whether motor.gamma is as wrong, because it is that of the encoder, or right."""
    text = RIGHT.replace("gear_ratio = 100", f"gear_ratio = {gear}")
    if gamma:
        text = text.replace("gamma = 100", f"gamma = {abs(gear)}")
    first = checked(knee_log(), text, tmp_path).of(Severity.WRONG)[0]
    assert (first.key, first.proposed) == ("ports.theta.gear_ratio", 100.0)


def test_columns_that_are_swapped_are_said_as_that(tmp_path: Path) -> None:
    text = RIGHT.replace("motor_counts", "X").replace("link_deg", "motor_counts")
    (found,) = checked(knee_log(), text.replace("X", "link_deg"), tmp_path).of(Severity.WRONG)
    assert (found.key, found.proposed) == ("ports.theta.column", "motor_counts")
    assert "swapped" in sentence(found)


def test_what_identify_will_set_is_no_finding_before_it(tmp_path: Path) -> None:
    text = RIGHT.replace("range.phi = 0.03\n", "").replace("prior.tau_e = 20\n", "")
    text = text.replace("B = 1.05e-4", "B = 2.3e-5").replace("prior.B = 0.1", "prior.B = 1000")
    strong = {**KNEE, "spring.k_1": 2e4, "motor.gamma": GEAR, "motor.B": 2e-3}
    for plant in (KNEE, strong):
        log = joint_log(plant, 1e-3, 400.0)
        columns = {
            "t": log["t"],
            "motor_counts": np.round(log["theta"] * 409600 / 6.283185307179586),
        }
        columns |= {"link_deg": np.degrees(log["q"]), "current": log["tau"] / 0.05}
        found = checked(columns, text.replace("zero = 1500\n", ""), tmp_path)
        assert [sentence(each) for each in found.of(Severity.WRONG)] == []


@pytest.mark.parametrize(
    ("still", "words"),
    [
        (["motor_counts", "link_deg"], "the joint is at rest"),
        (["link_deg"], "the link does not move while the motor does"),
        (["motor_counts"], "the motor does not move while the link does"),
    ],
)
def test_positions_that_do_not_change(still: list[str], words: str, tmp_path: Path) -> None:
    log = {name: np.full_like(c, c[0]) if name in still else c for name, c in knee_log().items()}
    (found,) = checked(log, RIGHT, tmp_path).of(Severity.WRONG)
    assert words in sentence(found)


def test_a_link_that_is_locked_on_purpose_needs_no_column(tmp_path: Path) -> None:
    plant = {**KNEE, "contact.k": 1e7, "contact.d": 1e3}
    log = joint_log(plant, 1e-3)
    text = parameters(KNEE, 1e-3).replace('[ports.q]\ncolumn = "q"', "[ports.q]\nvalue = 0")
    assert not checked({n: log[n] for n in ("t", "theta", "tau")}, text, tmp_path).is_wrong
    with Slave(installed("StiffnessEstimator"), "estimator") as slave:
        columns = LogInMemory(Path("log"), {n: log[n] for n in ("t", "theta", "tau")})
        replay = Replay(slave, columns, read_configuration(tmp_path / "log.toml"))
        replay.run()
        branch = replay.answer().curve.branches[0]
    _, _, interval = stiffness_in_the_middle(branch)
    assert interval is not None
    low, high = interval
    assert low < KNEE["spring.k_1"] < high < 1.2 * low


def parameters(plant: Mapping[str, float], T: float) -> str:
    """A configuration of a joint in rad and N.m, its motor data some per cent wrong."""
    ports = "".join(f'[ports.{name}]\ncolumn = "{name}"\n' for name in ("theta", "q", "tau"))
    return f"""\
[time]
column = "t"
{ports}
[parameters]
samplePeriod = {T}
method = "FilteredRegression"
motor.B = {1.05 * plant["motor.B"]}
motor.D_theta = {0.9 * plant["motor.D_theta"]}
motor.gamma = {plant["motor.gamma"]}
prior.B = 0.1
encoder.theta = {plant["encoder.theta"]}
encoder.q = {plant["encoder.q"]}
rls.m = 1
"""


GOOD = {
    "stiff at 4 ms": ({"spring.k_1": 3000.0, "motor.gamma": 160.0}, 4e-3, 0.0),
    "hardening with gravity": (
        {"spring.k_1": 100.0, "spring.k_3": 2e4, "link.mgl": 3.0, "motor.gamma": 50.0},
        2e-3,
        0.0,
    ),
    "soft under a load": ({"spring.k_1": 80.0, "link.mgl": 5.0, "motor.gamma": 30.0}, 2e-3, -3.0),
    "coarse encoders": ({"encoder.theta": 51200.0, "encoder.q": 8192.0}, 1e-3, 0.0),
    "friction of other forms": (
        {"motor.load_friction": 0.1, "motor.stribeck": 0.3, "motor.uneven": 0.1}
        | {"spring.damping": 1e-3, "spring.dahl": 0.2},
        1e-3,
        0.0,
    ),
}


@pytest.mark.parametrize("name", GOOD)
def test_no_false_alarm(name: str, tmp_path: Path) -> None:
    changed, T, load = GOOD[name]
    plant = {**KNEE, **changed}
    found = checked(joint_log(plant, T, load), parameters(plant, T), tmp_path)
    assert [sentence(each) for each in found.of(Severity.WRONG)] == []


def test_no_false_alarm_with_a_set_point(tmp_path: Path) -> None:
    text = CONFIGURATION.replace("[parameters]", '[parameters]\nmethod = "FilteredRegression"')
    found = checked(awas_log(1.0, 0.3), text, tmp_path)
    assert [sentence(each) for each in found.of(Severity.WRONG)] == []


def test_a_wrong_sign_of_theta_and_torque_is_that_of_the_link(tmp_path: Path) -> None:
    text = parameters(KNEE, 1e-3)
    for name in ("theta", "tau"):
        text = text.replace(f'column = "{name}"', f'column = "{name}"\nsign = -1')
    (found,) = checked(joint_log(KNEE, 1e-3), text, tmp_path).of(Severity.WRONG)
    assert (found.key, found.proposed) == ("ports.q.sign", -1.0)


def test_a_counter_that_wraps_is_named_with_its_period(tmp_path: Path) -> None:
    wrapped = {**knee_log(), "motor_counts": np.mod(knee_log()["motor_counts"], 4096)}
    (found,) = checked(wrapped, RIGHT, tmp_path).of(Severity.WRONG)
    assert (found.kind, found.key) == (Kind.JUMP, "ports.theta.wrap")
    assert found.proposed == 4096


def test_a_torque_behind_the_gear_shows_in_the_inertia(tmp_path: Path) -> None:
    log = joint_log(KNEE, 1e-3)
    (found,) = checked({**log, "tau": GEAR * log["tau"]}, parameters(KNEE, 1e-3), tmp_path).of(
        Severity.WRONG
    )
    assert (found.key, found.proposed) == ("ports.tau.gear_ratio", GEAR)


def test_a_torque_that_saturates_is_noted(tmp_path: Path) -> None:
    log = joint_log(KNEE, 1e-3)
    limit = 0.8 * sum(A for A, *_ in SINES)
    flat = {**log, "tau": np.clip(log["tau"], -limit, limit)}
    found = checked(flat, parameters(KNEE, 1e-3), tmp_path)
    assert Kind.SATURATION in [each.kind for each in found.findings]


@pytest.mark.slow("five commands, identify and estimate among them")
def test_the_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    write_log(knee_log(), Path("knee.csv"))
    Path("knee.toml").write_text(RIGHT)
    assert main(["check", "knee.csv"]) == 0
    assert "nothing" in capsys.readouterr().out
    Path("wrong.toml").write_text(RIGHT.replace("= 4096", "= 16384"))
    assert main(["check", "knee.csv", "--config", "wrong.toml", "--json"]) == 1
    result = json.loads(capsys.readouterr().out)
    (wrong,) = [each for each in result["findings"] if each["severity"] == "wrong"]
    assert (wrong["key"], wrong["proposed"]) == ("ports.theta.counts_per_turn", 4096)
    assert main(["check", "knee.csv", "--config", "none.toml"]) == 2
    assert capsys.readouterr().err.startswith("sigmahat: error: none.toml: No such file")
    # THEN identify and estimate end with the same
    assert main(["identify", "knee.csv", "--config", "wrong.toml", "--dry-run"]) == 0
    assert "ports.theta.counts_per_turn" in capsys.readouterr().out
    assert main(["estimate", "knee.csv", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["checks"]["wrong"] is False
