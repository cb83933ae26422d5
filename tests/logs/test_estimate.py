"""`sigmahat estimate`: a log replayed gives what the co-simulation gave."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pyarrow as pa
import pytest

import real_joint
from recorded_logs import CONFIGURATION, Array, awas_log, read_estimate, write_log
from sigmahat.cli import main
from sigmahat.fmi.master import Recording
from sigmahat.paper.scenarios import SCENARIOS
from sigmahat.runs.engine import run

SENSORS = {
    "theta": "theta_measured",
    "q": "q_measured",
    "theta_c": "theta_c_measured",
    "tau": "tau_measured",
}
SIGMA = "estimate.sigma [N.m/rad]"
AS_IN_THE_FMU = re.sub(r"motor\..*\n", "", CONFIGURATION)


@pytest.fixture(scope="module")
def table1() -> Recording:
    return run(SCENARIOS["table1"], seed=1)


@pytest.fixture(scope="module")
def log(table1: Recording) -> dict[str, Array]:
    return {"t": table1.t, **{port: table1.plant[name] for port, name in SENSORS.items()}}


def estimate(log: Path, folder: Path, configuration: str = AS_IN_THE_FMU, *options: str) -> int:
    config = folder / "log.toml"
    config.write_text(configuration)
    out = str(folder / "out")
    return main(["estimate", str(log), "--config", str(config), "--out", out, *options])


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".mat", ".h5"])
def test_replay_is_the_cosimulation(
    suffix: str, table1: Recording, log: dict[str, Array], tmp_path: Path
) -> None:
    assert estimate(write_log(log, tmp_path / f"log{suffix}"), tmp_path) == 0
    table = read_estimate(tmp_path / "out")
    assert set(table.column_names[: len(log)]) == set(log)
    expected = table1.estimators["RESIDUAL"]
    for name in expected.values:
        unit = expected.units.get(name)
        title = f"estimate.{name} [{unit}]" if unit else f"estimate.{name}"
        rounding = 1e-7 if table[title].type == pa.float32() else 1e-12
        assert table[title].to_numpy() == pytest.approx(expected[name], rel=rounding, abs=1e-12)
        is_short = suffix != ".csv" and name in expected.units and name != "change_age"
        assert (table[title].type == pa.float32()) == is_short, name
    assert table["estimate.t [s]"].type == pa.float64()
    assert table["t"].to_numpy().tolist() == log["t"].tolist()
    files = {path.suffix for path in (tmp_path / "out").iterdir()}
    table_suffix = ".csv" if suffix == ".csv" else ".parquet"
    assert files == {".png", ".svg", ".json", ".csv", table_suffix}


def test_mat_of_version_7_3(table1: Recording, log: dict[str, Array], tmp_path: Path) -> None:
    # GIVEN what MATLAB writes: HDF5 behind 512 bytes, vectors as rows of a matrix, a structure
    path = tmp_path / "log.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in log.items():
            file[f"joint/{name}"] = values[None, :]
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64")
    configuration = AS_IN_THE_FMU.replace('column = "', 'column = "joint.')
    assert estimate(path, tmp_path, configuration) == 0
    found = read_estimate(tmp_path / "out")[SIGMA].to_numpy()
    assert np.array_equal(found, np.float32(table1.estimators["RESIDUAL"]["sigma"]))


def test_a_gap_is_skipped_as_the_estimator_skips_it(
    log: dict[str, Array], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # GIVEN rows taken out, and the same rows with nan instead
    lost = np.r_[4000:4300]
    holes = {name: np.delete(values, lost) for name, values in log.items()}
    filled = {name: values.copy() for name, values in log.items()}
    filled["q"][lost] = np.nan
    results = []
    for name, columns in (("holes", holes), ("nan", filled)):
        folder = tmp_path / name
        folder.mkdir()
        assert estimate(write_log(columns, folder / "log.parquet"), folder) == 0
        said = capsys.readouterr()
        assert "300 ticks skipped in 1 gaps, the longest of 0.3 s at 4 s" in said.out
        assert said.err == ""  # no warning of the FMU for each gap
        results.append(read_estimate(folder / "out"))
    # THEN the rows that both have are the same, and the skipped ones are marked
    a, b = (result[SIGMA].to_numpy() for result in results)
    assert np.array_equal(a, np.delete(b, lost))
    valid = results[1]["estimate.valid"].to_numpy()
    assert np.array_equal(np.flatnonzero(~valid), lost)
    assert np.all(b[lost] == b[lost[0] - 1])


def test_units_sign_zero_gear_and_wrap(log: dict[str, Array], tmp_path: Path) -> None:
    # GIVEN the same log as a drive would write it
    counts = np.round(log["theta"] * 40000 / (2 * np.pi))
    columns = {
        "time_ms": log["t"] * 1e3,
        "enc": np.mod(700.0 - counts, 4096),
        "link_deg": np.degrees(log["q"]) + 12.0,
        "travel_mm": 100 - 2.5 / (2 * np.pi) * log["theta_c"],
        "i_mA": log["tau"] / 0.05 * 1e3,
    }
    configuration = """
[time]
column = "time_ms"
unit = "ms"
[ports]
theta = {column = "enc", unit = "counts", counts_per_turn = 800, gear_ratio = 50, sign = -1, zero = 700, wrap = 4096}
q = {column = "link_deg", unit = "deg", zero = 12}
theta_c = {column = "travel_mm", unit = "mm", zero = 100, mm_per_turn = -2.5}
tau = {column = "i_mA", unit = "mA", torque_constant = 0.05}
[parameters]
samplePeriod = 0.001
"""  # noqa: E501
    assert np.ptp(counts) > 4096
    assert estimate(write_log(columns, tmp_path / "log.parquet"), tmp_path, configuration) == 0
    (tmp_path / "si").mkdir()
    assert estimate(write_log(log, tmp_path / "si" / "log.parquet"), tmp_path / "si") == 0
    sigma, expected = (
        read_estimate(folder / "out")[SIGMA].to_numpy() for folder in (tmp_path, tmp_path / "si")
    )
    assert sigma[1000:] == pytest.approx(expected[1000:], rel=1e-6)


def test_slow_and_uneven_columns_are_interpolated_and_said(
    log: dict[str, Array], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # GIVEN theta_c every 10 ms, empty in between, and time stamps of the rows that jitter
    rng = np.random.default_rng(1)
    t = log["t"] + rng.uniform(-2e-4, 2e-4, len(log["t"]))
    columns = {name: np.interp(t, log["t"], log[name]) for name in SENSORS}
    columns["theta_c"][np.arange(len(t)) % 10 != 0] = np.nan
    path = write_log({"t": t, **columns}, tmp_path / "log.parquet")
    assert estimate(path, tmp_path, AS_IN_THE_FMU + "encoder.theta = 0\n") == 0
    output = capsys.readouterr().out
    assert re.search(r"theta_c: 1\d{4} ticks interpolated, its samples are 0.01 s apart", output)
    assert re.search(r"theta: 1\d{4} ticks interpolated", output)
    truth = 2 * 14220 * ((100 - 0.0025 / (2 * np.pi) * 1e3 * log["theta_c"]) / 1e3) ** 2
    sigma = read_estimate(tmp_path / "out")[SIGMA].to_numpy()
    assert sigma[5000:-10] == pytest.approx(truth[5000:-10], rel=0.05)


def test_columns_with_times_of_their_own(log: dict[str, Array], tmp_path: Path) -> None:
    # GIVEN data sets of several lengths THEN ticks at their common samples are exact
    columns = {**log, "slow_t": log["t"][::10], "theta_c": log["theta_c"][::10]}
    configuration = AS_IN_THE_FMU.replace(
        'column = "theta_c"', 'column = "theta_c"\ntime = "slow_t"'
    )
    assert estimate(write_log(columns, tmp_path / "log.h5"), tmp_path, configuration) == 0
    table = read_estimate(tmp_path / "out")
    assert "theta_c" not in table.column_names  # it is no column of the table of t
    found = table["estimate.setPoint [1]"].to_numpy()[::10]
    scale = -0.0025 / (2 * np.pi) * 1e3
    assert found == pytest.approx(100 + scale * columns["theta_c"], rel=1e-12)


def test_other_columns_stay_as_they_are(log: dict[str, Array], tmp_path: Path) -> None:
    path = write_log({**log, "note": np.array(["x, y"] * len(log["t"]))}, tmp_path / "log.csv")
    assert estimate(path, tmp_path) == 0
    ours = path.read_text().splitlines()
    theirs = (tmp_path / "out" / "estimate.csv").read_text().splitlines()
    assert len(ours) == len(theirs)
    for row in (1, 777, 15001):
        assert theirs[row].startswith(ours[row].split(",")[0])
        assert '"x, y"' in theirs[row]


def test_json_and_quiet(
    log: dict[str, Array], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_log(log, tmp_path / "log.parquet")
    assert estimate(path, tmp_path, AS_IN_THE_FMU, "--json") == 0
    summary = json.loads(capsys.readouterr().out)
    last = read_estimate(tmp_path / "out")
    assert summary["sigma [N.m/rad]"] == last[SIGMA].to_numpy()[-1]
    # THEN the coefficients are those of (23) at the last sample
    eta = np.array(summary["eta"])
    phi = last["estimate.phi [rad]"].to_numpy()[-1]
    set_point = last["estimate.setPoint [1]"].to_numpy()[-1]
    powers = 2 * np.arange(len(eta)) + 1
    slope = (powers * phi ** (powers - 1)) @ eta @ set_point ** np.arange(eta.shape[1])
    assert slope == pytest.approx(summary["sigma [N.m/rad]"], rel=1e-9)
    assert estimate(path, tmp_path, AS_IN_THE_FMU, "--quiet") == 0
    captured = capsys.readouterr()
    assert (captured.out, captured.err) == ("", "")


REGRESSION = CONFIGURATION + 'method = "FilteredRegression"\nrls.n = 3\n'


def test_why_and_how_often_the_estimate_is_not_confident(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # GIVEN a limit that only part of the estimates meets
    path = write_log(awas_log(1.0, 0.3), tmp_path / "log.parquet")
    configuration = REGRESSION + "limit.relative_std = 0.022\nprior.torque_gain = 0.01\n"
    assert estimate(path, tmp_path, configuration, "--json") == 0
    result = json.loads(capsys.readouterr().out)
    table = read_estimate(tmp_path / "out")
    doubt = np.array(table["estimate.doubt"].to_pylist())
    confident = table["estimate.confident"].to_numpy()
    # THEN the reason is None where it is confident, and only there
    assert np.array_equal(doubt == "None", confident)
    half = len(doubt) // 2
    assert 0 < result["confident"] < 1
    assert result["confident"] == np.mean(confident[half:])
    assert result["doubt"] == {
        item: np.mean(doubt[half:] == item) for item in set(doubt[half:]) - {"None"}
    }
    # THEN what it rests on is that of the FMU, and the summary says it
    for name in ("misfit", "sigma_per_gain"):
        assert np.float32(result[name]) == table[f"estimate.{name} [1]"].to_numpy()[-1]
    bias = np.float32(result["joint"]["bias_hat"])
    assert bias == table["estimate.bias_hat [N.m]"].to_numpy()[-1]
    assert estimate(path, tmp_path, configuration) == 0
    text = capsys.readouterr().out
    assert len(text.splitlines()) <= 30
    assert re.search(r"not confident +\S+ % of the time \(\w+ \S+ %", text)
    by_gain = f"1 % of it changes sigma by {result['sigma_per_gain']:.3g} %"
    gain = f"known to 1 % (prior.torque_gain); {by_gain}"
    for line in (gain, "motor.B = 1.84e-05 kg.m2, exactly (prior.B = 0)", "range.phi = 0.3 rad"):
        assert line in text


def test_paper2011_makes_no_claim(
    log: dict[str, Array], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_log(log, tmp_path / "log.csv")
    assert estimate(path, tmp_path) == 0
    text = capsys.readouterr().out
    assert "for which the method gives no standard deviation" in text
    assert text.count("standard deviation") == 1 and "confident" not in text
    assert set(read_estimate(tmp_path / "out")["estimate.doubt"].to_pylist()) == {"NoClaim"}
    band = "95 % band"
    assert band not in (tmp_path / "out" / "estimate.svg").read_text()
    assert estimate(path, tmp_path, AS_IN_THE_FMU + 'method = "FilteredRegression"\n') == 0
    assert band in (tmp_path / "out" / "estimate.svg").read_text()


def test_the_real_joint(tmp_path: Path) -> None:
    """The configuration in the documentation gives what the replay in real_joint.py does."""
    try:
        data = real_joint.folder()
    except FileNotFoundError as error:
        pytest.skip(str(error))
    page = (Path(__file__).parents[2] / "docs" / "real-joint.md").read_text()
    (program,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    (configuration,) = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    subprocess.run([sys.executable, "-c", program, str(data)], cwd=tmp_path, check=True)
    expected = real_joint.replay(real_joint.logs(data), symmetric=False)
    assert estimate(tmp_path / "desr.csv", tmp_path, configuration) == 0
    table = read_estimate(tmp_path / "out")
    assert table[SIGMA].to_numpy()[-1] == pytest.approx(expected.sigma, rel=1e-12)
    assert table["estimate.tau_e [N.m]"].to_numpy()[-1] == pytest.approx(expected.tau_e, rel=1e-12)
