"""Tests of `compare` with model errors: list of conditions, simulated samples, score, command."""

import csv
import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from lxml import etree
from PIL import Image

from command_line import Shell
from controllers import run
from plant_runs import QUIET, times
from sigmahat.experiments.engine import computed_table
from sigmahat.experiments.records import NAME
from sigmahat.experiments.scenario import Sine, Sines
from sigmahat.experiments.scores import Score, score
from sigmahat.studies import misfit_run as motion
from sigmahat.studies import misfits
from sigmahat.studies.misfit_experiment import (
    AWAS,
    JOINTS,
    SEA_1K,
    Condition,
    Experiment,
    Group,
    JointKind,
    draw,
)
from sigmahat.studies.misfit_results import COLUMNS, IN_FILE, MisfitRow, printed_table
from sigmahat.studies.misfits import CONDITIONS, Misfits, pairs, settings

EXACT: Mapping[str, float] = {**QUIET, "encoder.theta": 0.0, "encoder.q": 0.0}


def compare(
    conditions: Sequence[Condition],
    joints: Sequence[JointKind],
    seeds: Sequence[int],
    processes: int,
) -> list[MisfitRow]:
    return computed_table(Misfits(conditions, joints, seeds), processes)


BY_NAME = {each.name: each for each in CONDITIONS}


def short(joint: JointKind, name: str = "none", duration: float = 0.5) -> Experiment:
    """The first part of an experiment, measured without quantisation and noise."""
    changed = BY_NAME[name].change(draw(joint, 1)).with_plant(EXACT)
    return replace(changed, duration=duration)


def test_rows_have_names_of_their_own_and_joints() -> None:
    names = [each.name for each in CONDITIONS]
    assert len(set(names)) == len(names)
    assert all(each.joints for each in CONDITIONS)
    assert {each.group for each in CONDITIONS} == set(Group)
    assert pairs([BY_NAME["m = 2, too small"]], JOINTS) == [(BY_NAME["m = 2, too small"], AWAS)]


@pytest.mark.parametrize("late", [0.0, 2.3e-3, -1.7e-3])
def test_the_torque_is_measured_late_or_early(late: float) -> None:
    sines = Sines(0.0, (Sine(0.3, 2.0, 0.5),))
    experiment = replace(short(SEA_1K), torque=sines, late=late, rest=0.1)
    t = times(1e-3, 0.499)
    expected = sines(t - late - 0.1) * (t - late >= 0.1)
    away = np.abs(t - late - 0.1) > 2e-3  # samples not near the torque step
    tau = motion.run(experiment).measured["tau"]
    assert len(tau) == 500
    # The torque between two samples is interpolated linearly, which approximates the sine.
    np.testing.assert_allclose(tau[away], expected[away], rtol=0, atol=0.3 * (4e-3 * math.pi) ** 2)


def test_the_measured_torque_has_gain_and_bias() -> None:
    plain = motion.run(short(AWAS)).measured
    changed = {"sensor.tau_gain": 0.9, "sensor.tau_bias": 0.01}
    wrong = motion.run(replace(short(AWAS).with_plant(changed), late=1e-3)).measured
    late = np.concatenate([[0.0], plain["tau"][:-1]])
    np.testing.assert_allclose(wrong["tau"], (late - 0.01) / 0.9, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(wrong["theta"], plain["theta"])


def test_a_held_torque_is_measured_as_it_begins_or_as_a_mean() -> None:
    command = motion.run(short(SEA_1K)).measured["tau"]
    held = motion.run(short(SEA_1K, "held torque, u(k)")).measured
    mean = motion.run(short(SEA_1K, "held torque, mean of u")).measured
    np.testing.assert_allclose(held["tau"], command, rtol=0, atol=1e-12)
    before = np.concatenate([[0.0], command[:-1]])
    np.testing.assert_allclose(mean["tau"], (command + before) / 2, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(held["theta"], mean["theta"])
    linear = motion.run(short(SEA_1K)).measured["theta"]
    assert 0 < np.abs(held["theta"] - linear).max() < 0.02 * np.ptp(linear)


def test_jitter_moves_the_samples() -> None:
    exact = motion.run(short(AWAS, "none", 2.0)).measured["theta"]
    late = motion.run(short(AWAS, "jitter 5 %", 2.0)).measured["theta"]
    velocity = np.gradient(exact, 1e-3)
    fast = np.abs(velocity) > 0.3 * np.abs(velocity).max()
    moved = ((late - exact) / velocity)[fast] / 1e-3
    assert np.std(moved) == pytest.approx(0.05, rel=0.15)
    assert abs(np.mean(moved)) < 0.01


def test_control_follows_its_reference() -> None:
    experiment = short(SEA_1K, "PD and gravity, one sign of phi", 3.0)
    found = motion.run(experiment)
    control = experiment.control
    assert control is not None
    wanted = control.reference(times(1e-3, 2.999))
    assert wanted[0] == pytest.approx(math.pi / 2)
    assert np.abs(found.measured["theta"] - wanted).max() < 0.1
    assert np.all(found.phi < 0)
    assert found.phi[0] == pytest.approx(-12 / 1000)


def test_the_lever_arm_reaches_the_estimator_as_an_angle() -> None:
    experiment = short(AWAS)
    theta_c = motion.run(experiment).measured["theta_c"]
    r = 0.1 - 0.0025 / (2 * math.pi) * theta_c
    assert experiment.lever_arm is not None
    wanted = experiment.lever_arm(times(1e-3, 0.499))
    assert 0 < np.abs(r - wanted).max() <= 0.0025 / 1024 / 2 * (1 + 1e-9)
    assert not motion.run(short(SEA_1K)).measured["theta_c"].any()


def test_the_score_in_closed_form() -> None:
    true = np.array([100.0, 100.0, 100.0, 200.0, 0.0])
    sigma = np.array([101.0, 115.0, 130.0, 100.0, 50.0])
    sigma_std = np.array([1.0, 1.0, 20.0, 4.0, 1.0])
    confident = np.array([True, True, True, False, True])
    found = score(true, sigma, confident, sigma_std)
    assert found.instants == 4  # without the last instant, whose stiffness is 0
    assert found.figures["error"] == pytest.approx(
        100 * math.sqrt((0.01**2 + 0.15**2 + 0.3**2 + 0.5**2) / 4)
    )
    assert found.figures["claim"] == pytest.approx(
        100 * math.sqrt((0.01**2 + 0.01**2 + 0.2**2 + 0.02**2) / 4)
    )
    assert found.figures["coverage"] == 50  # instants 1 and 3 of 4 are inside
    # Only instant 2 is dangerous: its estimate is wrong with a standard deviation below 2 %.
    assert found.figures["dangerous"] == 25
    assert (found.figures["confident"], found.figures["wrong"]) == (75, 25)


def test_scores_add_up_over_instants() -> None:
    one = score(np.ones(3), np.ones(3) * 1.3, np.ones(3, np.bool_), np.ones(3))
    other = score(np.ones(1), np.ones(1), np.zeros(1, np.bool_), np.zeros(1))
    both = sum([one, other], Score())
    assert both.figures["error"] == pytest.approx(30 * math.sqrt(3 / 4))
    of_both = [both.figures[name] for name in ("coverage", "confident", "wrong")]
    assert of_both == [100, 75, 75]
    assert math.isnan(Score().figures["error"])


def test_a_gain_of_the_torque_is_an_error_of_its_size_that_the_prior_covers() -> None:
    (row,) = compare([BY_NAME["gain 0.9, prior 0.1"]], [AWAS], [1], processes=1)
    factor = 1 / 0.9  # error of the measured torque and of the stiffness
    figures = row.score.figures
    assert figures["error"] == pytest.approx(100 * (factor - 1), abs=0.5)
    assert figures["claim"] == pytest.approx(100 * 0.10 * factor, rel=0.1)
    assert figures["coverage"] > 90


def test_the_estimator_is_given_a_prior_of_the_gain_where_there_is_an_error_of_it() -> None:
    for each in CONDITIONS:
        has_error = each.group in (Group.GAIN, Group.RANDOM)
        assert (each.torque_gain > 0) is has_error
        assert settings(draw(AWAS, 1), each.torque_gain)["prior.torque_gain"] == each.torque_gain


def of_random_joints(seeds: range) -> list[Score]:
    """Scores for each kind of joint."""
    random = [each for each in CONDITIONS if each.group is Group.RANDOM]
    return [row.score for row in compare(random, JOINTS, seeds, processes=2)]


@pytest.mark.slow("60 joints of 20 s are simulated and estimated")
def test_a_confident_estimate_is_right() -> None:
    """Tests what docs/filtered-regression/index.md promises for confident estimates."""
    together = sum(of_random_joints(range(401, 421)), Score())
    assert together.figures["wrong"] <= 0.002 * together.figures["confident"]
    assert together.figures["coverage"] >= 90


@pytest.mark.complete
@pytest.mark.slow("120 joints of 20 s are simulated and estimated")
def test_what_confident_means() -> None:
    """The same with more joints, which also show how often an estimate is confident."""
    found = of_random_joints(range(401, 441))
    assert found[JOINTS.index(AWAS)].figures["error"] <= 5.0
    together = sum(found, Score())
    assert together.figures["confident"] >= 88
    assert together.figures["wrong"] <= 0.002 * together.figures["confident"]
    assert together.figures["coverage"] >= 90


# Printed text, files and figures of the command

FILES = ("misfits.png", "misfits.svg", "misfits.csv")
NAMES = ("none", "uneven Coulomb friction 20 %", "n = 1, too small")


@pytest.fixture(scope="module")
def rows() -> list[MisfitRow]:
    """Seven rows of the table: two conditions of all joints, and one condition of the AwAS."""
    return compare([BY_NAME[name] for name in NAMES], JOINTS, [1], processes=2)


def test_rows_are_judged(rows: list[MisfitRow]) -> None:
    *of_all, of_awas = NAMES
    expected = [*product(of_all, JOINTS), (of_awas, AWAS)]
    assert [(row.condition.name, row.joint) for row in rows] == expected
    assert {row.score.instants for row in rows} == {18000}
    both = [row for row in rows if row.joint is AWAS and row.condition.name in NAMES[:2]]
    clean, uneven = (row.score.figures for row in both)
    assert clean["error"] < 1.0 and clean["coverage"] > 80 and clean["confident"] == 100
    assert uneven["error"] != clean["error"]


def test_printed_table(rows: list[MisfitRow]) -> None:
    head, *lines = printed_table(rows).splitlines()
    assert head.split() == [word for name in COLUMNS for word in (name, "[%]")]
    groups = [line for line in lines if line and not line.startswith(" ")]
    assert groups == ["clean", "class 1", "class 2"]
    printed = [line for line in lines if line.startswith("  ") and "mean of" not in line]
    for row, line in zip(rows, printed, strict=True):
        assert line.startswith(f"  {row.condition.name}, {row.joint.name} ")
        cells = [float(cell) for cell in line.split()[-len(COLUMNS) :]]
        assert cells == pytest.approx([row.score.figures[name] for name in COLUMNS], abs=0.05)


@pytest.mark.slow("the fixture runs seven rows, the command two in processes of its own")
def test_command(rows: list[MisfitRow], shell: Shell, monkeypatch: pytest.MonkeyPatch) -> None:
    few = rows[-1:]
    monkeypatch.setattr(misfits, "CONDITIONS", [row.condition for row in few])
    out = Path("out").absolute()
    command = f"compare --misfits --seeds 1 --jobs 1 --out {out}"
    printed = shell.run(command)
    assert printed_table(few) in printed
    assert "1 seed." in printed and str(out) in printed
    assert {path.name for path in out.iterdir()} == {*FILES, NAME}
    with (out / "misfits.csv").open(newline="") as file:
        lines = list(csv.DictReader(file))
    for row, line in zip(few, lines, strict=True):
        assert (line["condition"], line["joint"]) == (row.condition.name, row.joint.name)
        assert line["class"] == row.condition.group.value
        for name in COLUMNS:
            assert float(line[f"{IN_FILE.get(name, name)} [%]"]) == row.score.figures[name]
    with Image.open(out / "misfits.png") as image:
        assert image.width > 800 and len(image.convert("RGB").getcolors(10**6)) > 10
    svg = etree.parse(out / "misfits.svg").getroot()
    assert svg.tag.endswith("svg")

    printed_values = shell.json(command)
    assert printed_values["units"] == dict.fromkeys(COLUMNS, "%")
    values = printed_values["table"]
    assert [value["error"] for value in values] == [row.score.figures["error"] for row in few]
    assert not any(math.isnan(value["claim"]) for value in values)


OWN = """
CONDITIONS = (Condition(Group.NONE, "softer", _plant(spring__k_1=500.0), (SEA_1K,)),)
"""
RUN = """
from pathlib import Path
from my_misfits import CONDITIONS, JOINTS, Misfits
from sigmahat.experiments.engine import study
if __name__ == "__main__":
    plan = Misfits(CONDITIONS, JOINTS, seeds=[1, 2])
    print(plan.text(study(plan, Path("my-misfits"))))
"""


@pytest.mark.slow("two runs in processes of their own")
def test_a_copy_of_the_plan_can_be_changed_and_run(tmp_path: Path) -> None:
    plan = Path(str(misfits.__file__)).read_text(encoding="utf-8")
    (tmp_path / "my_misfits.py").write_text(plan + OWN, encoding="utf-8")
    (tmp_path / "run.py").write_text(RUN, encoding="utf-8")
    printed = run(sys.executable, "run.py", cwd=tmp_path)
    assert "softer, SEA1k" in printed and "2 seeds" in printed
    assert {path.name for path in (tmp_path / "my-misfits").iterdir()} == {*FILES, NAME}
