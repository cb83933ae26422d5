"""`sigmahat validate`: whether a second log of a joint confirms what was learned from the first."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from recorded_logs import CONFIGURATION, Array, awas_log, write_log
from sigmahat.cli import main
from sigmahat.validation.agreement import agreement

REGRESSION = CONFIGURATION + 'method = "FilteredRegression"\nrls.n = 3\nprior.B = 0.2\n'
DURATION = 10.0
SOFT = {"spring.k_s": 0.8 * 14220.0}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which a first log was learned from, with three others."""
    folder = tmp_path_factory.mktemp("validate")
    write_log(awas_log(1.0, 0.3, DURATION), folder / "knee.parquet")
    write_log(awas_log(1.3, 0.3, DURATION, seed=2), folder / "same.parquet")
    write_log(awas_log(1.3, 0.3, DURATION, seed=2, plant=SOFT), folder / "softer.parquet")
    at_rest = awas_log(1.0, 0.3, 3.0, seed=3)
    still = {name: np.full_like(values, values[0]) for name, values in at_rest.items()}
    write_log({**still, "t": at_rest["t"]}, folder / "still.parquet")
    (folder / "knee.toml").write_text(REGRESSION)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr("sigmahat.logs.estimate._save_figure", lambda *_: None)
        assert main(["estimate", "knee.parquet", "--quiet"]) == 0
    return folder


@pytest.fixture(autouse=True)
def here(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)


def validate(
    log: str, expected: int, capsys: pytest.CaptureFixture[str], *options: str
) -> dict[str, Any]:
    """The result of a validation with --json."""
    assert main(["validate", log, "--with", "knee.toml", "--json", *options]) == expected
    captured = capsys.readouterr()
    assert captured.err == ""
    result: dict[str, Any] = json.loads(captured.out)
    return result


# ---- the command --------------------------------------------------------------------------------


def test_another_log_of_the_same_joint_agrees(capsys: pytest.CaptureFixture[str]) -> None:
    result = validate("same.parquet", 0, capsys)
    assert result["agree"] is True and not result["repeated"]
    assert result["z"] < 1.96
    assert result["learned_from"] == ["knee.parquet"]
    assert result["start_from"] == "sigmahat-results/knee/state.json"
    assert result["this log within learned"] > 0.9 and result["learned within this log"] > 0.9
    assert result["overlap"] > 0.99
    # THEN the torque is explained, and below 2 Hz better, where there is less noise
    assert result["torque"]["relative [1]"] < 0.05
    assert result["torque below 2 Hz"]["relative [1]"] < 0.02
    assert 0.9 < result["torque"]["share"] <= 1.0
    # THEN the stiffness is that of the plant, as the median over the log
    true = np.median(awas_log(1.3, 0.3, DURATION, seed=2)["true"])
    for name in ("stiffness learned [N.m/rad]", "stiffness of this log [N.m/rad]"):
        value, half = result[name]
        assert abs(value - true) < half + 0.02 * true


def test_a_softer_spring_does_not_agree(capsys: pytest.CaptureFixture[str]) -> None:
    result = validate("softer.parquet", 1, capsys)
    same = validate("same.parquet", 0, capsys)
    assert result["agree"] is False
    assert result["z"] > 3
    assert result["this log within learned"] < 0.1 and result["learned within this log"] < 0.1
    # THEN the spring that is 20 % softer leaves about that of the torque: friction hides some of it
    for name in ("torque", "torque below 2 Hz"):
        assert 0.1 < result[name]["relative [1]"] < 0.25
        assert result[name]["relative [1]"] > 5 * same[name]["relative [1]"]
    learned, alone = (
        result[name][0]
        for name in ("stiffness learned [N.m/rad]", "stiffness of this log [N.m/rad]")
    )
    assert alone / learned == pytest.approx(0.8, abs=0.08)


def test_a_log_without_motion_cannot_tell(capsys: pytest.CaptureFixture[str]) -> None:
    result = validate("still.parquet", 1, capsys)
    assert result["agree"] is None
    assert result["torque"] is None and result["torque below 2 Hz"] is None
    assert main(["validate", "still.parquet", "--with", "knee.toml"]) == 1
    text = capsys.readouterr().out
    assert "cannot tell: too few samples in motion" in text
    assert text.rstrip().endswith("cannot tell: an interval is wider than the stiffness itself")


def test_a_log_that_was_learned_from_confirms_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    result = validate("knee.parquet", 1, capsys)
    assert result["repeated"] is True and result["agree"] is None
    # THEN both stiffnesses are the same, to the last bit: both are from the state at the end
    assert result["z"] == 0.0
    assert result["stiffness learned [N.m/rad]"] == result["stiffness of this log [N.m/rad]"]


def test_nothing_is_written(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    validate("still.parquet", 1, capsys, "--start-from", "sigmahat-results/knee/state.json")
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == before


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["same.parquet"], "Missing option '--with'"),
        (["nothere.csv", "--with", "knee.toml"], "nothere.csv: No such file"),
        (["same.parquet", "--with", "nothere.toml"], "nothere.toml: No such file"),
        (["same.parquet", "--with", "other.toml"], "sigmahat-results/other: "),
        (["same.parquet", "--with", "other.toml"], "name the folder or the state.json"),
        (["same.parquet", "--with", "knee.toml", "--start-from", "knee.toml"], "got no JSON"),
        (["same.parquet", "--with", "b.toml", "--start-from", "L"], "motor.B = 2e-05, but"),
        (["same.parquet", "--with", "paper.toml", "--start-from", "L"], "gives no interval"),
    ],
)
def test_wrong_arguments(
    arguments: list[str], words: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "other.toml").write_text(REGRESSION)
    (folder / "b.toml").write_text(REGRESSION.replace("1.84e-5", "2e-5"))
    (folder / "paper.toml").write_text(CONFIGURATION)
    given = ["sigmahat-results/knee" if each == "L" else each for each in arguments]
    assert main(["validate", *given]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    (line,) = captured.err.splitlines()
    assert words in line


# ---- what it is made of -------------------------------------------------------------------------


def estimates(sigma: float, std: float, per_gain: float = 1.0) -> dict[str, Array]:
    return {
        "sigma": np.full(4, sigma),
        "sigma_std": np.full(4, std),
        "sigma_per_gain": np.full(4, per_gain),
    }


def test_agreement_in_figures() -> None:
    # GIVEN 100 +- 2 and 105 +- 3: the difference is 5 / sqrt(4 + 9)
    found = agreement(estimates(100.0, 2.0), estimates(105.0, 3.0), 0.0)
    assert found.z == pytest.approx(5 / np.sqrt(13))
    assert found.before == pytest.approx((100.0, 3.92)) and found.alone == (105.0, 3 * 1.96)
    assert (found.alone_in_before, found.before_in_alone, found.overlap) == (0.0, 1.0, 1.0)
    assert found.agree is True
    far = agreement(estimates(100.0, 2.0), estimates(120.0, 3.0), 0.0)
    assert far.agree is False and far.overlap == 0.0


def test_the_gain_of_the_torque_is_one_error_of_both() -> None:
    """It widens both intervals, and explains no difference; but one where it acts differently."""
    # GIVEN 10 % of gain, and 0.5 of their own
    before, alone = (estimates(x, float(np.hypot(0.5, 0.1 * x))) for x in (100.0, 105.0))
    found = agreement(before, alone, 0.1)
    assert found.alone_in_before == 1.0
    assert found.z == pytest.approx(5 / np.sqrt(2 * 0.5**2 + 0.5**2), rel=1e-6)
    assert found.agree is False
