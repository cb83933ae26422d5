"""`sigmahat estimate`: a log replayed gives what the co-simulation gave."""

import re
from pathlib import Path

import h5py
import numpy as np
import pyarrow as pa
import pytest

from command_line import Shell, in_process
from recorded_logs import (
    COLUMNS,
    CONFIGURATION,
    REGRESSION,
    STORED,
    Columns,
    awas_log,
    plain_log,
    read_estimate,
    write_log,
)
from sigmahat.fmi.master import Recording
from sigmahat.paper.scenarios import SCENARIOS
from sigmahat.runs.engine import run

SIGMA = "estimate.sigma [N.m/rad]"
AS_IN_THE_FMU = re.sub(r"motor\..*\n", "", CONFIGURATION)


@pytest.fixture(scope="module")
def table1() -> Recording:
    return run(SCENARIOS["table1"], seed=1)


@pytest.fixture(scope="module")
def log(table1: Recording) -> Columns:
    return {"t": table1.t, **{port: table1.plant[name] for port, name in COLUMNS.items()}}


def estimated(shell: Shell, log: Path, configuration: str = AS_IN_THE_FMU) -> pa.Table:
    """The table that the command writes to the folder out."""
    Path("log.toml").write_text(configuration)
    shell.run(f"estimate {log} --config log.toml --out out")
    return read_estimate(Path("out"))


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".mat", ".h5"])
def test_replay_is_the_cosimulation(
    suffix: str, table1: Recording, log: Columns, shell: Shell
) -> None:
    table = estimated(shell, write_log(log, Path(f"log{suffix}")))
    assert set(table.column_names[: len(log)]) == set(log)
    expected = table1.estimators["RESIDUAL"]
    for name in expected.values:
        unit = expected.units.get(name)
        title = f"estimate.{name} [{unit}]" if unit else f"estimate.{name}"
        rounding = STORED if table[title].type == pa.float32() else 1e-12
        assert table[title].to_numpy() == pytest.approx(expected[name], rel=rounding, abs=1e-12)
        is_short = suffix != ".csv" and name in expected.units and name != "change_age"
        assert (table[title].type == pa.float32()) == is_short, name
    assert table["estimate.t [s]"].type == pa.float64()
    assert table["t"].to_numpy().tolist() == log["t"].tolist()
    table_suffix = ".csv" if suffix == ".csv" else ".parquet"
    assert {path.suffix for path in Path("out").iterdir()} == {".json", ".csv", table_suffix}


def test_mat_of_version_7_3(table1: Recording, log: Columns, shell: Shell) -> None:
    # GIVEN what MATLAB writes: HDF5 behind 512 bytes, vectors as rows of a matrix, a structure
    path = Path("log.mat")
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in log.items():
            file[f"joint/{name}"] = values[None, :]
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64")
    table = estimated(shell, path, AS_IN_THE_FMU.replace('column = "', 'column = "joint.'))
    np.testing.assert_allclose(table[SIGMA], table1.estimators["RESIDUAL"]["sigma"], rtol=STORED)


def test_a_gap_is_skipped_as_the_estimator_skips_it(log: Columns, shell: Shell) -> None:
    # GIVEN rows taken out, and the same rows with nan instead
    lost = np.r_[4000:4300]
    holes = {name: np.delete(values, lost) for name, values in log.items()}
    filled = {name: values.copy() for name, values in log.items()}
    filled["q"][lost] = np.nan
    results = []
    for columns in (holes, filled):
        write_log(columns, Path("log.parquet"), AS_IN_THE_FMU)
        said = shell.run("estimate log.parquet --out out")
        assert "300 ticks skipped in 1 gaps, the longest of 0.3 s at 4 s" in said
        assert shell.err == ""  # no warning of the FMU for each gap
        results.append(read_estimate(Path("out")))
    # THEN the rows that both have are the same, and the skipped ones are marked
    a, b = (result[SIGMA].to_numpy() for result in results)
    assert np.array_equal(a, np.delete(b, lost))
    valid = results[1]["estimate.valid"].to_numpy()
    assert np.array_equal(np.flatnonzero(~valid), lost)
    assert np.all(b[lost] == b[lost[0] - 1])


def test_units_sign_zero_gear_and_wrap(table1: Recording, log: Columns, shell: Shell) -> None:
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
    table = estimated(shell, write_log(columns, Path("log.parquet")), configuration)
    expected = table1.estimators["RESIDUAL"]["sigma"]
    assert table[SIGMA].to_numpy()[1000:] == pytest.approx(expected[1000:], rel=STORED)


def test_slow_and_uneven_columns_are_interpolated(log: Columns, shell: Shell) -> None:
    # GIVEN theta_c every 10 ms, empty in between, and time stamps of the rows that jitter
    rng = np.random.default_rng(1)
    t = log["t"] + rng.uniform(-2e-4, 2e-4, len(log["t"]))
    columns = {name: np.interp(t, log["t"], log[name]) for name in COLUMNS}
    columns["theta_c"][np.arange(len(t)) % 10 != 0] = np.nan
    write_log({"t": t, **columns}, Path("log.parquet"), AS_IN_THE_FMU + "encoder.theta = 0\n")
    output = shell.run("estimate log.parquet --out out")
    assert re.search(r"theta_c: 1\d{4} ticks interpolated, its samples are 0.01 s apart", output)
    assert re.search(r"theta: 1\d{4} ticks interpolated", output)
    truth = 2 * 14220 * ((100 - 0.0025 / (2 * np.pi) * 1e3 * log["theta_c"]) / 1e3) ** 2
    sigma = read_estimate(Path("out"))[SIGMA].to_numpy()
    assert sigma[5000:-10] == pytest.approx(truth[5000:-10], rel=0.05)


def test_columns_with_times_of_their_own(log: Columns, shell: Shell) -> None:
    # GIVEN data sets of several lengths THEN ticks at their common samples are exact
    columns = {**log, "slow_t": log["t"][::10], "theta_c": log["theta_c"][::10]}
    configuration = AS_IN_THE_FMU.replace('"theta_c"', '"theta_c"\ntime = "slow_t"')
    table = estimated(shell, write_log(columns, Path("log.h5")), configuration)
    assert "theta_c" not in table.column_names  # it is no column of the table of t
    found = table["estimate.setPoint [1]"].to_numpy()[::10]
    scale = -0.0025 / (2 * np.pi) * 1e3
    assert found == pytest.approx(100 + scale * columns["theta_c"], rel=STORED)


def test_other_columns_stay_as_they_are(log: Columns, shell: Shell) -> None:
    path = write_log({**log, "note": np.array(["x, y"] * len(log["t"]))}, Path("log.csv"))
    estimated(shell, path)
    ours = path.read_text().splitlines()
    theirs = Path("out/estimate.csv").read_text().splitlines()
    assert len(ours) == len(theirs)
    for row in (1, 777, 15001):
        assert theirs[row].startswith(ours[row].split(",")[0])
        assert '"x, y"' in theirs[row]


@pytest.mark.parametrize(("period", "rate"), [(0.001, None), (0.01, 100.0)])
def test_filters_are_not_faster_than_the_samples(
    period: float, rate: float | None, log: Columns, shell: Shell
) -> None:
    every = round(period / 0.001)
    columns = {name: values[::every] for name, values in log.items()}
    write_log(columns, Path("log.parquet"), REGRESSION.replace("= 0.001", f"= {period}"))
    used = shell.json("estimate log.parquet")["parameters"]
    assert used["regression.bandwidth"] == (rate or 350.0)
    assert used["residual.K_I"] == (rate or 300.0)


def test_json_and_quiet(log: Columns, shell: Shell) -> None:
    write_log(log, Path("log.parquet"), AS_IN_THE_FMU)
    summary = shell.json("estimate log.parquet --out out")
    last = read_estimate(Path("out"))
    assert last[SIGMA].to_numpy()[-1] == pytest.approx(summary["sigma [N.m/rad]"], rel=STORED)
    # THEN the coefficients are those of (23) at the last sample
    eta = np.array(summary["eta"])
    phi = last["estimate.phi [rad]"].to_numpy()[-1]
    set_point = last["estimate.setPoint [1]"].to_numpy()[-1]
    powers = 2 * np.arange(len(eta)) + 1
    slope = (powers * phi ** (powers - 1)) @ eta @ set_point ** np.arange(eta.shape[1])
    assert slope == pytest.approx(summary["sigma [N.m/rad]"], rel=4 * STORED)
    assert (shell.run("estimate log.parquet --out out --quiet"), shell.err) == ("", "")


def test_why_and_how_often_the_estimate_is_not_confident(shell: Shell) -> None:
    # GIVEN a limit that only part of the estimates meets
    limits = "limit.relative_std = 0.022\nprior.torque_gain = 0.01\n"
    write_log(awas_log(1.0, 0.3), Path("log.parquet"), REGRESSION + limits)
    result = shell.json("estimate log.parquet --out out")
    table = read_estimate(Path("out"))
    doubt = np.array(table["estimate.doubt"].to_pylist())
    confident = table["estimate.confident"].to_numpy()
    # THEN the reason is None where it is confident, and only there
    assert np.array_equal(doubt == "None", confident)
    half = len(doubt) // 2
    assert 0 < result["confident"] < 1
    assert result["confident"] == np.mean(confident[half:])
    items = {*doubt[half:]} - {"None"}
    assert result["doubt"] == {item: np.mean(doubt[half:] == item) for item in items}
    # THEN what it rests on is that of the FMU, and the summary says it
    for name in ("misfit", "sigma_per_gain"):
        stored = table[f"estimate.{name} [1]"].to_numpy()[-1]
        assert result[name] == pytest.approx(stored, rel=STORED, abs=0)
    bias = table["estimate.bias_hat [N.m]"].to_numpy()[-1]
    assert result["joint"]["bias_hat"] == pytest.approx(bias, rel=STORED, abs=0)
    text = shell.run("estimate log.parquet --out out")
    assert len(text.splitlines()) <= 30
    assert re.search(r"not confident +\S+ % of the time \(\w+ \S+ %", text)
    by_gain = f"1 % of it changes sigma by {result['sigma_per_gain']:.3g} %"
    gain = f"known to 1 % (prior.torque_gain); {by_gain}"
    for line in (gain, "motor.B = 1.84e-05 kg.m2, exactly (prior.B = 0)", "range.phi = 0.3 rad"):
        assert line in text


def test_paper2011_makes_no_claim_and_has_no_band_in_the_figure(tmp_path: Path) -> None:
    for method, claims in (("Paper2011", False), ("FilteredRegression", True)):
        write_log(plain_log(), tmp_path / "log.csv", f'{AS_IN_THE_FMU}method = "{method}"\n')
        done = in_process("estimate", "log.csv", "--out", method, cwd=tmp_path)
        assert done.returncode == 0
        assert ("95 % band" in (tmp_path / method / "estimate.svg").read_text()) == claims
        assert (tmp_path / method / "estimate.png").stat().st_size > 0
        if not claims:
            assert "for which the method gives no standard deviation" in done.stdout
            assert done.stdout.count("standard deviation") == 1 and "confident" not in done.stdout
            doubt = read_estimate(tmp_path / method)["estimate.doubt"]
            assert set(doubt.to_pylist()) == {"NoClaim"}
