"""Figures 3 to 12 of the paper, a summary of the AwAS, and all figures by their names."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sigmahat.fmi.master import Recording
from sigmahat.paper.figures import panels
from sigmahat.paper.figures.panels import EVERYTHING, STIFFNESS, TORQUE, TRUE, Array, line, window
from sigmahat.plotting.style import BLUE, GREEN, SKY, VERMILION, math_axis
from sigmahat.runs.scenario import nominal_awas

_HELD: dict[str, Any] = {"color": SKY, "drawstyle": "steps-post"}
_NOMINAL: dict[str, Any] = {"color": "black", "linewidth": 0.8, "label": "nominal"}
_LAST = 1 / 3  # fraction of a run that is shown against the deformation: an estimate changes little
_DOTS: dict[str, Any] = {"linestyle": "", "marker": ".", "markersize": 3}
_COUNT = 80  # number of dots, small enough that the truth is visible between the dots

Draw = Callable[[Axes, slice], object]  # draws some of the samples


def _signals(t: Array, signals: Sequence[tuple[Array, Mapping[str, Any]]], label: str) -> Draw:
    def draw(axes: Axes, shown: slice) -> None:
        for values, style in signals:
            line(axes, t[shown], values[shown], **style)
        axes.set_ylabel(label)

    return draw


def _whole_and_part(draw: Draw, part: slice, title: str, columns: int | None = 1) -> Figure:
    """A panel with all samples, and a panel with a part of them, which has the title.

    columns  of the legend; None: the legend is above the lines
    """
    figure, (whole, below) = panels.time_panels(2)
    draw(whole, EVERYTHING)
    draw(below, part)
    below.set_title(title, fontsize=9)
    if columns is None:
        panels.legend_above(whole)
    else:
        whole.legend(ncols=columns)
    return figure


def _one_panel(draw: Callable[[Axes, Recording], object]) -> Callable[[Recording], Figure]:
    """The figure with nothing but this panel."""

    def draw_figure(recording: Recording) -> Figure:
        figure, (axes,) = panels.time_panels(1)
        draw(axes, recording)
        return figure

    return draw_figure


def deformation(axes: Axes, recording: Recording) -> None:
    """Figures 3 and 9: deformation phi."""
    line(axes, recording.t, recording.plant["phi"], color=BLUE, label=r"deformation $\phi$")
    axes.set_ylabel(r"deformation $\phi$ [rad]")
    panels.legend_above(axes)


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
    part = window(t, panels.first_reversal(t, true), 0.05)
    draw = _signals(t, signals, r"motor velocity $\dot\theta$ [rad/s]")
    return _whole_and_part(draw, part, "at a reversal")


def flexibility_torque(recording: Recording) -> Figure:
    """Figure 5: flexibility torque, true, from the residual, from the sensor, and as fitted."""
    t, plant, estimate = recording.t, recording.plant, recording.estimators["RESIDUAL"]
    signals = [
        (estimate["tau_e_residual"], {"color": SKY, "label": r"residual $\gamma r_e$"}),
        (plant["tau_e_measured"], {"color": GREEN, "label": "sensor"}),
        (plant["tau_e"], TRUE),
        (estimate["tau_e"], {"color": VERMILION, "label": r"fitted, $f(\theta_c, \phi)$"}),
    ]
    part = window(t, panels.first_reversal(t, plant["tau_e"]), 0.25)
    draw = _signals(t, signals, TORQUE)
    return _whole_and_part(draw, part, "where the torque changes sign", columns=2)


def stiffness(recording: Recording) -> Figure:
    """Figure 6: stiffness, true and estimated in the three modalities, and its start-up."""
    draw = partial(panels.stiffness_lines, recording)
    return _whole_and_part(draw, window(recording.t, 0.0, 0.3), "start-up", columns=2)


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
    panels.limit(axes, true)
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
    return _whole_and_part(*_nominal_torque(recording), _MOST_WRONG, columns=None)


def nominal_stiffness(recording: Recording) -> Figure:
    """Figure 12: stiffness, true, by the nominal data, and estimated in the three modalities.

    The second panel shows the part with the largest stiffness.
    """
    t, true = recording.t, recording.plant["sigma"]
    shown = window(t, float(t[np.argmax(np.where(t > 1.0, true, 0.0))]), 2.0)
    draw = partial(_nominal_stiffness, recording)
    figure = _whole_and_part(draw, shown, "where the stiffness is largest", columns=5)
    figure.axes[1].set_ylim(0.95 * true[shown].min(), 1.2 * true[shown].max())
    return figure


def _nominal_stiffness(recording: Recording, axes: Axes, shown: slice) -> None:
    line(axes, recording.t[shown], nominal_awas(recording)["sigma"][shown], **_NOMINAL)
    panels.stiffness_lines(recording, axes, shown)


def experiment(recording: Recording) -> Figure:
    """Figures 9 to 12 below each other, and the relative error of each estimate."""
    figure, axes = panels.time_panels(5)
    deformation(axes[0], recording)
    lever_arm(axes[1], recording)
    draw, part = _nominal_torque(recording)
    draw(axes[2], part)
    axes[2].set_title(_MOST_WRONG, fontsize=9)
    panels.legend_above(axes[2])
    _nominal_stiffness(recording, axes[3], EVERYTHING)
    axes[3].legend(ncols=5)
    panels.error_lines(axes[4], recording)
    return figure


def summary(recording: Recording) -> Figure:
    """Stiffness, true and estimated, and the relative error of each estimate."""
    figure, (above, below) = panels.time_panels(2)
    panels.stiffness_lines(recording, above, EVERYTHING)
    above.legend(ncols=2)
    panels.error_lines(below, recording)
    return figure


def transmission(recording: Recording) -> Figure:
    """One flexible transmission: stiffness over time, the curves, and the relative errors."""
    figure = Figure(figsize=(7.2, 8.7), layout="constrained")
    axes = figure.subplot_mosaic([["time", "time"], ["torque", "stiffness"], ["errors", "errors"]])
    panels.stiffness_lines(recording, axes["time"], EVERYTHING, thin=True)
    axes["time"].legend(ncols=3)
    styles = {name: str(style["color"]) for name, style in panels.estimator_styles(recording)}
    for panel, output in (("torque", "tau_e"), ("stiffness", "sigma")):
        over_deformation(axes[panel], recording, output, "", styles)
        axes[panel].set_title(_last_part(recording), fontsize=9)
    axes["stiffness"].legend()
    panels.error_lines(axes["errors"], recording)
    for name in ("time", "errors"):
        axes[name].set_xlabel(math_axis("t"))
    return figure


def antagonistic(recording: Recording) -> Figure:
    """Torques of both transmissions, stiffness of the device, each side apart, relative errors."""
    figure = Figure(figsize=(7.2, 14.0), layout="constrained")
    axes = figure.subplot_mosaic(
        [
            ["torques", "torques"],
            ["sigma", "sigma"],
            ["sigma_1", "sigma_2"],
            ["curve_1", "curve_2"],
            ["stiffness_1", "stiffness_2"],
            ["errors", "errors"],
        ]
    )
    _torques(axes["torques"], recording)
    t, plant, estimate = recording.t, recording.plant, recording.estimators["RESIDUAL"]
    for name, signal, color in (
        ("device", "sigma", BLUE),
        ("side 1", "sigma_1", GREEN),
        ("side 2", "sigma_2", VERMILION),
    ):
        line(axes[signal], t, plant[signal], **TRUE)
        line(axes[signal], t, estimate[signal], color=color, label=f"RESIDUAL, {name}")
        panels.limit(axes[signal], plant[signal])
        axes[signal].set_ylabel(STIFFNESS)
        axes[signal].legend(loc="upper right")
        style = {"color": color, "label": name}
        panels.error_line(axes["errors"], t, plant[signal], estimate[signal], **style)
    for side, color in (("_1", GREEN), ("_2", VERMILION)):
        over_deformation(axes[f"curve{side}"], recording, "tau_e", side, {"RESIDUAL": color})
        over_deformation(axes[f"stiffness{side}"], recording, "sigma", side, {"RESIDUAL": color})
        axes[f"curve{side}"].set_title(f"side {side[1]}, {_last_part(recording)}", fontsize=9)
        axes[f"curve{side}"].legend(loc="upper left")
    panels.error_axes(axes["errors"])
    for name in ("torques", "sigma", "sigma_1", "sigma_2", "errors"):
        axes[name].set_xlabel(math_axis("t"))
    return figure


def _torques(axes: Axes, recording: Recording) -> None:
    t, plant = recording.t, recording.plant
    for i, color in ((1, GREEN), (2, VERMILION)):
        line(axes, t, plant[f"tau_e_{i}"], color=color, label=f"side {i}")
    total = plant["tau_e_1"] + plant["tau_e_2"]
    line(axes, t, total, color="black", linewidth=0.8, label="sum, which moves the link")
    axes.set_ylabel(TORQUE)
    panels.legend_above(axes)


def over_deformation(
    axes: Axes, recording: Recording, output: str, side: str, colors: dict[str, str]
) -> None:
    """An output, tau_e or sigma, against deformation: true, and of estimators by their colour."""
    last = recording.t >= (1 - _LAST) * recording.t[-1]
    phi, true = recording.plant[f"phi{side}"][last], recording.plant[f"{output}{side}"][last]
    order = np.argsort(phi)
    axes.plot(phi[order], true[order], **TRUE)
    for name, color in colors.items():
        estimate = recording.estimators[name]
        x, y = estimate[f"phi{side}"][last], estimate[f"{output}{side}"][last]
        few = np.argsort(x)[:: max(1, len(x) // _COUNT)]
        axes.plot(x[few], y[few], color=color, label=name, **_DOTS)
    axes.set_xlabel(math_axis("phi"))
    axes.set_ylabel(math_axis(output))
    axes.locator_params(axis="x", nbins=5)


def _last_part(recording: Recording) -> str:
    return f"last {_LAST * recording.t[-1]:g} s"


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
    "transmission": transmission,
    "summary": summary,
    "experiment": experiment,
    "antagonistic": antagonistic,
}
"""Functions from the recording of a scenario to a figure, which no window manager holds."""
