"""`sigmahat estimate --start-from` continues from a saved state, or refuses a wrong state."""

import base64
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from command_line import Shell, working_in
from recorded_logs import CONFIGURATION, REGRESSION, Columns, awas_log, read_estimate, write_log
from sigmahat.cli import main
from sigmahat.files.output import sha256

HALF = 2000
SIGMA = "estimate.sigma [N.m/rad]"
SENSOR = f'ports.tau_e_sensor.column = "tau_e_sensor"\n{REGRESSION}modality = "Sensor"\n'
SECOND = "estimate second.parquet --config joint.toml --out second"


@pytest.fixture(scope="module")
def log() -> Columns:
    return awas_log(1.0, 0.3, duration=4.0)


def part(log: Columns, rows: slice) -> Columns:
    """Returns some rows of a log, with times that begin at 0."""
    cut = {name: values[rows] for name, values in log.items()}
    return {**cut, "t": cut["t"] - cut["t"][0]}


def estimate(name: str, *options: str) -> pa.Table:
    """Runs `estimate` on the log with this name, and returns the table of results."""
    arguments = ["estimate", f"{name}.parquet", "--config", "joint.toml", "--out", name]
    assert main([*arguments, "--quiet", *options]) == 0
    return read_estimate(Path(name))


def write_halves(log: Columns, configuration: str) -> None:
    write_log(part(log, slice(0, HALF)), Path("first.parquet"))
    write_log(part(log, slice(HALF, None)), Path("second.parquet"))
    Path("joint.toml").write_text(configuration)


@pytest.fixture(scope="module")
def original(log: Columns, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("original")
    with working_in(folder):
        write_halves(log, REGRESSION)
        estimate("first")
    return folder


@pytest.fixture
def learned(original: Path, shell: Shell) -> Shell:
    """A shell in a folder whose folder `first` has the results for the first half of the log."""
    shutil.copytree(original, Path(), dirs_exist_ok=True)
    return shell


@pytest.mark.usefixtures("shell")
@pytest.mark.parametrize(
    ("configuration", "ticks"),
    [(REGRESSION, 1), (CONFIGURATION, 7), (SENSOR, 1)],
    ids=["FilteredRegression", "Paper2011", "Sensor"],
)
def test_two_logs_are_one_log_with_a_gap(configuration: str, ticks: int, log: Columns) -> None:
    """GIVEN a log in two parts, whose ports may differ, THEN the results are exactly those of one
    log with a gap. The method Paper2011 only restarts after a gap of 2 / K_I = 6.7 ms."""
    write_halves(log, configuration)
    lost = np.full(ticks, np.nan)
    columns = {n: np.concatenate([v[:HALF], lost, v[HALF:]]) for n, v in log.items()}
    write_log({**columns, "t": 1e-3 * np.arange(len(columns["t"]))}, Path("whole.parquet"))
    estimate("first")
    whole = estimate("whole")
    reversed_q = part({**log, "angle": -log["q"]}, slice(HALF, None))
    write_log(reversed_q, Path("second.parquet"))
    text = configuration.replace('column = "q"', 'column = "angle"\nsign = -1')
    Path("joint.toml").write_text(text)
    second = estimate("second", "--start-from", "first")
    for name in second.column_names:
        if name.startswith("estimate.") and name != "estimate.t [s]":
            theirs = whole[name].to_pylist()[HALF + ticks :]
            assert second[name].to_pylist() == theirs, name
    # THEN the result depends on both halves, as the second half alone gives another stiffness.
    assert estimate("second")[SIGMA].to_numpy()[-1] != whole[SIGMA].to_numpy()[-1]


def test_what_was_learned_from_is_said_and_handed_on(learned: Shell) -> None:
    first = json.loads(Path("first/state.json").read_text())
    assert (first["format"], first["version"]) == ("sigmahat learned state", 2)
    assert first["fmu"]["name"] == "StiffnessEstimator"
    assert first["method"] == first["parameters"]["method"] == "FilteredRegression"
    assert first["parameters"]["motor.B"] == 1.84e-5
    (log,) = first["logs"]
    assert (log["file"], log["ticks"], log["skipped"]) == ("first.parquet", HALF, 0)
    assert log["sha256"] == sha256(Path("first.parquet"))
    # WHEN the estimate of a second log continues from the saved state
    said = learned.run(f"{SECOND} --start-from first/state.json")
    assert "continued from what was learned from first.parquet" in said
    assert learned.err == ""  # no warning about the gap between the logs
    state = json.loads(Path("second/state.json").read_text())
    sheet = json.loads(Path("second/joint.json").read_text())
    assert [each["file"] for each in state["logs"]] == ["first.parquet", "second.parquet"]
    assert sheet["logs"] == state["logs"]
    # THEN a third estimate continues from both logs, even if it overwrites the old results
    result = learned.json(f"{SECOND} --start-from second")
    assert result["learned_from"] == ["first.parquet", "second.parquet"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("motor.B = 1.84e-5", "motor.B = 2e-5", "motor.B = 2e-05, but"),
        ("samplePeriod = 0.001", "samplePeriod = 0.002", "was written with 0.001"),
        ("rls.n = 3", "rls.n = 3\nprior.delay = 0.001", "prior.delay = 0.001, but"),
        ("rls.n = 3", 'rls.n = 3\nrls."eta_0[0,1]" = 1.0', "rls.eta_0[0,1] = 1.0, but"),
        ("rls.n = 3", "rls.n = 3\ntorque.held = true", "torque.held = 1, but"),
        ('"FilteredRegression"', '"Paper2011"', "was written with FilteredRegression"),
    ],
)
def test_another_configuration_is_refused(old: str, new: str, words: str, learned: Shell) -> None:
    """A saved state contains all parameters, and none of them may differ in the configuration."""
    assert old in REGRESSION
    Path("joint.toml").write_text(REGRESSION.replace(old, new))
    line = learned.refused(f"{SECOND} --start-from first")
    assert line.startswith("sigmahat: error: joint.toml: ")
    assert words in line
    assert "first/state.json" in line and "both must have the same parameters" in line


State = dict[str, Any]


def change(**values: Any) -> Callable[[State], bytes]:
    return lambda state: json.dumps(state | values).encode()


def with_bytes(changed: Callable[[bytes], bytes]) -> Callable[[State], bytes]:
    def content(state: State) -> bytes:
        block = changed(base64.b64decode(state["state"]))
        return change(state=base64.b64encode(block).decode())(state)

    return content


@pytest.mark.parametrize(
    ("content", "words"),
    [
        # Version 1 had the state of an FMU.
        (change(version=1), "expected version 2 of the format, got 1; run `sigmahat estimate`"),
        (change(format="sigmahat joint data sheet"), "got format 'sigmahat joint data sheet'"),
        (change(fmu={"name": "StiffnessEstimator", "version": "9.9", "guid": "{0}"}), "9.9 ({0})"),
        (change(state="?"), "state is not base64"),
        (change(state="\u00e9"), "state is not base64"),
        (change(state=""), "truncated"),
        (change(logs=None), "damaged: logs"),
        (change(mine=1), "damaged: mine"),
        (
            with_bytes(lambda b: b[:5000] + bytes([b[5000] ^ 1]) + b[5001:]),
            "checksum does not match",
        ),
        (with_bytes(lambda b: b[:-8]), "truncated"),
        (lambda _: b"", "got no JSON"),
        (lambda _: b"\xff\xfe", "got no JSON"),
        (lambda _: b"[1, 2]", "got something else"),
        (lambda state: change()(state)[:50], "cut off or damaged"),
    ],
)
def test_another_or_a_damaged_file_is_refused(
    content: Callable[[State], bytes], words: str, learned: Shell
) -> None:
    path = Path("first/state.json")
    path.write_bytes(content(json.loads(path.read_text())))
    line = learned.refused(f"{SECOND} --start-from first")
    assert "first/state.json: " in line and words in line
