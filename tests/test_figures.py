"""Figures: content, labels, units, files."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from recordings import one_seed
from sigmahat.figures import FIGURES, save


@pytest.fixture(scope="module", params=FIGURES)
def figure(request: pytest.FixtureRequest) -> Figure:
    return FIGURES[request.param](one_seed("table1").recording)


def line(name: str, label: str, panel: int = 0) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    axes = FIGURES[name](one_seed("table1").recording).axes[panel]
    (found,) = (each for each in axes.get_lines() if label in str(each.get_label()))
    return np.asarray(found.get_xdata()), np.asarray(found.get_ydata())


def test_axes_have_labels_with_units_and_the_figure_a_legend(figure: Figure) -> None:
    for axes in figure.axes:
        assert axes.get_xlabel() == "time $t$ [s]"
        assert re.search(r"\[.+\]", axes.get_ylabel())
    legend = figure.axes[0].get_legend()
    assert legend is not None
    assert all(text.get_text().strip() for text in legend.get_texts())
    for axes in figure.axes:
        for each in axes.get_lines():
            assert not str(each.get_label()).startswith("_")


def test_lines_cover_the_whole_run(figure: Figure) -> None:
    for each in figure.axes[0].get_lines():
        t = np.asarray(each.get_xdata())
        assert (t[0], t[-1]) == (0.0, 15.0)
        assert np.all(np.diff(t) > 0)


@pytest.mark.parametrize(
    ("name", "lines"),
    [
        ("fig3-deformation", 1),
        ("fig4-velocity", 3),
        ("fig5-flexibility-torque", 4),
        ("fig6-stiffness", 4),
        ("fig7-stability-factor", 1),
        ("fig8-constant-factors", 4),
        ("summary", 4),
    ],
)
def test_every_trace_of_the_paper_is_there(name: str, lines: int) -> None:
    figure = FIGURES[name](one_seed("table1").recording)
    labels = {str(each.get_label()) for each in figure.axes[0].get_lines()}
    assert len(labels) == lines


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


def test_zoom_shows_the_quantisation() -> None:
    count = 2 * np.pi / 40000 / 1e-3  # one count per sample [rad/s]
    _, differenced = line("fig4-velocity", "differenced", panel=1)
    steps = differenced / count
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)
    assert set(np.round(steps)) >= {-1.0, 0.0, 1.0}


def test_start_up_shows_every_sample() -> None:
    recording = one_seed("table1").recording
    t, sigma = line("fig6-stiffness", "RESIDUAL", panel=1)
    np.testing.assert_array_equal(t, recording.t[: len(t)])
    np.testing.assert_array_equal(sigma, recording.estimators["RESIDUAL"]["sigma"][: len(t)])
    assert t[-1] == pytest.approx(0.3)


def test_stability_factor_is_on_a_log_axis() -> None:
    figure = FIGURES["fig7-stability-factor"](one_seed("table1").recording)
    assert figure.axes[0].get_yscale() == "log"


@pytest.mark.parametrize("name", FIGURES)
def test_files_open_are_small_and_reproducible(name: str, tmp_path: Path) -> None:
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        save(FIGURES[name], one_seed("table1").recording, tmp_path / folder / name)
    with Image.open(tmp_path / "one" / f"{name}.png") as image:
        image.load()
        assert image.width >= 1000
    svg = (tmp_path / "one" / f"{name}.svg").read_bytes()
    assert svg.startswith(b"<?xml")
    assert len(svg) < 1_000_000
    assert svg == (tmp_path / "two" / f"{name}.svg").read_bytes()
