"""Figures 3 to 12 of the paper, a summary of the AwAS, and all figures by their names."""

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sigmahat.fmi.master import Recording
from sigmahat.paper.figures import panels
from sigmahat.paper.figures.panels import EVERYTHING, STIFFNESS, TORQUE, TRUE, line, window
from sigmahat.plotting.style import BLUE, GREEN, SKY, VERMILION, math_axis
from sigmahat.runs.scenario import nominal_awas

_HELD: dict[str, Any] = {"color": SKY, "drawstyle": "steps-post"}
_NOMINAL: dict[str, Any] = {"color": "black", "linewidth": 0.8, "label": "nominal"}
_LAST = 1 / 3  # fraction of a run that is shown against the deformation: an estimate changes little
_DOTS: dict[str, Any] = {"linestyle": "", "marker": ".", "markersize": 3}
_COUNT = 80  # number of dots, small enough that the truth is visible between the dots

Panel = Callable[[Axes, Recording], object]
Lines = Callable[[Axes, Recording, slice], object]  # draws some of the samples


def _stacked(*every: Panel) -> Callable[[Recording], Figure]:
    """The figure with these panels, one below the other, over time."""

    def draw(recording: Recording) -> Figure:
        figure = Figure(figsize=(7.2, 1.2 + 2.5 * len(every)), layout="constrained")
        own = figure.subplots(len(every), squeeze=False)[:, 0]
        for axes, panel in zip(own, every, strict=True):
            axes.set_xlabel(math_axis("t"))
            panel(axes, recording)
        return figure

    return draw


def _whole(lines: Lines, columns: int = 1) -> Panel:
    """A panel with all samples, and a legend of so many columns."""

    def panel(axes: Axes, recording: Recording) -> None:
        lines(axes, recording, EVERYTHING)
        axes.legend(ncols=columns)

    return panel


def _part(lines: Lines, title: str, part: Callable[[Recording], slice]) -> Panel:
    """A panel with a part of the samples, which has the title."""

    def panel(axes: Axes, recording: Recording) -> None:
        lines(axes, recording, part(recording))
        axes.set_title(title, fontsize=9)

    return panel


def _reversal(signal: str, half_width: float) -> Callable[[Recording], slice]:
    """Samples around the first change of the sign of a signal of the plant after 1 s."""

    def part(recording: Recording) -> slice:
        t, later = recording.t, recording.t > 1.0
        changes = np.flatnonzero(np.diff(np.sign(recording.plant[signal][later])))
        # Without a change, the middle.
        centre = t[later][changes[0]] if len(changes) else t[len(t) // 2]
        return window(t, float(centre), half_width)

    return part


def deformation(axes: Axes, recording: Recording) -> None:
    """Figures 3 and 9: deformation phi."""
    line(axes, recording.t, recording.plant["phi"], color=BLUE, label=r"deformation $\phi$")
    axes.set_ylabel(r"deformation $\phi$ [rad]")
    panels.legend_above(axes)


def velocity(axes: Axes, recording: Recording, shown: slice) -> None:
    """Figure 4: motor velocity, true, differenced, and from the modified Kalman filter."""
    t, plant = recording.t, recording.plant
    differenced = np.diff(plant["theta_measured"], prepend=0.0) / (t[1] - t[0])
    differenced[0] = 0.0
    filtered = recording.estimators["RESIDUAL"]["theta_dot"]
    for values, style in (
        (plant["theta_dot"], TRUE),
        (differenced, {"label": r"differenced, $\Delta\theta/T$", **_HELD}),
        (filtered, {"color": VERMILION, "label": "modified kinematic Kalman filter"}),
    ):
        line(axes, t[shown], values[shown], **style)
    axes.set_ylabel(r"motor velocity $\dot\theta$ [rad/s]")


def flexibility_torque(axes: Axes, recording: Recording, shown: slice) -> None:
    """Figure 5: flexibility torque, true, from the residual, from the sensor, and as fitted."""
    plant, estimate = recording.plant, recording.estimators["RESIDUAL"]
    for values, style in (
        (estimate["tau_e_residual"], {"color": SKY, "label": r"residual $\gamma r_e$"}),
        (plant["tau_e_measured"], {"color": GREEN, "label": "sensor"}),
        (plant["tau_e"], TRUE),
        (estimate["tau_e"], {"color": VERMILION, "label": r"fitted, $f(\theta_c, \phi)$"}),
    ):
        line(axes, recording.t[shown], values[shown], **style)
    axes.set_ylabel(TORQUE)


def stability_factor(axes: Axes, recording: Recording) -> None:
    """Figure 7: stability factor a(k) of the RESIDUAL estimate."""
    line(axes, recording.t, recording.estimators["RESIDUAL"]["a"], color=BLUE, label="RESIDUAL")
    axes.set(yscale="log", ylabel="stability factor $a(k)$ [1]")
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


def nominal_torque(axes: Axes, recording: Recording, shown: slice = EVERYTHING) -> None:
    """Figure 11: flexibility torque, by the nominal data and from the sensor."""
    for values, style in (
        (recording.plant["tau_e_measured"], {"color": GREEN, "label": "sensor"}),
        (recording.plant["tau_e"], {**TRUE, "linewidth": 1.5}),
        (nominal_awas(recording)["tau_e"], _NOMINAL),
    ):
        line(axes, recording.t[shown], values[shown], **style)
    axes.set_ylabel(TORQUE)


def _most_wrong(recording: Recording) -> slice:
    """Samples where the nominal torque is most wrong."""
    error = np.abs(nominal_awas(recording)["tau_e"] - recording.plant["tau_e"])
    return window(recording.t, float(recording.t[np.argmax(error)]), 0.5)


_MOST_WRONG = _part(nominal_torque, "where the nominal torque is most wrong", _most_wrong)


def _legend_above(panel: Panel) -> Panel:
    def with_legend(axes: Axes, recording: Recording) -> None:
        panel(axes, recording)
        panels.legend_above(axes)

    return with_legend


def nominal_stiffness(axes: Axes, recording: Recording, shown: slice) -> None:
    """Figure 12: stiffness, true, by the nominal data, and estimated in the three modalities."""
    line(axes, recording.t[shown], nominal_awas(recording)["sigma"][shown], **_NOMINAL)
    panels.stiffness_lines(axes, recording, shown)


def _largest_stiffness(axes: Axes, recording: Recording) -> None:
    """The part of figure 12 with the largest stiffness."""
    t, true = recording.t, recording.plant["sigma"]
    shown = window(t, float(t[np.argmax(np.where(t > 1.0, true, 0.0))]), 2.0)
    nominal_stiffness(axes, recording, shown)
    axes.set_title("where the stiffness is largest", fontsize=9)
    axes.set_ylim(0.95 * true[shown].min(), 1.2 * true[shown].max())


def transmission(recording: Recording) -> Figure:
    """One flexible transmission: stiffness over time, the curves, and the relative errors."""
    figure = Figure(figsize=(7.2, 8.7), layout="constrained")
    axes = figure.subplot_mosaic([["time", "time"], ["torque", "stiffness"], ["errors", "errors"]])
    panels.stiffness_lines(axes["time"], recording, EVERYTHING, thin=True)
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
    axes.set(xlabel=math_axis("phi"), ylabel=math_axis(output))
    axes.locator_params(axis="x", nbins=5)


def _last_part(recording: Recording) -> str:
    return f"last {_LAST * recording.t[-1]:g} s"


FIGURES: dict[str, Callable[[Recording], Figure]] = {
    "fig3-deformation": _stacked(deformation),
    "fig4-velocity": _stacked(
        _whole(velocity),
        # Where the quantisation is largest compared with the velocity.
        _part(velocity, "at a reversal", _reversal("theta_dot", 0.05)),
    ),
    "fig5-flexibility-torque": _stacked(
        _whole(flexibility_torque, 2),
        _part(flexibility_torque, "where the torque changes sign", _reversal("tau_e", 0.25)),
    ),
    "fig6-stiffness": _stacked(
        _whole(panels.stiffness_lines, 2),
        _part(panels.stiffness_lines, "start-up", lambda each: window(each.t, 0.0, 0.3)),
    ),
    "fig7-stability-factor": _stacked(stability_factor),
    "fig8-constant-factors": _stacked(constant_factors),
    "fig9-deformation": _stacked(deformation),
    "fig10-lever-arm": _stacked(lever_arm),
    "fig11-flexibility-torque": _stacked(_legend_above(nominal_torque), _MOST_WRONG),
    "fig12-stiffness": _stacked(_whole(nominal_stiffness, 5), _largest_stiffness),
    "transmission": transmission,
    "summary": _stacked(_whole(panels.stiffness_lines, 2), panels.error_lines),
    "experiment": _stacked(
        deformation,
        lever_arm,
        _legend_above(_MOST_WRONG),
        _whole(nominal_stiffness, 5),
        panels.error_lines,
    ),
    "antagonistic": antagonistic,
}
"""Functions from the recording of a scenario to a figure, which no window manager holds."""
