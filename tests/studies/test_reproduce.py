"""Results of `sigmahat reproduce`: the table, and the time series with labels and units."""

import csv
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from recordings import one_seed
from sigmahat.experiments.metrics import Indices
from sigmahat.studies import reproduce_results
from sigmahat.studies.reproduce_results import (
    Reproduced,
    conditions,
    printed_table,
    write_series,
)

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


def rows_of_table(result: Reproduced) -> dict[str, dict[str, Any]]:
    """Returns the rows of the JSON table by the name of the estimation."""
    return {row["estimation"]: row for row in reproduce_results.values(result)["table"]}


def test_table_of_one_seed() -> None:
    result = one_seed("table1")
    rows = rows_of_table(result)
    assert list(rows) == ROWS
    for name, row in rows.items():
        expected = result.indices[0][name]
        assert row["mse"]["mean"] == expected.mse
        assert row["msrep"]["mean"] == expected.msrep
        assert row["msrep_settled"]["mean"] == expected.msrep_settled
        assert math.isnan(row["mse"]["half_width"])
        assert row["seeds"] == 1
    assert rows["RESIDUAL"]["paper"] == {"mse": 128.1614, "msrep": 0.58}
    assert rows["MODEL-measured"]["paper"]["msrep"] is None  # the paper has no such value
    units = reproduce_results.values(result)["units"]
    assert (units["mse"], units["msrep_settled"]) == ("(N.m/rad)2", "%")


def test_mean_and_interval_over_seeds() -> None:
    each = [{name: Indices(*[x] * 6) for name in ROWS} for x in (1.0, 2.0, 3.0)]
    result = replace(one_seed("table1"), seeds=[1, 2, 3], indices=each)
    row = rows_of_table(result)["MODEL"]
    assert row["mse"]["mean"] == 2.0
    assert row["mse"]["half_width"] == pytest.approx(2.48414, rel=1e-5)
    assert row["seeds"] == 3
    assert "2.00 +- 2.48" in printed_table(result)
    assert "3 seeds" in conditions(result)


def test_index_that_is_not_defined_is_a_dash_and_null() -> None:
    """GIVEN a stiffness of 0 from SENSOR at the start, THEN its relative error is undefined."""
    result = one_seed("experiment")
    whole = printed_table(result).split("\n\n")[1]
    cells = {row[0]: row[1:] for row in (re.split("  +", x) for x in whole.splitlines())}
    assert cells["RESIDUAL against SENSOR"][1:] == ["-", "-"]
    assert "-" not in cells["RESIDUAL against SENSOR, relative to true"]
    row = rows_of_table(result)["RESIDUAL against SENSOR"]
    assert math.isnan(row["msrep"]["mean"]) and math.isnan(row["error"]["mean"])
    expected = result.indices[0]["RESIDUAL against SENSOR"]
    assert row["msrep_settled"]["mean"] == expected.msrep_settled
