"""`sigmahat validate`: two logs of one joint that are wrong in the same way confirm nothing."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from checked_logs import CONSTANT, COUNTS, GEAR, KNEE, RIGHT, WRONG, ZERO, Array, joint_log
from recorded_logs import write_log
from sigmahat.cli import main

WRAPPED = RIGHT.replace("zero = 1500", "zero = 1500\nwrap = 4096").replace(
    "rls.n = 1", "rls.n = 6\nrls.symmetric = false"
)


def columns(start: float, load: float) -> dict[str, Array]:
    """A log of RealJointPlant from an angle of the joint [rad], under a torque on it [N.m]."""
    log = joint_log({**KNEE, "initial.q": start, "initial.theta": start}, 1e-3, load)
    return {
        "t": log["t"],
        "motor_counts": (np.round(log["theta"] / (2 * np.pi) * COUNTS * GEAR) + ZERO) % COUNTS,
        "unwrapped": np.round(log["theta"] / (2 * np.pi) * COUNTS * GEAR) + ZERO,
        "link_deg": np.degrees(log["q"]),
        "current": log["tau"] / CONSTANT,
    }


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with two logs of a joint, whose counter was in other turns at the start."""
    folder = tmp_path_factory.mktemp("faults")
    write_log(columns(0.0, 0.0), folder / "first.parquet")
    write_log(columns(0.5, 1.0), folder / "second.parquet")
    return folder


def validate(
    folder: Path, text: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> tuple[int, dict[str, Any]]:
    """Exit status and result, with a configuration for both logs."""
    monkeypatch.chdir(folder)
    monkeypatch.setattr("sigmahat.logs.estimate._save_figure", lambda *_: None)
    Path("first.toml").write_text(text)
    assert main(["estimate", "first.parquet", "--quiet"]) == 0
    capsys.readouterr()
    status = main(["validate", "second.parquet", "--with", "first.toml", "--json"])
    result: dict[str, Any] = json.loads(capsys.readouterr().out)
    return status, result


def unwrapped(name: str) -> str:
    """A configuration of the counter that does not wrap, with a fault of WRONG."""
    old, new, _ = WRONG[name]
    return RIGHT.replace("motor_counts", "unwrapped").replace(old, new)


def test_a_counter_that_begins_in_another_turn(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    status, found = validate(folder, WRAPPED, monkeypatch, capsys)
    assert status == 0 and found["agree"] is True and found["fault"] is None
    # THEN 0.5 rad are 8 turns of the motor, whose counter has one period in each
    moved = "theta: +8 periods of its counter, so that the deformation is in range.phi"
    assert moved in found["notes"]
    value, half = found["stiffness of this log [N.m/rad]"]
    assert abs(value - KNEE["spring.k_1"]) < half < 50
    # THEN without range.phi nothing is moved, for nobody knows how large the deformation may be,
    # but what was seen is named with the key
    status, found = validate(folder, WRAPPED.replace("range.phi = 0.03\n", ""), monkeypatch, capsys)
    assert status == 1 and not found["agree"]
    assert not any("periods of its counter" in note for note in found["notes"])
    assert "the counter of theta began -8 of its periods away" in found["fault"]
    assert "range.phi" in found["fault"] and "ports.theta.zero" in found["fault"]


def test_a_wrong_zero_is_no_fault_where_the_stiffness_is_right(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The powers of the deformation hold a linear spring with any zero."""
    status, found = validate(folder, unwrapped("encoder zero 0"), monkeypatch, capsys)
    assert status == 0 and found["agree"] is True
    for log in ("learned", "of this log"):
        value, half = found[f"stiffness {log} [N.m/rad]"]
        assert abs(value - KNEE["spring.k_1"]) < half < 50


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("torque sign", "is negative"),
        ("link sign", "does not predict the torque"),
        ("counts per turn x 4", "does not predict the torque"),
    ],
)
def test_the_same_fault_in_both_logs_is_named(
    fault: str,
    words: str,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    status, found = validate(folder, unwrapped(fault), monkeypatch, capsys)
    assert status == 1 and found["agree"] is None
    assert words in found["fault"] and WRONG[fault][2][0].rpartition(".")[2] in found["fault"]
    assert main(["validate", "second.parquet", "--with", "first.toml"]) == 1
    text = capsys.readouterr().out
    assert found["fault"] in text and "the logs agree" not in text
