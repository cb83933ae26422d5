"""Right configurations of joints with unmodelled effects, which `check` must not accuse."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
import tomlkit

import robot
from checked_logs import (
    GEAR,
    RIGHT,
    Array,
    as_recorded,
    knee_log,
    log_of_teaching,
    log_with_rests,
    stiff_log,
)
from drawn_joints import MOTIONS, DrawnJoint, drawn_joint
from recorded_logs import in_memory
from shared_data import data_folder
from sigmahat.checks.check import check, check_identified
from sigmahat.checks.findings import Checked, Finding, Kind, Severity
from sigmahat.checks.text import sentence, summary
from sigmahat.motor.identify import identify
from sigmahat.motor.write import update
from sigmahat.recording.configuration import checked_configuration
from sigmahat.recording.log import LogInMemory
from sigmahat.recording.readers.formats import open_log

JOINTS = range(1, 21)


def checked(columns: Mapping[str, Array], text: str) -> Checked:
    return check(LogInMemory(Path("log"), columns), in_memory(text))


def wrong(columns: Mapping[str, Array], text: str) -> list[Finding]:
    return [*checked(columns, text).of(Severity.WRONG)]


@pytest.mark.parametrize(("seed", "motion"), [(2, "sines"), (5, "slow"), (8, "pushed")])
def test_nobody_who_is_right_is_accused(seed: int, motion: str) -> None:
    joint = drawn_joint(seed)
    log = joint.log(motion, 8.0)
    for is_motor_known in (True, False):
        assert wrong(log, joint.configuration(is_motor_known)) == []


WRONG = {
    "gear ratio": ("gear", "ports.theta.gear_ratio"),
    "sign of the torque": ("ports.tau.sign = -1", "ports.tau.sign"),
    "unit of the torque": ("ports.tau.scale = 1000", "motor.B"),
}


def with_error(joint: DrawnJoint, error: str) -> str:
    text = joint.configuration(is_motor_known=True)
    if error == "gear":
        return text.replace(f"gear_ratio = {joint.gear}", f"gear_ratio = {2 * joint.gear}")
    return f"{error}\n{text}"


@pytest.mark.parametrize("name", WRONG)
def test_an_error_of_the_same_joint_is_found(name: str) -> None:
    error, key = WRONG[name]
    joint = drawn_joint(2)
    found = wrong(joint.log("sines", 8.0), with_error(joint, error))
    assert key in [key for each in found for key in each.keys]


@pytest.mark.complete
@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("seed", JOINTS)
def test_nobody_is_accused_before_and_after_identify(seed: int, motion: str) -> None:
    joint = drawn_joint(seed)
    log = LogInMemory(Path("log"), joint.log(motion, 20.0))
    for is_motor_known in (True, False):
        document = tomlkit.parse(joint.configuration(is_motor_known))
        before = checked_configuration(document, Path("log.toml"))
        found = list(check(log, before).of(Severity.WRONG))
        update(document, identify(log, before))
        after = checked_configuration(document, Path("log.toml"))
        found += check_identified(log, before, after).of(Severity.WRONG)
        assert [sentence(each) for each in found] == []


@pytest.mark.parametrize("run", robot.RUNS)
def test_an_axis_of_a_robot_that_the_model_does_not_fit(run: str) -> None:
    """GIVEN axis 2, WHEN its noise is not known yet, THEN one note says that the model does not
    fit, instead of the misfit of the estimator, and no key is wrong."""
    log = open_log(data_folder("kr300", "kr300_a.csv") / f"kr300_{run}.csv")
    gear, inertia, _ = robot.AXES[2]
    given = {"axis": 2, "gear": gear, "inertia": inertia, "delay": robot.DELAY}
    found = check(log, in_memory(robot.CONFIGURATION.format(**given)))
    kinds = [each.kind for each in found.findings if each.severity is not Severity.RESTS_ON]
    assert not found.is_wrong
    assert kinds[0] is Kind.UNEXPLAINED
    assert Kind.MISFIT not in kinds


def test_with_the_torque_of_another_joint_too_no_key_is_wrong() -> None:
    log = knee_log()
    other = 2.0 * np.sin(2 * np.pi * 0.83 * np.asarray(log["t"]))
    found = checked({**log, "current": log["current"] + other}, RIGHT)
    assert not found.is_wrong
    (note,) = [each for each in found.findings if each.kind is Kind.UNEXPLAINED]
    assert note.key == "ports.tau.column"
    assert 0.14 < note.measured < 1.0
    assert "the model does not fit" in sentence(note)
    assert "contradicts" not in summary(found)
    assert "the model does not fit the log" in summary(found).splitlines()[0]


def test_the_power_of_friction_shows_the_sign_of_the_torque() -> None:
    """GIVEN a stiff joint in slow motion, whose deformation is only the noise of its encoders."""
    joint = stiff_log()
    log = as_recorded(joint)
    assert wrong(log, RIGHT) == []
    (found,) = wrong({**log, "current": -log["current"]}, RIGHT)
    assert (found.kind, found.key, found.proposed) == (Kind.SIGN, "ports.tau.sign", -1.0)
    assert "friction takes power" in sentence(found)
    power = GEAR * float(np.mean(joint["tau"] * np.gradient(joint["theta"], joint["t"])))
    assert found.measured == pytest.approx(power, rel=0.05)


def test_a_torque_that_is_a_function_of_the_position_is_no_wrong_gear_ratio() -> None:
    """GIVEN gravity compensation, which explains the torque better than the motor equation does,
    with any gear ratio, and a motor that is not known."""
    log, text = log_of_teaching(), RIGHT.replace("motor.B = 1.05e-4", "motor.B = 2.3e-5")
    text = text.replace("prior.B = 0.1", "prior.B = 1000\nprior.D_theta = 1000")
    text = text.replace("range.phi = 0.03", "range.phi = 0.05")
    assert not checked(log, text).is_wrong
    # A wrong sign is found.
    found = checked({**log, "current": -log["current"]}, text).of(Severity.WRONG)
    assert [(each.key, each.proposed) for each in found] == [("ports.tau.sign", -1.0)]


def test_the_friction_of_an_arm_that_stands_still_is_no_misfit() -> None:
    """GIVEN the knee with a weight, between poses at each of which static friction holds as much of
    the torque as it happens to.
    WHEN the torque is that of another joint, too, THEN the model does not fit."""
    log = log_with_rests()
    found = checked(log, RIGHT)
    assert not found.is_wrong
    assert Kind.UNEXPLAINED not in [each.kind for each in found.findings]
    other = 0.4 * np.sin(2 * np.pi * 0.83 * log["t"])
    found = checked({**log, "current": log["current"] + other}, RIGHT)
    assert Kind.UNEXPLAINED in [each.kind for each in found.findings]
