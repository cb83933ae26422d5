"""Figures: content, labels, units, files."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from recordings import one_seed
from sigmahat.paper.figures.catalogue import FIGURES
from sigmahat.paper.scenarios import SCENARIOS
from sigmahat.plotting.save import save

# One scenario of each kind, and its figures.
DRAWN = [
    (scenario, name)
    for scenario in ("table1", "experiment", "single-hardening", "antagonistic")
    for name in SCENARIOS[scenario].figures
]


def draw(scenario: str, name: str) -> Figure:
    return FIGURES[name](one_seed(scenario).recording)


def line(
    name: str, label: str, panel: int = 0, scenario: str = "table1"
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    axes = draw(scenario, name).axes[panel]
    (found, *_) = (each for each in axes.get_lines() if label in str(each.get_label()))
    return np.asarray(found.get_xdata()), np.asarray(found.get_ydata())


def test_every_figure_belongs_to_a_scenario_and_every_scenario_has_one() -> None:
    assert {name for scenario in SCENARIOS.values() for name in scenario.figures} == set(FIGURES)
    assert all(scenario.figures for scenario in SCENARIOS.values())
    assert {name for _, name in DRAWN} == set(FIGURES)


def test_drawn_values_are_those_of_the_recording() -> None:
    recording = one_seed("table1").recording
    for name, label, values in (
        ("fig3-deformation", "phi", recording.plant["phi"]),
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
    """tau_e = 150 phi + 3000 phi^3 N.m is the spring of the scenario."""
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
    save(FIGURES[name], one_seed(scenario).recording, tmp_path / name)
    with Image.open(tmp_path / f"{name}.png") as image:
        image.load()
        assert image.width >= 1000
    svg = (tmp_path / f"{name}.svg").read_bytes()
    assert svg.startswith(b"<?xml")
    assert len(svg) < 1_000_000
