"""A wrong log or configuration gives exit status 2 and one line with the place and a remedy."""

from pathlib import Path

import numpy as np
import pytest

from command_line import Shell
from recorded_logs import CONFIGURATION, plain_log, write_log


@pytest.fixture(autouse=True)
def configured(shell: Shell) -> None:
    Path("log.toml").write_text(CONFIGURATION)


@pytest.mark.parametrize("suffix", [".parquet", ".mat", ".h5"])
def test_file_cut_in_the_middle(suffix: str, shell: Shell) -> None:
    path = write_log(plain_log(), Path(f"log{suffix}"))
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    line = shell.refused(f"estimate {path}")
    assert path.name in line
    assert "copy it again" in line or "save it again" in line


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "empty"),
        (b"%PDF-1.7\n\xff\xfe\x00", "expected CSV, Parquet"),
        (b"\xff\xfe\x41\x41, \xff", "text in UTF-16; convert it: iconv -f UTF-16"),
        (b"\x1f\x8b\x08\x00", "compressed with gzip; unpack it: gunzip --keep log.csv"),
        (b"PK\x03\x04\x14\x00", "an Excel workbook or a ZIP archive; save a workbook as CSV"),
        (b"just a letter\nto you\n", "names of columns that"),
        (b"0,1,2\n0.1,1,2\n", "names of the columns"),
        (b"t,theta,q,tau\n", "expected rows"),
        (b"t,q\n0,1,2\n1,2,3\n", "line 2 has 3 values, line 1 names 2 columns"),
    ],
)
def test_file_of_another_kind(content: bytes, words: str, shell: Shell) -> None:
    Path("log.csv").write_bytes(content)
    assert words in shell.refused("estimate log.csv")
    assert words in shell.refused("init log.csv --config new.toml")


def test_missing_file_and_folder(shell: Shell) -> None:
    Path("log").mkdir()
    assert "ROS 2 bag" in shell.refused("estimate log")
    for command in ("estimate", "identify"):  # the error names the missing log
        assert "error: nothere.csv: No such file" in shell.refused(f"{command} nothere.csv")
    write_log(plain_log(), Path("other.csv"))
    assert "sigmahat init" in shell.refused("estimate other.csv")


WORD = plain_log()["q"].astype(str)
"""A column of numbers with a word, and with an empty cell in an earlier row."""
WORD[700], WORD[300] = "abc", ""
BACK = plain_log()["t"]
BACK[1500] = BACK[1400]
BACK_SINCE_1970 = 1_700_000_000_000_000_000 + np.round(1e9 * BACK).astype(np.int64)
NOT_INCREASING = "does not increase: 1.4 s in row 1501 after 1.499 s"


@pytest.mark.parametrize(
    ("column", "values", "words"),
    [
        ("q", WORD, "column 'q' holds text ('abc' in row 701)"),
        ("q", np.array(["1.0", *["fast"] * 1999]), "column 'q' holds text ('fast' in row 2)"),
        ("q", np.full(2000, np.nan), "no number"),
        ("t", BACK, NOT_INCREASING),
        ("t", BACK_SINCE_1970, NOT_INCREASING),  # the error gives times since the first row
    ],
)
def test_values_that_do_not_fit(column: str, values: np.ndarray, words: str, shell: Shell) -> None:
    suffixes = [".csv", ".parquet"]
    if values is BACK_SINCE_1970:
        Path("log.toml").write_text(CONFIGURATION.replace('"t"', '"t"\nunit = "ns"'))
        suffixes += [".mat", ".h5"]
    for suffix in suffixes:
        write_log({**plain_log(), column: values}, Path(f"log{suffix}"))
        assert words in shell.refused(f"estimate log{suffix}")


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
        (
            'column = "q"',
            'column = "theta"',
            "name another column for one of them. A table in long form",
        ),
        ('column = "tau"', 'column = "t"', "[time] and [ports.tau] both use the column 't'"),
        ("samplePeriod = 0.001", "samplePeriod = 0", "fill in the time between two rows"),
        ("motor.gamma = 50", "modality = 'Sensr'", "did you mean 'Sensor'"),
        ("motor.gamma = 50", "model.r_0 = nan", "model.r_0: expected a finite number, got nan"),
        ("motor.gamma = 50", "motor.gamma = 0", "motor.gamma is 0; fill in the gear ratio"),
        # A parameter that had another name in earlier versions
        ("motor.B", "matched.memory", "it is called 'regression.memory' now"),
        ("motor.B", "confidence", "it is called 'limit.relative_std' now"),
        (
            "[parameters]",
            '[parameters]\nmethod = "MatchedFilter"',
            "it is called 'FilteredRegression' now",
        ),
    ],
)
def test_configuration_that_does_not_fit(old: str, new: str, words: str, shell: Shell) -> None:
    write_log(plain_log(), Path("log.parquet"))
    assert old in CONFIGURATION
    Path("log.toml").write_text(CONFIGURATION.replace(old, new))
    assert words in shell.refused("estimate log.parquet")


@pytest.mark.parametrize(("key", "value"), [("range.phi", "-1"), ("rls.n", "99")])
def test_no_message_names_a_function_of_an_fmu(key: str, value: str, shell: Shell) -> None:
    write_log(plain_log(), Path("log.csv"), f"{CONFIGURATION}{key} = {value}\n")
    line = shell.refused("identify log.csv")
    assert f"error: {key}: expected" in line and f"got {value}" in line and "fmi2" not in line


def test_identify_needs_its_ports_and_some_time(shell: Shell) -> None:
    write_log(plain_log(rows=200), Path("log.csv"))
    assert "tau_e_sensor" in shell.refused("identify log.csv --torque-constant")
    too_short = "the log is 0.2 s long, expected at least 0.7 s"
    assert too_short in shell.refused("identify log.csv")
    write_log(plain_log(rows=20_000), Path("log.csv"), CONFIGURATION.replace("= 0.001", "= 1.5"))
    assert "samples 1.5 s apart do not show" in shell.refused("identify log.csv")
