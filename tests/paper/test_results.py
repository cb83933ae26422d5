"""Files with results: the table, the time series, and the figures with labels and units."""

import csv
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from recordings import one_seed
from sigmahat.experiments.metrics import Indices
from sigmahat.paper.figures import FIGURES
from sigmahat.paper.reproduction import Result, as_dict, conditions, table, write_series
from sigmahat.paper.scenarios import SCENARIOS
from sigmahat.show.figure import in_rows, save

ROWS = ["MODEL", "SENSOR", "RESIDUAL", "MODEL-measured"]
# One scenario of each kind, and the figures that are drawn for each scenario.
DRAWN = [
    (scenario, name)
    for scenario in ("table1", "experiment", "single-hardening", "antagonistic")
    for name in SCENARIOS[scenario].figures
]


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


def rows_of_table(result: Result) -> dict[str, dict[str, Any]]:
    """Returns the rows of the JSON table by the name of the estimation."""
    return {row["estimation"]: row for row in as_dict(result)["table"]}


def test_table_of_one_seed() -> None:
    result = one_seed("table1")
    rows = rows_of_table(result)
    assert list(rows) == ROWS
    for name, row in rows.items():
        expected = result.indices[0][name]
        assert row["MSE [(N.m/rad)2]"] == expected.mse
        assert row["MSREP [%]"] == expected.msrep
        assert row["MSREP after 1 s [%]"] == expected.msrep_settled
        assert row["MSE 95 % half width [(N.m/rad)2]"] is None
        assert row["seeds"] == 1
    assert rows["RESIDUAL"]["MSE of the paper [(N.m/rad)2]"] == 128.1614
    assert rows["RESIDUAL"]["MSREP of the paper [%]"] == 0.58
    assert rows["MODEL-measured"]["MSREP of the paper [%]"] is None  # the paper has no such value


def test_mean_and_interval_over_seeds() -> None:
    each = [{name: Indices(*[x] * 6) for name in ROWS} for x in (1.0, 2.0, 3.0)]
    result = replace(one_seed("table1"), seeds=[1, 2, 3], indices=each)
    row = rows_of_table(result)["MODEL"]
    assert row["MSE [(N.m/rad)2]"] == 2.0
    assert row["MSE 95 % half width [(N.m/rad)2]"] == pytest.approx(2.48414, rel=1e-5)
    assert row["seeds"] == 3
    assert "2.00 +- 2.48" in table(result)
    assert "3 seeds" in conditions(result)


def test_index_that_is_not_defined_is_a_dash_and_null() -> None:
    """GIVEN a stiffness of 0 from SENSOR at the start, THEN its relative error is undefined."""
    result = one_seed("experiment")
    whole = table(result).split("\n\n")[1]
    cells = {row[0]: row[1:] for row in (re.split("  +", x) for x in whole.splitlines())}
    assert cells["RESIDUAL against SENSOR"][1:] == ["-", "-"]
    assert "-" not in cells["RESIDUAL against SENSOR, relative to true"]
    row = rows_of_table(result)["RESIDUAL against SENSOR"]
    assert row["MSREP [%]"] is row["mean error [%]"] is None
    expected = result.indices[0]["RESIDUAL against SENSOR"]
    assert row["MSREP after 1 s [%]"] == expected.msrep_settled


# Figures


def line(
    name: str, label: str, panel: int = 0, scenario: str = "table1"
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    rows = FIGURES[name](one_seed(scenario).recording)
    panels = [each for row in rows for each in row]
    curve = next(each for each in panels[panel].curves if label in each.label)
    return curve.x, curve.y


def test_every_figure_belongs_to_a_scenario_and_every_scenario_has_one() -> None:
    assert {name for scenario in SCENARIOS.values() for name in scenario.figures} == set(FIGURES)
    assert all(scenario.figures for scenario in SCENARIOS.values())
    assert {name for _, name in DRAWN} == set(FIGURES)


def test_drawn_values_are_those_of_the_recording() -> None:
    recording = one_seed("table1").recording
    for name, label, values in (
        ("fig3-deformation", "deformation", recording.plant["phi"]),
        ("fig4-velocity", "Kalman", recording.estimators["RESIDUAL"]["theta_dot"]),
        ("fig4-velocity", "true", recording.plant["theta_dot"]),
        ("fig5-flexibility-torque", "sensor", recording.plant["tau_e_measured"]),
        ("fig5-flexibility-torque", "true", recording.plant["tau_e"]),
        ("fig5-flexibility-torque", "fitted", recording.estimators["RESIDUAL"]["tau_e"]),
        ("fig5-flexibility-torque", "residual", recording.estimators["RESIDUAL"]["tau_e_residual"]),
        ("fig6-stiffness", "SENSOR", recording.estimators["SENSOR"]["sigma"]),
        ("fig6-stiffness", "MODEL", recording.estimators["MODEL"]["sigma"]),
        ("fig7-stability-factor", "RESIDUAL", recording.estimators["RESIDUAL"]["a"]),
        ("fig8-constant-factors", "enhanced", recording.estimators["RESIDUAL"]["sigma"]),
    ):
        t, drawn = line(name, label)
        np.testing.assert_array_equal(drawn, values[np.searchsorted(recording.t, t)])
        assert (drawn.min(), drawn.max()) == (values.min(), values.max())


def test_the_curves_of_a_transmission_are_the_spring_and_its_estimate() -> None:
    """GIVEN a scenario with the spring torque tau_e = 150 phi + 3000 phi^3 N.m."""
    recording = one_seed("single-hardening").recording
    estimate = recording.estimators["RESIDUAL"]
    for panel, signal in ((1, "tau_e"), (2, "sigma")):
        phi, true = line("transmission", "true", panel, "single-hardening")
        spring = 150 * phi + 3000 * phi**3 if panel == 1 else 150 + 9000 * phi**2
        np.testing.assert_allclose(true, spring, rtol=1e-6, atol=1e-9)
        phi, drawn = line("transmission", "RESIDUAL", panel, "single-hardening")
        assert len(phi) > 50
        last = recording.t >= 10.0
        pairs = set(zip(estimate["phi"][last], estimate[signal][last], strict=True))
        assert set(zip(phi, drawn, strict=True)) <= pairs


@pytest.mark.parametrize(("scenario", "name"), DRAWN)
@pytest.mark.slow("a scenario is simulated and drawn")
def test_files_open_and_are_small(scenario: str, name: str, tmp_path: Path) -> None:
    save(in_rows, FIGURES[name](one_seed(scenario).recording), tmp_path / name)
    with Image.open(tmp_path / f"{name}.png") as image:
        image.load()
        assert image.width >= 1000
    svg = (tmp_path / f"{name}.svg").read_bytes()
    assert svg.startswith(b"<?xml")
    assert len(svg) < 1_000_000
