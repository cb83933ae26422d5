"""CSV logs, and the table of estimates in its own file, in MCAP, in pandas and in xarray."""

import json
from pathlib import Path

import h5py
import numpy as np
import pyarrow.csv
import pytest
import scipy.io
from mcap.reader import make_reader

import sigmahat
from command_line import Shell
from recorded_logs import (
    CONFIGURATION,
    REGRESSION,
    STORED,
    awas_log,
    estimated,
    plain_log,
    read_estimate,
    write_log,
)
from sigmahat.recording.log import LogError
from sigmahat.recording.readers.formats import open_log
from sigmahat.result.estimate_table import EstimateTable

ROWS = 2000


def test_a_csv_log_is_parsed_once(tmp_path: Path) -> None:
    # GIVEN a file that is deleted after it was opened, THEN all of its numbers are available.
    path = write_log(plain_log(), tmp_path / "log.csv")
    log = open_log(path)
    path.unlink()
    assert log.columns == dict.fromkeys(plain_log(), ROWS)
    for name, values in plain_log().items():
        assert np.array_equal(log.read(name), values)
    rows = [batch.num_rows for batch in log.batches(["t", "q"], 300)]
    assert sum(rows) == ROWS and max(rows) <= 300


def test_a_column_that_begins_with_numbers_may_go_on_with_text(tmp_path: Path) -> None:
    # GIVEN text behind the first part of the CSV file, which determines the types of the columns
    rows = 40_000
    note = np.arange(rows).astype(str)
    note[-1] = "end"
    path = write_log({**plain_log(rows), "note": note}, tmp_path / "log.csv")
    assert path.stat().st_size > 2 << 20
    log = open_log(path)
    assert np.array_equal(log.read("q"), plain_log(rows)["q"])
    with pytest.raises(LogError, match=r"'note' holds text \('end' in row 40000\)"):
        log.read("note")
    (batch,) = log.batches(["note"], rows)
    assert batch["note"].to_pylist()[-2:] == ["39998", "end"]


@pytest.mark.parametrize("begin", [0, 500], ids=["whole numbers", "fractions later"])
def test_whole_numbers_stay_whole_numbers(begin: int, tmp_path: Path) -> None:
    # GIVEN a column of nanoseconds since 1970, which a float64 cannot represent exactly
    # GIVEN a column with integers at first and fractions in a later part of the file
    rows = ROWS if not begin else 60_000
    stamps = 1_700_000_000_123_456_789 + 1_000_000 * np.arange(rows, dtype=np.int64)
    note = np.array(["0"] * (rows - begin) + ["0.5"] * begin)
    path = write_log({**plain_log(rows), "t": stamps, "note": note}, tmp_path / "log.csv")
    path.write_text(path.read_text().replace('"', ""))
    log = open_log(path)
    (first,) = log.batches(["t"], rows)
    assert first["t"].to_pylist() == stamps.tolist()
    assert np.array_equal(log.read("t"), 1e6 * np.arange(rows))
    assert log.read("note").sum() == 0.5 * begin


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        (np.arange(5, dtype=np.uint64) + np.uint64(2**63), np.arange(5.0)),
        (np.datetime64("9000-01-01", "ms") + np.arange(5), 1e-3 * np.arange(5.0)),
    ],
    ids=["whole numbers", "dates"],
)
def test_times_beyond_an_int64_of_nanoseconds(
    values: np.ndarray, expected: np.ndarray, tmp_path: Path
) -> None:
    log = open_log(write_log({"t": values, "q": expected}, tmp_path / "log.parquet"))
    assert np.array_equal(log.read("t"), expected)


def test_dates_are_times_and_stay_as_they_are(shell: Shell) -> None:
    stamps = np.datetime64("2024-05-01T12:00:00.250") + np.arange(ROWS).astype("timedelta64[ms]")
    text = np.datetime_as_string(stamps, "ms")
    write_log({**plain_log(), "t": text}, Path("log.csv"), CONFIGURATION)
    shell.run("estimate log.csv --out .")
    strings = pyarrow.csv.ConvertOptions(column_types={"t": pyarrow.string()})
    written = pyarrow.csv.read_csv("estimate.csv", convert_options=strings)
    assert written["t"].to_pylist() == text.tolist()
    assert np.allclose(EstimateTable(Path()).t, plain_log()["t"], rtol=0, atol=1e-12)


def test_a_text_as_programs_write_it_is_read_with_a_word(shell: Shell) -> None:
    """GIVEN a log in Windows-1252 with a line of units, decimal commas and a truncated last row."""
    write_log(plain_log(), Path("clean.csv"))
    names, *rows = Path("clean.csv").read_text().replace('"', "").replace(",", ";").splitlines()
    units = {"t": "s", "theta": "rad", "q": "rad", "theta_c": "mm", "tau": "N.m"}
    text = [f"{names};Größe", ";".join([*(units[name] for name in names.split(";")), "µm"])]
    text += [f"{row};1".replace(".", ",") for row in rows]
    text.insert(20, text[19])
    text[-1] = ";".join(text[-1].split(";")[:2])
    Path("dirty.csv").write_bytes("\r\n".join(text).encode("cp1252"))

    said = shell.run("init dirty.csv")
    for each in ("read as windows-1252", "line 2 has the units", "a row with 2 of"):
        assert each in said
    configuration = CONFIGURATION
    for name, unit in units.items():
        configuration = configuration.replace(f'column = "{name}"', f'column = "{name} [{unit}]"')
    Path("dirty.toml").write_text(configuration)
    Path("clean.toml").write_text(CONFIGURATION)
    shell.run("estimate clean.csv --out clean")
    said = shell.run("estimate dirty.csv --out dirty")
    assert "1 rows with the time of the row before left out" in said
    clean, dirty = EstimateTable(Path("clean")), EstimateTable(Path("dirty"))
    got = np.delete(dirty["sigma"], 18)  # row with a duplicate time
    assert np.array_equal(got[: ROWS - 1], clean["sigma"][: ROWS - 1])
    last = Path("dirty/estimate.csv").read_text().splitlines()[-1]
    assert ";" in last and "." not in last.replace("FilteredRegression", "")


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_estimates_are_read_as_they_were_written(suffix: str, shell: Shell) -> None:
    write_log({**plain_log(), "note [V]": np.full(ROWS, 3.0)}, Path(f"log{suffix}"), CONFIGURATION)
    shell.run(f"estimate log{suffix} --out out")
    signals = EstimateTable(Path("out"))
    assert next(iter(signals)) == "sigma" and signals.used.all()
    units = signals.units
    assert units.items() >= {"t": "s", "sigma": "N.m/rad", "a": "1", "valid": None}.items()
    assert not units.keys() & {"note", "q", "theta"}  # these columns are in the log
    for values in signals.values():
        assert values.dtype == np.float64 and values.shape == (ROWS,)
    phi = plain_log()["q"] - plain_log()["theta"]
    rounding = STORED if suffix == ".parquet" else 1e-12
    assert np.allclose(signals["phi"], phi, rtol=rounding, atol=1e-15)


# ---- in other tools ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def knee(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with a log, the configuration of the log, and its results."""
    columns = awas_log(1.0, 0.3, 3.0)
    columns["q"][500] = np.nan
    return estimated(tmp_path_factory.mktemp("knee"), columns, REGRESSION, "--out . --to mcap")


def test_mcap_has_the_rows_of_the_table_with_units(knee: Path) -> None:
    with (knee / "estimate.mcap").open("rb") as file:
        found = list(make_reader(file).iter_messages(topics="/estimate"))
    described = found[0][0]
    assert described is not None
    assert described.encoding == "jsonschema"
    schema = json.loads(described.data)
    assert schema["properties"]["sigma"]["description"].endswith("[N.m/rad]")
    rows = [json.loads(message.data) for _, _, message in found]
    table = read_estimate(knee)
    sent = {name: [row[name] for row in rows] for name in ("sigma", "tau_e_std", "valid", "doubt")}
    for name in ("valid", "doubt"):
        assert sent[name] == table[f"estimate.{name}"].to_pylist()
    for title in ("sigma [N.m/rad]", "tau_e_std [N.m]"):
        numbers = sent[title.partition(" ")[0]]
        np.testing.assert_allclose(numbers, table[f"estimate.{title}"], rtol=STORED, atol=0)
    times = table["estimate.t [s]"].to_pylist()
    assert [m.log_time for _, _, m in found] == [round(1e9 * t) for t in times]


def test_without_a_folder_the_result_is_that_of_the_files(knee: Path) -> None:
    log = sigmahat.open_log(str(knee / "knee.parquet"))
    configuration = sigmahat.read_configuration(str(knee / "knee.toml"))
    before = sorted(knee.iterdir())
    result = sigmahat.estimate(log, configuration)
    assert sorted(knee.iterdir()) == before
    assert result.series is not None
    table = read_estimate(knee)
    frame, sigma = result.series.to_dataframe(), result.series.to_xarray()["sigma"]
    for values in (frame["sigma"].to_numpy(), sigma.to_numpy()):
        np.testing.assert_allclose(values, table["estimate.sigma [N.m/rad]"], rtol=STORED, atol=0)
    np.testing.assert_array_equal(frame.index, table["estimate.t [s]"])
    assert frame.attrs["unit"]["tau_e"] == "N.m"
    assert (sigma.attrs["unit"], sigma.t.attrs["unit"]) == ("N.m/rad", "s")
    assert sigma.attrs["description"].startswith("Stiffness estimate")
    assert isinstance(sigmahat.check(log, configuration), sigmahat.Checked)


def test_several_joints_are_a_dimension() -> None:
    theta = np.stack([np.sin(np.arange(50) / 10), np.cos(np.arange(50) / 10)])
    found = sigmahat.Estimator({"method": "Paper2011"}).run(theta, 1.01 * theta, 0 * theta)
    assert found.to_xarray()["phi"].dims == ("joint", "t")
    frame = found.to_dataframe()
    assert frame.index.names == ["joint", "t"]
    np.testing.assert_array_equal(frame.loc[1, "phi"], found["phi"][1])


def test_an_array_of_structures_has_a_column_for_each_signal(tmp_path: Path) -> None:
    signals = np.zeros((1, 3), dtype=[("Name", object), ("Unit", object), ("Data", object)])
    for k, (name, unit) in enumerate((("Motor", "count"), ("Link", "deg"), ("Link", "deg"))):
        signals[0, k] = name, unit, np.arange(5.0)[None, :] + k
    recorded = {"X": {"Data": 0.1 * np.arange(5.0)}, "Y": signals}
    scipy.io.savemat(tmp_path / "log.mat", {"rec": recorded})
    log = open_log(tmp_path / "log.mat")
    assert list(log.columns) == ["rec.X.Data", "Motor", "Link", "Link (2)"]
    assert log.units == {"Motor": "count", "Link": "deg"}
    np.testing.assert_array_equal(log.read("Link (2)"), np.arange(5.0) + 2)


def test_units_in_attributes_of_hdf5(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "log.h5", "w") as file:
        file["joint/position"] = np.arange(5.0).reshape(5, 1)
        file["joint/position"].attrs["unit"] = "arcmin"
        file["joint/torque"] = np.arange(5.0)
        file["joint/torque"].attrs["units"] = np.bytes_("mN*m")
        file["t"] = np.arange(5.0)
    log = open_log(tmp_path / "log.h5")
    assert log.units == {"joint.position": "arcmin", "joint.torque": "mN*m"}
