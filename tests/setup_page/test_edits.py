"""Edits of a configuration give the same file as edits by hand in a text editor."""

from pathlib import Path

import numpy as np
import pytest
import tomlkit

from checked_logs import knee_log
from recorded_logs import write_log
from sigmahat.recording.configuration import read_document
from sigmahat.recording.readers.formats import open_log
from sigmahat.recording.several_joints import of_joint
from sigmahat.setup_page.background import guessed
from sigmahat.setup_page.edits import (
    Field,
    comment_of,
    items,
    remove_value,
    set_value,
    to_fill_in,
    value_of,
)
from sigmahat.setup_page.inputs import Input
from sigmahat.setup_page.setup import Setup

FILE = """\
# of mine
[ports.theta]   # the motor
column = "m"
unit = "counts"
counts_per_turn = 0   # FILL IN: of the encoder
sign = 1   # measured on Monday
[parameters]
motor.B = 2.3e-05   # [kg.m2] not known: of another robot, until identify finds it or you set it
"prior.B" = 1000
torque.held = true   # CHECK: the log repeats values
"""
EDITED = """\
# of mine
[ports.theta]   # the motor
column = "m"
counts_per_turn = 4096
sign = -1   # measured on Monday
[parameters]
motor.B = 0.0001
"prior.B" = 0.1
torque.held = false
range.phi = 0.02
method = "Paper2011"
"""


def test_a_value_is_set_and_comments_stay_if_they_are_still_true() -> None:
    document = tomlkit.parse(FILE)
    assert to_fill_in(document) == ["ports.theta.counts_per_turn"]
    assert comment_of(document, "ports.theta.counts_per_turn") == "FILL IN: of the encoder"
    set_value(document, "ports.theta.counts_per_turn", 4096.0)
    set_value(document, "ports.theta.sign", -1)
    set_value(document, "motor.B", 1e-4)
    set_value(document, "prior.B", 0.1)
    set_value(document, "torque.held", False)
    set_value(document, "range.phi", 0.02)
    set_value(document, "method", "Paper2011")
    remove_value(document, "ports.theta.unit")
    remove_value(document, "motor.gamma")
    assert tomlkit.dumps(document) == EDITED
    assert to_fill_in(document) == []


def setup_of(columns: dict[str, object], folder: Path) -> Setup:
    """Writes a log and returns a setup with a configuration as `init` would propose it."""
    log = open_log(write_log(columns, folder / "leg.parquet"))  # type: ignore[arg-type]
    setup = Setup(log, folder / "leg.toml")
    setup.guessed(*guessed(log))
    return setup


def test_a_unit_brings_the_keys_that_it_needs(tmp_path: Path) -> None:
    setup = setup_of(dict(knee_log()), tmp_path)
    assert setup.get("ports.q.step") == pytest.approx(360 / 262144, rel=1e-9)
    setup.set("ports.q.unit", "counts")
    assert setup.get("ports.q.counts_per_turn") == 0
    assert setup.get("encoder.q") is None and setup.get("ports.q.step") is None
    assert "ports.q.counts_per_turn" in setup.open_keys
    setup.set("ports.q.unit", "deg")
    assert setup.get("ports.q.counts_per_turn") is None
    assert setup.get("encoder.q") == 0
    setup.set("ports.tau.unit", "N.m")
    assert setup.get("ports.tau.torque_constant") is None


def test_an_open_question_is_a_choice_to_be_made(tmp_path: Path) -> None:
    """GIVEN a unit that only the user knows, THEN it stays open until the user chooses one."""
    log = knee_log()
    columns = {"t": log["t"], "theta": log["motor_counts"], "q_deg": log["link_deg"]}
    setup = setup_of({**columns, "tau": 0.05 * log["current"]}, tmp_path)
    assert {"ports.tau.unit", "ports.tau.gear_ratio"} <= set(setup.open_keys)
    assert setup.get("ports.tau.unit") is None
    unit = Input(setup, "ports.tau.unit", Field("unit", "unit", "N.m", items(["N.m", "A"]), str))
    unit.show()
    assert (unit.widget.value, unit.widget.css_classes) == ("FILL IN", ["open"])
    unit.widget.value = "N.m"
    unit.show()
    assert (unit.widget.value, unit.widget.css_classes) == ("N.m", [])
    assert ("FILL IN", "choose") not in unit.widget.options
    setup.set("ports.tau.gear_ratio", 1.0)
    assert not {"ports.tau.unit", "ports.tau.gear_ratio"} & set(setup.open_keys)


def test_a_deformation_is_a_port_of_the_page(tmp_path: Path) -> None:
    log = knee_log()
    theta = 2 * np.pi * (log["motor_counts"] - 1500) / (4096 * 100)
    phi = np.radians(log["link_deg"]) - theta
    columns = {"t": log["t"], "motor_pos_rad": theta, "spring_deflection_rad": phi}
    setup = setup_of({**columns, "motor_torque_Nm": 0.05 * log["current"]}, tmp_path)
    assert setup.get("ports.phi.column") == "spring_deflection_rad"
    assert (setup.get("ports.phi.sign"), setup.get("ports.q.column")) == (1, None)
    setup.set("ports.phi.unit", "counts")
    assert "ports.phi.counts_per_turn" in setup.open_keys
    setup.set("ports.phi.column", None)
    assert setup.get("ports.phi.column") is None


def test_another_column_is_guessed_anew(tmp_path: Path) -> None:
    """GIVEN a new column of a port, THEN marks of unknown values of the old column disappear."""
    setup = setup_of({**knee_log(), "motor_deg": 3.6e4 * knee_log()["t"] % 360}, tmp_path)
    setup.set("ports.theta.column", "motor_deg")
    assert (setup.get("ports.theta.unit"), setup.get("ports.theta.wrap")) == ("deg", 360)
    assert setup.get("ports.theta.counts_per_turn") is None
    setup.set("ports.theta.column", None)
    assert value_of(setup.document, "ports.theta.column") is None
    assert "theta" not in setup.get("ports.q.column")


def test_joints_have_one_file_and_edits_of_their_own(tmp_path: Path) -> None:
    knee = knee_log()
    columns: dict[str, object] = {"t": knee["t"]}
    for joint in ("hip", "knee"):
        columns[f"{joint}_motor_counts"] = knee["motor_counts"]
        columns[f"{joint}_link_deg"] = knee["link_deg"]
        columns[f"{joint}_current_A"] = knee["current"]
    setup = setup_of(columns, tmp_path)
    setup.set("ports.tau.torque_constant", 0.07)
    setup.set_joint("knee")
    assert setup.get("ports.tau.torque_constant") == 0
    assert setup.write_draft() == tmp_path / "leg.draft.toml"
    assert setup.write_draft() == tmp_path / "leg.draft-2.toml"
    setup.write(overwrite=False)
    assert setup.write_draft() is None
    found = read_document(tmp_path / "leg.toml")
    for joint, constant in (("hip", 0.07), ("knee", 0)):
        assert of_joint(found, joint)["ports"]["tau"]["torque_constant"] == constant
    again = Setup(setup.log, setup.path)
    again.start_from(found)
    again.set_joint("knee")
    assert again.text_of_file == setup.text_of_file


def test_a_file_that_exists_is_overwritten_on_demand_only(tmp_path: Path) -> None:
    setup = setup_of(dict(knee_log()), tmp_path)
    setup.path.write_text("# of somebody else\n")
    setup.write(overwrite=True)  # without confirmation by the user
    assert setup.path.read_text() == "# of somebody else\n"
    setup.write(overwrite=False)
    assert setup.asks_to_overwrite
    assert setup.path.read_text() == "# of somebody else\n"
    setup.write(overwrite=True)
    assert not setup.asks_to_overwrite
    assert setup.path.read_text() == setup.text
