"""The estimates in other tools: MCAP, pandas, xarray, and a result without a folder."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader

import sigmahat
from command_line import working_in
from recorded_logs import REGRESSION, awas_log, read_estimate, write_log
from sigmahat.cli import main


@pytest.fixture(scope="module")
def knee(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a log, its configuration and results."""
    folder = tmp_path_factory.mktemp("knee")
    columns = awas_log(1.0, 0.3, 3.0)
    columns["q"][500] = np.nan
    with working_in(folder):
        write_log(columns, Path("knee.parquet"))
        Path("knee.toml").write_text(REGRESSION)
        assert main(["estimate", "knee.parquet", "--quiet", "--out", ".", "--to", "mcap"]) == 0
    return folder


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
    for name in ("sigma [N.m/rad]", "tau_e_std [N.m]", "valid", "doubt"):
        wanted = table[f"estimate.{name}"].to_numpy()
        sent = np.array([row[name.partition(" ")[0]] for row in rows])
        assert np.array_equal(sent.astype(wanted.dtype), wanted)
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
        assert np.array_equal(values.astype(np.float32), table["estimate.sigma [N.m/rad]"])
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
