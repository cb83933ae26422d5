"""`sigmahat estimate` on a recorded log gives the same results as the co-simulation."""

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
from sigmahat.experiments.simulation import run
from sigmahat.fmi.master import Recording
from sigmahat.paper.scenarios import SCENARIOS
from sigmahat.recording.configuration import Port
from sigmahat.recording.readers.formats import open_log
from sigmahat.recording.units import Conversion

SIGMA = "estimate.sigma [N.m/rad]"
AS_IN_THE_FMU = re.sub(r"motor\..*\n", "", CONFIGURATION)


@pytest.fixture(scope="module")
def table1() -> Recording:
    return run(SCENARIOS["table1"], seed=1)


@pytest.fixture(scope="module")
def log(table1: Recording) -> Columns:
    return {"t": table1.t, **{port: table1.plant[name] for port, name in COLUMNS.items()}}


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".mat", ".h5"])
def test_replay_is_the_cosimulation(
    suffix: str, table1: Recording, log: Columns, shell: Shell
) -> None:
    write_log(log, Path(f"log{suffix}"), AS_IN_THE_FMU)
    shell.run(f"estimate log{suffix} --out out")
    table = read_estimate(Path("out"))
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


def test_mat_of_version_7_3(log: Columns, tmp_path: Path) -> None:
    # GIVEN a MATLAB file with HDF5 after 512 bytes, vectors as rows of a matrix, and a structure
    path = tmp_path / "log.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in log.items():
            file[f"joint/{name}"] = values[None, :]
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64")
    found = open_log(path)
    assert all(np.array_equal(found.read(f"joint.{name}"), log[name]) for name in log)


ENCODER = Port("x", unit="counts", counts_per_turn=800, gear_ratio=50, sign=-1.0, zero=700)


@pytest.mark.parametrize(
    ("name", "port", "value", "expected"),
    [
        ("theta", ENCODER, 700.0 - 40_000.0, 2 * np.pi),
        ("q", Port("x", unit="deg", zero=12), 192.0, np.pi),
        ("q", Port("x", unit="mrad", gear_ratio=-2.0), 500.0, -0.25),
        ("theta_c", Port("x", unit="mm", zero=100, mm_per_turn=-2.5), 97.5, 2 * np.pi),
        ("theta_c", Port("x", unit="mm"), 97.5, 97.5),
        ("tau", Port("x", unit="mA", torque_constant=0.05, sign=-1.0), 1000.0, -0.05),
        ("tau", Port("x", scale=3.0, zero=-1.0), 1.0, 6.0),
    ],
)
def test_units_sign_zero_and_gear(name: str, port: Port, value: float, expected: float) -> None:
    assert Conversion.of(name, port).apply(np.array([value])) == pytest.approx([expected])


def test_other_columns_stay_as_they_are(log: Columns, shell: Shell) -> None:
    log = {**log, "note": np.array(["x, y"] * len(log["t"]))}
    path = write_log(log, Path("log.csv"), AS_IN_THE_FMU)
    shell.run("estimate log.csv --out out")
    ours = path.read_text().splitlines()
    theirs = Path("out/estimate.csv").read_text().splitlines()
    assert len(ours) == len(theirs)
    for row in (1, 777, 15001):
        assert theirs[row].startswith(ours[row].split(",")[0])
        assert '"x, y"' in theirs[row]


def test_json_and_quiet(log: Columns, shell: Shell) -> None:
    write_log(log, Path("log.parquet"), AS_IN_THE_FMU)
    summary = shell.json("estimate log.parquet --out out")
    last = read_estimate(Path("out"))
    assert last[SIGMA].to_numpy()[-1] == pytest.approx(summary["sigma"], rel=STORED)
    # THEN the coefficients give the last stiffness by equation (23).
    eta = np.array(summary["eta"])
    phi = last["estimate.phi [rad]"].to_numpy()[-1]
    set_point = last["estimate.setPoint [1]"].to_numpy()[-1]
    powers = 2 * np.arange(len(eta)) + 1
    slope = (powers * phi ** (powers - 1)) @ eta @ set_point ** np.arange(eta.shape[1])
    assert slope == pytest.approx(summary["sigma"], rel=4 * STORED)
    assert (shell.run("estimate log.parquet --out out --quiet"), shell.err) == ("", "")


def test_why_and_how_often_the_estimate_is_not_confident(shell: Shell) -> None:
    # GIVEN a limit of the standard deviation that only some of the estimates satisfy
    limits = "limit.relative_std = 0.022\nprior.torque_gain = 0.01\n"
    write_log(awas_log(1.0, 0.3), Path("log.parquet"), REGRESSION + limits)
    result = shell.json("estimate log.parquet --out out")
    table = read_estimate(Path("out"))
    doubt = np.array(table["estimate.doubt"].to_pylist())
    confident = table["estimate.confident"].to_numpy()
    # THEN the doubt is None exactly where the estimate is confident.
    assert np.array_equal(doubt == "None", confident)
    half = len(doubt) // 2
    assert 0 < result["confident"] < 1
    assert result["confident"] == np.mean(confident[half:])
    items = {*doubt[half:]} - {"None"}
    assert result["doubt"] == {item: np.mean(doubt[half:] == item) for item in items}
    # THEN the summary contains the last values of misfit, sigma_per_gain and bias_hat.
    for name in ("misfit", "sigma_per_gain"):
        stored = table[f"estimate.{name} [1]"].to_numpy()[-1]
        assert result[name] == pytest.approx(stored, rel=STORED, abs=0)
    bias = table["estimate.bias_hat [N.m]"].to_numpy()[-1]
    assert result["joint"]["bias_hat"] == pytest.approx(bias, rel=STORED, abs=0)
    text = shell.run("estimate log.parquet --out out")
    assert len(text.splitlines()) <= 30
    assert re.search(r"not confident +\S+ % of the time \(\w+ \S+ %", text)
    per_gain = np.median(table["estimate.sigma_per_gain [1]"].to_numpy()[half:])
    by_gain = f"1 % of it changes the stiffness by {per_gain:.3g} %"
    for line in (f"known to 1 %; {by_gain}", "prior.B: motor.B = 1.84e-05 is taken as exact"):
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
