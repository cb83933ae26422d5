"""The figures of the paper: drawn values, and files."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from recordings import one_seed
from sigmahat.paper.figures import FIGURES
from sigmahat.paper.scenarios import SCENARIOS
from sigmahat.show.figure import in_rows, save

# One scenario of each kind, and the figures that are drawn for each scenario.
DRAWN = [
    (scenario, name)
    for scenario in ("table1", "experiment", "single-hardening", "antagonistic")
    for name in SCENARIOS[scenario].figures
]


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
