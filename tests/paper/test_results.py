"""The table and the CSV files."""

import csv
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from recordings import one_seed
from sigmahat.paper.reproduction import conditions, table, write_series, write_table
from sigmahat.runs.metrics import Indices

ROWS = ["MODEL", "SENSOR", "RESIDUAL", "MODEL-measured"]


def test_series_file_has_units_and_the_exact_values(tmp_path: Path) -> None:
    recording = one_seed("table1").recording
    write_series(recording, "RESIDUAL", tmp_path / "series.csv")
    with (tmp_path / "series.csv").open(newline="") as file:
        head, *rows = csv.reader(file)
    assert head[0] == "t [s]"
    assert {"plant.sigma [N.m/rad]", "sigma [N.m/rad]", "a [1]", "valid"} < set(head)
    assert len(head) == len(set(head))
    assert len(rows) == 15001
    numbers = np.array(rows, dtype=float)
    for title, values in (
        ("t [s]", recording.t),
        ("plant.theta_measured [rad]", recording.plant["theta_measured"]),
        ("plant.sigma [N.m/rad]", recording.plant["sigma"]),
        ("sigma [N.m/rad]", recording.estimators["RESIDUAL"]["sigma"]),
        ("epsilon [N.m]", recording.estimators["RESIDUAL"]["epsilon"]),
        ("valid", recording.estimators["RESIDUAL"]["valid"]),
    ):
        np.testing.assert_array_equal(numbers[:, head.index(title)], values)


def test_table_file_of_one_seed(tmp_path: Path) -> None:
    result = one_seed("table1")
    write_table(result, tmp_path / "table.csv")
    with (tmp_path / "table.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["estimation"] for row in rows] == ROWS
    for row in rows:
        expected = result.indices[0][row["estimation"]]
        assert float(row["MSE [(N.m/rad)2]"]) == expected.mse
        assert float(row["MSREP [%]"]) == expected.msrep
        assert float(row["MSREP after 1 s [%]"]) == expected.msrep_settled
        assert row["MSE 95 % half width [(N.m/rad)2]"] == ""
        assert row["seeds"] == "1"
    assert float(rows[2]["MSE of the paper [(N.m/rad)2]"]) == 128.1614
    assert float(rows[2]["MSREP of the paper [%]"]) == 0.58
    assert rows[3]["MSREP of the paper [%]"] == ""  # the paper has no such row


def test_mean_and_interval_over_seeds(tmp_path: Path) -> None:
    each = [{name: Indices(*[x] * 6) for name in ROWS} for x in (1.0, 2.0, 3.0)]
    result = replace(one_seed("table1"), seeds=[1, 2, 3], indices=each)
    write_table(result, tmp_path / "table.csv")
    with (tmp_path / "table.csv").open(newline="") as file:
        row = next(csv.DictReader(file))
    assert float(row["MSE [(N.m/rad)2]"]) == 2.0
    assert float(row["MSE 95 % half width [(N.m/rad)2]"]) == pytest.approx(2.48414, rel=1e-5)
    assert row["seeds"] == "3"
    assert "2.00 +- 2.48" in table(result)
    assert "3 seeds" in conditions(result)


def test_index_that_is_not_defined_is_a_dash_and_an_empty_field(tmp_path: Path) -> None:
    """SENSOR is 0 until the joint deforms."""
    result = one_seed("experiment")
    whole = table(result).split("\n\n")[1]
    cells = {row[0]: row[1:] for row in (re.split("  +", x) for x in whole.splitlines())}
    assert cells["RESIDUAL against SENSOR"][1:] == ["-", "-"]
    assert "-" not in cells["RESIDUAL against SENSOR, relative to true"]
    write_table(result, tmp_path / "table.csv")
    with (tmp_path / "table.csv").open(newline="") as file:
        rows = {row["estimation"]: row for row in csv.DictReader(file)}
    row = rows["RESIDUAL against SENSOR"]
    assert row["MSREP [%]"] == row["mean error [%]"] == ""
    assert (
        float(row["MSREP after 1 s [%]"])
        == result.indices[0]["RESIDUAL against SENSOR"].msrep_settled
    )
