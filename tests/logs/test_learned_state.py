"""`sigmahat estimate --start-from` goes on from what was learned, and refuses what does not fit."""

from __future__ import annotations

import base64
import json
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from command_line import refused as command_refused
from recorded_logs import CONFIGURATION, Array, awas_log, read_estimate, write_log
from sigmahat.cli import main
from sigmahat.files.output import sha256

REGRESSION = CONFIGURATION + 'method = "FilteredRegression"\nrls.n = 3\n'
HALF = 2000
SIGMA = "estimate.sigma [N.m/rad]"


@pytest.fixture(scope="module")
def log() -> dict[str, Array]:
    return awas_log(1.0, 0.3, duration=4.0)


def part(log: Mapping[str, Array], rows: slice) -> dict[str, Array]:
    """Rows of a log, whose times begin at 0."""
    cut = {name: values[rows] for name, values in log.items()}
    return {**cut, "t": cut["t"] - cut["t"][0]}


@pytest.fixture(autouse=True)
def no_figure(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures take most of the time, and other tests look at them."""
    monkeypatch.setattr("sigmahat.logs.estimate._save_figure", lambda *_: None)


@pytest.fixture(scope="module")
def original(log: dict[str, Array], tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("original")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr("sigmahat.logs.estimate._save_figure", lambda *_: None)
        write_log(part(log, slice(0, HALF)), Path("first.parquet"))
        write_log(part(log, slice(HALF, None)), Path("second.parquet"))
        Path("joint.toml").write_text(REGRESSION)
        assert estimate("first") == 0
    return folder


@pytest.fixture
def learned(original: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder in which `first` was learned from the first half of the log."""
    folder = tmp_path / "here"
    shutil.copytree(original, folder)
    monkeypatch.chdir(folder)
    return folder


def estimate(name: str, *options: str) -> int:
    return main(
        [
            "estimate",
            f"{name}.parquet",
            "--config",
            "joint.toml",
            "--out",
            name,
            "--quiet",
            *options,
        ]
    )


def with_gap(log: Mapping[str, Array], ticks: int) -> dict[str, Array]:
    """The log with a number of samples missing between its halves."""
    lost = np.full(ticks, np.nan)
    columns = {n: np.concatenate([v[:HALF], lost, v[HALF:]]) for n, v in log.items()}
    return {**columns, "t": 1e-3 * np.arange(len(columns["t"]))}


@pytest.mark.parametrize(
    ("configuration", "ticks"),
    [(REGRESSION, 1), (CONFIGURATION, 7), (REGRESSION + 'modality = "Sensor"\n', 1)],
    ids=["FilteredRegression", "Paper2011", "Sensor"],
)
def test_two_logs_give_what_one_log_with_a_gap_gives(
    configuration: str,
    ticks: int,
    log: dict[str, Array],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """To the last bit. Paper2011 needs a gap of 2 / K_I = 6.7 ms, so that it starts again."""
    monkeypatch.chdir(tmp_path)
    if "Sensor" in configuration:
        configuration = configuration.replace("[parameters]", SENSOR_PORT + "[parameters]")
    Path("joint.toml").write_text(configuration)
    write_log(part(log, slice(0, HALF)), Path("first.parquet"))
    write_log(part(log, slice(HALF, None)), Path("second.parquet"))
    write_log(with_gap(log, ticks), Path("whole.parquet"))
    assert estimate("first") == 0
    assert estimate("second", "--start-from", "first") == 0
    assert estimate("whole") == 0
    second, whole = read_estimate(tmp_path / "second"), read_estimate(tmp_path / "whole")
    for name in second.column_names:
        if name.startswith("estimate.") and name != "estimate.t [s]":
            theirs = whole[name].to_pylist()[HALF + ticks :]
            assert second[name].to_pylist() == theirs, name
    # THEN it has learned from both: alone, the second half gives something else
    assert estimate("second") == 0
    alone = read_estimate(tmp_path / "second")[SIGMA].to_numpy()
    assert alone[-1] != whole[SIGMA].to_numpy()[-1]


SENSOR_PORT = '[ports.tau_e_sensor]\ncolumn = "tau_e_sensor"\n'


def test_the_file_says_what_it_is_of(learned: Path) -> None:
    state = json.loads((learned / "first" / "state.json").read_text())
    assert (state["format"], state["version"]) == ("sigmahat learned state", 1)
    assert state["fmu"]["name"] == "StiffnessEstimator"
    assert state["method"] == state["parameters"]["method"] == "FilteredRegression"
    assert state["parameters"]["motor.B"] == 1.84e-5
    (log,) = state["logs"]
    assert (log["file"], log["ticks"], log["skipped"]) == ("first.parquet", HALF, 0)
    assert log["sha256"] == sha256(learned / "first.parquet")


def test_what_was_learned_from_is_said_and_handed_on(
    learned: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["estimate", "second.parquet", "--config", "joint.toml", "--out", "second"]
    assert main([*arguments, "--start-from", "first/state.json"]) == 0
    captured = capsys.readouterr()
    assert "continued from what was learned from first.parquet" in captured.out
    assert captured.err == ""  # the gap between the logs is no news
    state = json.loads((learned / "second" / "state.json").read_text())
    sheet = json.loads((learned / "second" / "joint.json").read_text())
    assert [each["file"] for each in state["logs"]] == ["first.parquet", "second.parquet"]
    assert sheet["logs"] == state["logs"]
    # THEN a third log goes on from both, also over the results themselves
    assert main([*arguments, "--start-from", "second", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["learned_from"] == ["first.parquet", "second.parquet"]


def test_columns_of_the_second_log_may_differ(
    learned: Path, log: dict[str, Array], capsys: pytest.CaptureFixture[str]
) -> None:
    second = part(log, slice(HALF, None))
    assert estimate("second", "--start-from", "first") == 0
    expected = read_estimate(learned / "second")[SIGMA].to_numpy()
    renamed = {**second, "angle_deg": np.degrees(second["q"])}
    del renamed["q"]
    write_log(renamed, learned / "second.parquet")
    text = REGRESSION.replace('column = "q"', 'column = "angle_deg"\nunit = "deg"')
    (learned / "joint.toml").write_text(text)
    assert estimate("second", "--start-from", "first") == 0
    found = read_estimate(learned / "second")[SIGMA].to_numpy()
    assert found == pytest.approx(expected, rel=1e-6)


def refused(capsys: pytest.CaptureFixture[str], *options: str) -> str:
    """The one line of an estimate that must fail; its folder must stay as it is."""
    before = {path: path.read_bytes() for path in Path("out").glob("*")}
    arguments = ["estimate", "second.parquet", "--config", "joint.toml", "--out", "out"]
    line = command_refused(capsys, *arguments, *options)
    assert {path: path.read_bytes() for path in Path("out").glob("*")} == before
    return line


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("motor.B = 1.84e-5", "motor.B = 2e-5", "motor.B = 2e-05, but"),
        ("samplePeriod = 0.001", "samplePeriod = 0.002", "was learned with 0.001"),
        ("rls.n = 3", "rls.n = 3\nprior.delay = 0.001", "prior.delay = 0.001, but"),
        ("rls.n = 3", "rls.n = 3\nrls.eta_0[0,1] = 1.0", "rls.eta_0[0,1] = 1.0, but"),
        ("rls.n = 3", "rls.n = 3\ntorque.held = true", "torque.held = 1, but"),
        ('"FilteredRegression"', '"Paper2011"', "was learned with FilteredRegression"),
        (
            'method = "FilteredRegression"',
            'method = "Paper2011"\nmotor.D_theta = 2e-3',
            "method = Paper2011",
        ),
    ],
)
def test_another_configuration_is_refused(
    old: str, new: str, words: str, learned: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The state contains the parameters, so that none of them may differ."""
    new = new.replace("rls.eta_0[0,1]", 'rls."eta_0[0,1]"')
    text = REGRESSION.replace("motor.D_theta = 1.2e-3\n", "") if "D_theta" in new else REGRESSION
    assert old in text
    Path("joint.toml").write_text(text.replace(old, new))
    line = refused(capsys, "--start-from", "first")
    assert line.startswith("sigmahat: error: joint.toml: ")
    assert words in line
    assert "first/state.json" in line and "contains its parameters: use these" in line


def change(**values: Any) -> Callable[[dict[str, Any]], None]:
    return lambda state: state.update(values)


def damage(state: dict[str, Any]) -> None:
    block = bytearray(base64.b64decode(state["state"]))
    block[5000] ^= 1
    state["state"] = base64.b64encode(block).decode()


def cut(state: dict[str, Any]) -> None:
    state["state"] = base64.b64encode(base64.b64decode(state["state"])[:-8]).decode()


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (change(format="sigmahat joint data sheet"), "got format 'sigmahat joint data sheet'"),
        (change(version=2), "expected version 1 of the format, got 2"),
        (change(fmu={"name": "StiffnessEstimator", "version": "9.9", "guid": "{0}"}), "9.9 ({0})"),
        (change(state="?"), "state is not base64"),
        (change(state="\u00e9"), "state is not base64"),
        (change(state=""), "truncated"),
        (change(logs=None), "damaged: logs"),
        (change(mine=1), "damaged: mine"),
        (damage, "checksum does not match"),
        (cut, "truncated"),
    ],
)
def test_another_or_a_damaged_state_is_refused(
    edit: Callable[[dict[str, Any]], None],
    words: str,
    learned: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = learned / "first" / "state.json"
    state = json.loads(path.read_text())
    edit(state)
    path.write_text(json.dumps(state))
    line = refused(capsys, "--start-from", "first")
    assert "first/state.json: " in line
    assert words in line


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "No such file or directory; name the folder or the state.json"),
        (b"", "got no JSON"),
        (b"\xff\xfe", "not text"),
        (b"[1, 2]", "got something else"),
        (b'{"format": "sigmahat learned state", "vers', "cut off or damaged"),
    ],
)
def test_a_file_of_another_kind_is_refused(
    content: bytes | None, words: str, learned: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if content is not None:
        Path("other.json").write_bytes(content)
    line = refused(capsys, "--start-from", "other.json")
    assert "other.json: " in line and words in line
