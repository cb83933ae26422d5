"""`sigmahat validate` does not confirm two logs of a joint that have the same error."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from checked_logs import COUNTS, KNEE, RIGHT, WRONG, as_recorded, joint_log
from command_line import Shell
from recorded_logs import write_log
from sigmahat.recording.notes import CounterAtStart

WRAPPED = RIGHT.replace("zero = 1500", "zero = 1500\nwrap = 4096").replace(
    "rls.n = 1", "rls.n = 6\nrls.symmetric = false"
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with two logs of a joint, whose motor counter starts in different turns. The second
    log begins at 0.5 rad with a load of 1 N.m."""
    folder = tmp_path_factory.mktemp("faults")
    for name, start, load in (("first", 0.0, 0.0), ("second", 0.5, 1.0)):
        plant = {**KNEE, "initial.q": start, "initial.theta": start}
        columns = as_recorded(joint_log(plant, 1e-3, load))
        counts = columns["motor_counts"]
        columns |= {"motor_counts": np.mod(counts, COUNTS), "unwrapped": counts}
        write_log(columns, folder / f"{name}.parquet")
    return folder


@pytest.fixture(autouse=True)
def here(folder: Path, shell: Shell, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)


def validate(shell: Shell, text: str, status: int) -> dict[str, Any]:
    """Runs `validate` with the same configuration for both logs, and returns the result."""
    Path("first.toml").write_text(text)
    shell.run("estimate first.parquet")
    found: dict[str, Any] = shell.json("validate second.parquet --with first.toml", status)
    return found


def unwrapped(name: str) -> str:
    """Returns a configuration with an error from WRONG, for the counter that does not wrap."""
    old, new, _ = WRONG[name]
    return RIGHT.replace("motor_counts", "unwrapped").replace(old, new)


def test_a_counter_that_begins_in_another_turn(shell: Shell) -> None:
    found = validate(shell, WRAPPED, 0)
    assert found["agree"] is True and found["fault"] is None
    # THEN `validate` shifts the motor angle by 8 counter periods, which are 8 turns or 0.5 rad.
    moved = CounterAtStart(port="theta", periods=8)
    words = "theta: +8 periods of its counter, so that the deformation is in range.phi"
    assert moved.in_words == words
    assert moved.as_dict() in found["notes"]
    value, half = found["stiffness_of_this_log"]
    assert abs(value - KNEE["spring.k_1"]) < half < 50
    # WHEN range.phi is not set, THEN the largest possible deformation is unknown.
    # THEN `validate` does not shift the motor angle, but reports the turns and the key to set.
    found = validate(shell, WRAPPED.replace("range.phi = 0.03\n", ""), 1)
    assert not found["agree"]
    assert not any(note["kind"].startswith("counter") for note in found["notes"])
    assert "the counter of theta began -8 of its periods away" in found["fault"]
    assert "range.phi" in found["fault"] and "ports.theta.zero" in found["fault"]


def test_a_wrong_zero_is_no_fault_where_the_stiffness_is_right(shell: Shell) -> None:
    """GIVEN a linear spring, THEN an offset of the deformation does not change the stiffness."""
    found = validate(shell, unwrapped("encoder zero 0"), 0)
    assert found["agree"] is True
    for log in ("learned", "of_this_log"):
        value, half = found[f"stiffness_{log}"]
        assert abs(value - KNEE["spring.k_1"]) < half < 50


@pytest.mark.parametrize("fault", ["torque sign", "link sign"])
def test_the_same_fault_in_both_logs_is_named(fault: str, shell: Shell) -> None:
    found = validate(shell, unwrapped(fault), 1)
    assert found["agree"] is None
    assert WRONG[fault][2][0].rpartition(".")[2] in found["fault"]
    text = shell.run("validate second.parquet --with first.toml", 1)
    assert found["fault"] in text and "the logs agree" not in text
