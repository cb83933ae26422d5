"""From a log of several joints to one report, as a user goes; the joints are simulated by scipy."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import tomlkit

from foreign_joint import GEAR, STIFFNESS, TORQUE_CONSTANT, joint
from recorded_logs import write_log
from sigmahat.cli import main
from sigmahat.logs.joints import of_joint

COUNTS = 16384


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A log of two joints of one stiffness, and its configuration as a user completes it.

    The drive of the knee shows half of the current.
    """
    motion, log = joint(False), {}
    log["t"] = motion.t
    for name, share in (("hip", 1.0), ("knee", 0.5)):
        log[f"{name}_motor_counts"] = np.round(motion.theta * GEAR * COUNTS / (2 * np.pi))
        log[f"{name}_link_rad"] = motion.q
        log[f"{name}_current_A"] = share * motion.tau / TORQUE_CONSTANT
    folder = tmp_path_factory.mktemp("leg")
    write_log(log, folder / "leg.csv")
    return folder


@pytest.fixture(autouse=True)
def _in_the_folder(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)


def test_from_the_log_to_one_report(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["init", "leg.csv"]) == 0
    document = tomlkit.parse(Path("leg.toml").read_text())
    theta, tau = document["ports"]["theta"], document["ports"]["tau"]
    theta["counts_per_turn"], theta["gear_ratio"] = COUNTS, GEAR
    tau["torque_constant"] = TORQUE_CONSTANT
    of_knee = document["joints"]["knee"]["ports"]["tau"]
    of_knee["torque_constant"] = 2 * TORQUE_CONSTANT
    of_knee["torque_constant"].comment("its drive shows half of the current")
    Path("leg.toml").write_text(tomlkit.dumps(document))

    assert main(["identify", "leg.csv"]) == 0
    text = Path("leg.toml").read_text()
    assert "# its drive shows half of the current" in text
    assert "motor.B" not in tomlkit.dumps(tomlkit.parse(text)["parameters"])  # each has its own
    capsys.readouterr()
    assert main(["check", "leg.csv"]) == 0
    assert capsys.readouterr().out.count("nothing in 7 s of the log contradicts") == 2

    assert main(["estimate", "leg.csv", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["joints"]
    for name in ("hip", "knee"):
        low, high = found[name]["curve"][1]["interval [N.m/rad]"]
        assert low < STIFFNESS < high
        assert high - low < 0.12 * STIFFNESS
        assert found[name]["answer"].endswith("confident")
    assert main(["report", "sigmahat-results/leg"]) == 0
    page = Path("sigmahat-results/leg/report.html").read_text(encoding="utf-8")
    assert "hip: Stiffness against deformation" in page
    assert "knee: Stiffness against deformation" in page
    # The motor is in one column each: the first log confirms itself for every joint, or for none.
    assert main(["validate", "leg.csv", "--with", "leg.toml"]) == 1
    assert capsys.readouterr().out.count("learned before from leg.csv") == 2


def test_one_of_them_by_its_name(capsys: pytest.CaptureFixture[str]) -> None:
    """It is estimated as from a configuration of its own."""
    whole = tomlkit.parse(Path("leg.toml").read_text())
    Path("knee.toml").write_text(tomlkit.dumps(of_joint(whole, "knee")))
    answers = []
    for options in (["--joint", "knee"], ["--config", "knee.toml"]):
        capsys.readouterr()
        assert main(["estimate", "leg.csv", "--out", "out", "--json", *options]) == 0
        answers.append(json.loads(capsys.readouterr().out))
    assert answers[0] == answers[1]


@pytest.mark.parametrize(
    ("joint", "words"),
    [("knees", "unknown joint 'knees'; did you mean 'knee'"), ("hip", "of one joint, expected no")],
)
def test_a_name_that_is_not_there(
    joint: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    config = "knee.toml" if joint == "hip" else "leg.toml"
    assert main(["check", "leg.csv", "--config", config, "--joint", joint]) == 2
    assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('[joints."../x".ports.q]\ncolumn = "t"', "[joints] has the name '../x'"),
        ("joints = {a1 = 3}", "expected a table [joints.a1], got 3"),
        ('[joints.a.port.q]\ncolumn = "t"', "unknown section 'port'; did you mean 'ports'"),
        (
            '[joints.a.ports.q]\ncolumn = "t"\n[joints.b.ports.q]\ncolumn = "t"',
            "joint a: two.toml: identify needs [ports.theta]",
        ),
    ],
)
def test_a_configuration_that_is_wrong(
    text: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("two.toml").write_text(text)
    assert main(["identify", "leg.csv", "--config", "two.toml"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line.replace("joint b", "joint a")
    assert Path("two.toml").read_text() == text
