"""Bad logs and configurations: one line that says where and what to do, exit 2."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from command_line import refused as command_refused
from recorded_logs import CONFIGURATION, Array, plain_log, write_log


def refused(
    arguments: list[str], capsys: pytest.CaptureFixture[str], command: str = "estimate"
) -> str:
    return command_refused(capsys, command, *arguments)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("log.toml").write_text(CONFIGURATION)
    return tmp_path


@pytest.mark.parametrize("suffix", [".parquet", ".mat", ".h5"])
def test_file_cut_in_the_middle(
    suffix: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_log(plain_log(), folder / f"log{suffix}")
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    line = refused([path.name], capsys)
    assert path.name in line
    assert "copy it again" in line or "save it again" in line
    assert [p.name for p in folder.iterdir() if p.is_dir()] == []


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "empty"),
        (b"%PDF-1.7\n\xff\xfe\x00", "expected CSV, Parquet"),
        (b"\xff\xfe\x41\x41, \xff", "text in UTF-16; convert it: iconv -f UTF-16"),
        (b"\x1f\x8b\x08\x00", "compressed with gzip; unpack it: gunzip --keep log.csv"),
        (b"PK\x03\x04\x14\x00", "an Excel workbook or a ZIP archive; save the sheet as CSV"),
        (b"just a letter\nto you\n", "names of several columns"),
        (b"0,1,2\n0.1,1,2\n", "names of the columns"),
        (b"t,theta,q,tau\n", "no rows"),
        (b"t,t,q\n0,1,2\n", "twice"),
    ],
)
def test_file_of_another_kind(
    content: bytes, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("log.csv").write_bytes(content)
    assert words in refused(["log.csv"], capsys)
    assert words in refused(["log.csv", "--config", "new.toml"], capsys, "init")
    assert not Path("new.toml").exists()


def test_missing_file_and_folder(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "No such file" in refused(["log.csv"], capsys)
    (folder / "log").mkdir()
    assert "ROS 2 bag" in refused(["log"], capsys)
    for command in ("estimate", "identify"):  # the log is what a mistyped name is about
        assert "error: nothere.csv: No such file" in refused(["nothere.csv"], capsys, command)


def text(log: dict[str, Array]) -> dict[str, np.ndarray]:
    return {**log, "q": np.array(["1.0", *["fast"] * 1999])}


def back(log: dict[str, Array]) -> dict[str, Array]:
    log["t"][1500] = log["t"][1400]
    return log


def nothing(log: dict[str, Array]) -> dict[str, Array]:
    return {**log, "q": np.full(2000, np.nan)}


def one_word(log: dict[str, Array]) -> dict[str, np.ndarray]:
    """A word among numbers, and an empty cell before it."""
    q = log["q"].astype(str)
    q[700], q[300] = "abc", ""
    return {**log, "q": q}


def nanoseconds_back(log: dict[str, Array]) -> dict[str, np.ndarray]:
    t = 1_700_000_000_000_000_000 + np.round(1e9 * log["t"]).astype(np.int64)
    t[1500] = t[1400]
    return {**log, "t": t}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (one_word, "column 'q' holds text ('abc' in row 701)"),
        (text, "column 'q' holds text ('fast' in row 2)"),
        (back, "does not increase: 1.4 s in row 1501 after 1.499 s"),
        (nothing, "no number"),
    ],
)
@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_values_that_do_not_fit(
    change: Callable[[dict[str, Array]], dict[str, Array]],
    words: str,
    suffix: str,
    folder: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = write_log(change(plain_log()), folder / f"log{suffix}")
    assert words in refused([path.name], capsys)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('column = "q"', 'column = "qq"', "unknown column 'qq'; did you mean 'q'"),
        (
            'column = "t"\n[ports.theta]\ncolumn = "theta"',
            '[ports.theta]\ncolumn = "thet"',
            "'thet'",
        ),
        ("[ports.theta_c]", "[ports.thetac]", "did you mean 'theta_c'"),
        ("[parameters]", "[parameter]", "did you mean 'parameters'"),
        ("motor.B", "motor.b", "did you mean 'motor.B'"),
        ("motor.gamma = 50", 'motor.gamma = "50"', "motor.gamma"),
        ("motor.gamma = 50", "motor.gamma = ", "not TOML"),
        ('column = "q"', 'colum = "q"', "did you mean 'column'"),
        ('column = "q"', 'column = "q"\nunit = "degg"', "unknown unit 'degg'; did you mean 'deg'"),
        ('column = "q"', 'column = "q"\nunit = "A"', "unit 'A' cannot be converted to rad"),
        ('column = "q"', 'column = "q"\nunit = "counts"', "counts_per_turn"),
        ('column = "q"', 'column = "q"\nsign = 2', "expected 1 or -1"),
        ('column = "q"', 'column = "q"\nscale = "x"', "expected a number"),
        ('column = "t"', 'column = "t"\nunit = "sec."', "unknown unit"),
        ('[ports.q]\ncolumn = "q"', "", "needs [ports.q]"),
        ("samplePeriod = 0.001", "samplePeriod = 0", "samplePeriod"),
        ("samplePeriod = 0.001", "samplePeriod = 1e-12", "samplePeriod"),
        ("motor.gamma = 50", "modality = 'Sensr'", "did you mean 'Sensor'"),
        ("motor.gamma = 50", "model.r_0 = nan", "model.r_0: expected a finite number, got nan"),
        ("motor.gamma = 50", "motor.gamma = 0", "motor.gamma is 0; fill in the gear ratio"),
    ],
)
def test_configuration_that_does_not_fit(
    old: str, new: str, words: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_log(plain_log(), folder / "log.parquet")
    assert old in CONFIGURATION
    Path("log.toml").write_text(CONFIGURATION.replace(old, new))
    assert words in refused(["log.parquet"], capsys)
    assert sorted(p.name for p in folder.iterdir()) == ["log.parquet", "log.toml"]


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".mat", ".h5"])
def test_times_since_1970_are_told_from_the_first_row(
    suffix: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("log.toml").write_text(CONFIGURATION.replace('"t"', '"t"\nunit = "ns"'))
    path = write_log(nanoseconds_back(plain_log()), folder / f"log{suffix}")
    line = refused([path.name], capsys)
    assert "does not increase: 1.4 s in row 1501 after 1.499 s" in line


def test_no_configuration(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_log(plain_log(), folder / "other.csv")
    assert "sigmahat init" in refused(["other.csv"], capsys)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("motor.gamma = 50", "motor.gamma = 50\nrange.phi = -1", "error: parameter range.phi = -1"),
        ("motor.gamma = 50", "motor.gamma = 50\nrls.n = 99", "error: parameter rls.n = 99"),
        ("samplePeriod = 0.001", "samplePeriod = 1.5", "samples 1.5 s apart do not show"),
    ],
)
def test_no_message_names_a_function_of_an_fmu(
    old: str, new: str, words: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_log(plain_log(rows=20_000), folder / "log.csv")
    Path("log.toml").write_text(CONFIGURATION.replace(old, new))
    line = refused(["log.csv"], capsys, "identify")
    assert words in line and "fmi2" not in line


def test_identify_needs_its_ports(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_log(plain_log(), folder / "log.csv")
    line = refused(["log.csv", "--torque-constant"], capsys, "identify")
    assert "tau_e_sensor" in line
    write_log(plain_log(rows=200), folder / "log.csv")
    too_short = "the log is 0.2 s long, expected at least 0.7 s"
    assert too_short in refused(["log.csv"], capsys, "identify")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("matched.memory = 5.0", "regression.memory"),
        ("confidence = 0.2", "limit.relative_std"),
        ('method = "MatchedFilter"', "FilteredRegression"),
    ],
)
def test_a_name_of_before_is_answered_with_the_new_one(
    old: str, new: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_log(plain_log(), folder / "log.csv")
    Path("log.toml").write_text(f"{CONFIGURATION}\n{old}\n")
    assert f"it is called '{new}' now" in refused(["log.csv"], capsys)
