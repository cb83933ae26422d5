"""Figures 3 to 12 of the paper, a summary of the AwAS, and all figures by their names."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sigmahat.fmi.master import Recording
from sigmahat.paper.figures import curves
from sigmahat.paper.figures.panels import (
    EVERYTHING,
    STIFFNESS,
    TORQUE,
    TRUE,
    Array,
    error_lines,
    first_reversal,
    legend_above,
    limit,
    line,
    stiffness_lines,
    time_panels,
    window,
)
from sigmahat.plotting.style import BLUE, GREEN, SKY, VERMILION
from sigmahat.runs.scenario import nominal_awas

_HELD: dict[str, Any] = {"color": SKY, "drawstyle": "steps-post"}
_NOMINAL: dict[str, Any] = {"color": "black", "linewidth": 0.8, "label": "nominal"}
_VELOCITY = r"motor velocity $\dot\theta$ [rad/s]"

Draw = Callable[[Axes, slice], object]
"""Draws some of the samples."""


def _signals(t: Array, signals: Sequence[tuple[Array, Mapping[str, Any]]], label: str) -> Draw:
    def draw(axes: Axes, shown: slice) -> None:
        for values, style in signals:
            line(axes, t[shown], values[shown], **style)
        axes.set_ylabel(label)

    return draw


def _whole_and_part(t: Array, draw: Draw, part: slice, title: str) -> tuple[Figure, list[Axes]]:
    """A panel with all samples, and a panel with a part of them, which has the title."""
    figure, panels = time_panels(2)
    draw(panels[0], EVERYTHING)
    draw(panels[1], part)
    panels[1].set_title(title, fontsize=9)
    return figure, panels


def _one_panel(draw: Callable[[Axes, Recording], object]) -> Callable[[Recording], Figure]:
    """The figure with nothing but this panel."""

    def draw_figure(recording: Recording) -> Figure:
        figure, (axes,) = time_panels(1)
        draw(axes, recording)
        return figure

    return draw_figure


def deformation(axes: Axes, recording: Recording) -> None:
    """Figures 3 and 9: deformation phi."""
    line(axes, recording.t, recording.plant["phi"], color=BLUE, label=r"deformation $\phi$")
    axes.set_ylabel(r"deformation $\phi$ [rad]")
    legend_above(axes)


def velocity(recording: Recording) -> Figure:
    """Figure 4: motor velocity, true, differenced, and from the modified Kalman filter.

    The second panel shows a reversal of the motor, where the quantisation is largest compared with
    the velocity.
    """
    t, true = recording.t, recording.plant["theta_dot"]
    differenced = np.diff(recording.plant["theta_measured"], prepend=0.0) / (t[1] - t[0])
    differenced[0] = 0.0
    signals = [
        (true, TRUE),
        (differenced, {"label": r"differenced, $\Delta\theta/T$", **_HELD}),
        (
            recording.estimators["RESIDUAL"]["theta_dot"],
            {"color": VERMILION, "label": "modified kinematic Kalman filter"},
        ),
    ]
    part = window(t, first_reversal(t, true), 0.05)
    figure, panels = _whole_and_part(t, _signals(t, signals, _VELOCITY), part, "at a reversal")
    panels[0].legend()
    return figure


def flexibility_torque(recording: Recording) -> Figure:
    """Figure 5: flexibility torque, true, from the residual, from the sensor, and as fitted."""
    t, plant, estimate = recording.t, recording.plant, recording.estimators["RESIDUAL"]
    signals = [
        (estimate["tau_e_residual"], {"color": SKY, "label": r"residual $\gamma r_e$"}),
        (plant["tau_e_measured"], {"color": GREEN, "label": "sensor"}),
        (plant["tau_e"], TRUE),
        (estimate["tau_e"], {"color": VERMILION, "label": r"fitted, $f(\theta_c, \phi)$"}),
    ]
    part = window(t, first_reversal(t, plant["tau_e"]), 0.25)
    title = "where the torque changes sign"
    figure, panels = _whole_and_part(t, _signals(t, signals, TORQUE), part, title)
    panels[0].legend(ncols=2)
    return figure


def stiffness(recording: Recording) -> Figure:
    """Figure 6: stiffness, true and estimated in the three modalities, and its start-up."""
    t = recording.t
    draw = partial(stiffness_lines, recording)
    figure, panels = _whole_and_part(t, draw, window(t, 0.0, 0.3), "start-up")
    panels[0].legend(ncols=2)
    return figure


def stability_factor(axes: Axes, recording: Recording) -> None:
    """Figure 7: stability factor a(k) of the RESIDUAL estimate."""
    line(axes, recording.t, recording.estimators["RESIDUAL"]["a"], color=BLUE, label="RESIDUAL")
    axes.set_yscale("log")
    axes.set_ylabel("stability factor $a(k)$ [1]")
    axes.legend()


def constant_factors(axes: Axes, recording: Recording) -> None:
    """Figure 8: stiffness with constant stability factors, and with the enhanced factor."""
    t, true = recording.t, recording.plant["sigma"]
    constant = {
        float(series.parameters["rls.a"]): series["sigma"]
        for series in recording.estimators.values()
        if series.parameters["rls.kind"] == "ConstantFactor"
    }
    small, large = sorted(constant)
    line(axes, t, true, **TRUE)
    for a, color, what in ((small, GREEN, "small"), (large, VERMILION, "large")):
        line(axes, t, constant[a], color=color, label=f"constant, too {what}: $a$ = {a:g}")
    enhanced = recording.estimators["RESIDUAL"]["sigma"]
    line(axes, t, enhanced, color=BLUE, label="enhanced: $a(k)$")
    limit(axes, true)
    axes.set_ylabel(STIFFNESS)
    axes.legend(ncols=2)


def lever_arm(axes: Axes, recording: Recording) -> None:
    """Figure 10: lever arm r, true and by the nominal data."""
    line(axes, recording.t, recording.plant["r"], **TRUE)
    line(axes, recording.t, nominal_awas(recording)["r"], **_NOMINAL)
    axes.set_ylabel("lever arm $r$ [m]")
    axes.legend()


_MOST_WRONG = "where the nominal torque is most wrong"


def _nominal_torque(recording: Recording) -> tuple[Draw, slice]:
    """A function that draws the torque, and the samples where the nominal data are most wrong."""
    plant, nominal = recording.plant, nominal_awas(recording)["tau_e"]
    signals = [
        (plant["tau_e_measured"], {"color": GREEN, "label": "sensor"}),
        (plant["tau_e"], {**TRUE, "linewidth": 1.5}),
        (nominal, _NOMINAL),
    ]
    centre = float(recording.t[np.argmax(np.abs(nominal - plant["tau_e"]))])
    return _signals(recording.t, signals, TORQUE), window(recording.t, centre, 0.5)


def nominal_torque(recording: Recording) -> Figure:
    """Figure 11: flexibility torque, by the nominal data and from the sensor.

    The second panel shows where the nominal data are most wrong.
    """
    figure, panels = _whole_and_part(recording.t, *_nominal_torque(recording), _MOST_WRONG)
    legend_above(panels[0])
    return figure


def nominal_stiffness(recording: Recording) -> Figure:
    """Figure 12: stiffness, true, by the nominal data, and estimated in the three modalities.

    The second panel shows the part with the largest stiffness.
    """
    t, true = recording.t, recording.plant["sigma"]
    shown = window(t, float(t[np.argmax(np.where(t > 1.0, true, 0.0))]), 2.0)
    draw = partial(_nominal_stiffness, recording)
    figure, panels = _whole_and_part(t, draw, shown, "where the stiffness is largest")
    panels[0].legend(ncols=5)
    panels[1].set_ylim(0.95 * true[shown].min(), 1.2 * true[shown].max())
    return figure


def _nominal_stiffness(recording: Recording, axes: Axes, shown: slice) -> None:
    line(axes, recording.t[shown], nominal_awas(recording)["sigma"][shown], **_NOMINAL)
    stiffness_lines(recording, axes, shown)


def experiment(recording: Recording) -> Figure:
    """Figures 9 to 12 below each other, and the relative error of each estimate."""
    figure, panels = time_panels(5)
    deformation(panels[0], recording)
    lever_arm(panels[1], recording)
    draw, part = _nominal_torque(recording)
    draw(panels[2], part)
    panels[2].set_title(_MOST_WRONG, fontsize=9)
    legend_above(panels[2])
    _nominal_stiffness(recording, panels[3], EVERYTHING)
    panels[3].legend(ncols=5)
    error_lines(panels[4], recording)
    return figure


def summary(recording: Recording) -> Figure:
    """Stiffness, true and estimated, and the relative error of each estimate."""
    figure, (above, below) = time_panels(2)
    stiffness_lines(recording, above, EVERYTHING)
    above.legend(ncols=2)
    error_lines(below, recording)
    return figure


FIGURES: dict[str, Callable[[Recording], Figure]] = {
    "fig3-deformation": _one_panel(deformation),
    "fig4-velocity": velocity,
    "fig5-flexibility-torque": flexibility_torque,
    "fig6-stiffness": stiffness,
    "fig7-stability-factor": _one_panel(stability_factor),
    "fig8-constant-factors": _one_panel(constant_factors),
    "fig9-deformation": _one_panel(deformation),
    "fig10-lever-arm": _one_panel(lever_arm),
    "fig11-flexibility-torque": nominal_torque,
    "fig12-stiffness": nominal_stiffness,
    "transmission": curves.transmission,
    "summary": summary,
    "experiment": experiment,
    "antagonistic": curves.antagonistic,
}
"""Functions from the recording of a scenario to a figure, which no window manager holds."""
