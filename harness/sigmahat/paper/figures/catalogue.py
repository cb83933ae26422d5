"""Figures 3 to 12 of the paper, a summary of the AwAS, and all figures by their names."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sigmahat.experiments.scenario import signal_of
from sigmahat.fmi.master import Recording
from sigmahat.paper.figures.panels import (
    ESTIMATES,
    THIN,
    TRUE,
    Array,
    Panel,
    errors,
    last_part,
    legend_above,
    line,
    lines,
    over_deformation,
    panel,
    stiffness,
    window,
)
from sigmahat.show.style import BLUE, GREEN, SKY, VERMILION, math_axis

_NOMINAL: dict[str, Any] = {"color": "black", "linewidth": 0.8, "label": "nominal"}


def _stacked(*every: Panel) -> Callable[[Recording], Figure]:
    """The figure with these panels, one below the other, over time."""

    def draw(recording: Recording) -> Figure:
        figure = Figure(figsize=(7.2, 1.2 + 2.5 * len(every)), layout="constrained")
        own = figure.subplots(len(every), squeeze=False)[:, 0]
        for axes, draw_panel in zip(own, every, strict=True):
            draw_panel(axes, recording)
        return figure

    return draw


def _reversal(signal: str, half_width: float, recording: Recording) -> slice:
    """Samples around the first change of the sign of a signal of the plant after 1 s."""
    t, later = recording.t, recording.t > 1.0
    changes = np.flatnonzero(np.diff(np.sign(recording.plant[signal][later])))
    # Without a change, the middle.
    centre = t[later][changes[0]] if len(changes) else t[len(t) // 2]
    return window(t, float(centre), half_width)


def _differenced(recording: Recording) -> Array:
    """Velocity by differences of the measured position [rad/s]."""
    t = recording.t
    velocity: Array = np.diff(recording.plant["theta_measured"], prepend=0.0) / (t[1] - t[0])
    velocity[0] = 0.0
    return velocity


def _most_wrong(recording: Recording) -> slice:
    """Samples where the nominal torque is most wrong."""
    error = np.abs(signal_of(recording, "nominal.tau_e") - recording.plant["tau_e"])
    return window(recording.t, float(recording.t[np.argmax(error)]), 0.5)


_DEFORMATION = panel(
    lines(r"deformation $\phi$ [rad]", line("plant.phi", r"deformation $\phi$", BLUE)),
    legend=legend_above,
)
_VELOCITY = lines(
    r"motor velocity $\dot\theta$ [rad/s]",
    ("plant.theta_dot", TRUE),
    line(_differenced, r"differenced, $\Delta\theta/T$", SKY, drawstyle="steps-post"),
    line("RESIDUAL.theta_dot", "modified kinematic Kalman filter", VERMILION),
)
_FLEXIBILITY_TORQUE = lines(
    math_axis("tau_e"),
    line("RESIDUAL.tau_e_residual", r"residual $\gamma r_e$", SKY),
    line("plant.tau_e_measured", "sensor", GREEN),
    ("plant.tau_e", TRUE),
    line("RESIDUAL.tau_e", r"fitted, $f(\theta_c, \phi)$", VERMILION),
)
_STABILITY_FACTOR = lines(
    "stability factor $a(k)$ [1]", line("RESIDUAL.a", "RESIDUAL", BLUE), scale="log"
)
_CONSTANT_FACTORS = lines(
    math_axis("sigma"),
    ("plant.sigma", TRUE),
    *(
        line(f"RESIDUAL, a = {a}.sigma", f"constant, too {what}: $a$ = {a}", color)
        for a, color, what in (("0.0001", GREEN, "small"), ("0.01", VERMILION, "large"))
    ),
    line("RESIDUAL.sigma", "enhanced: $a(k)$", BLUE),
    within="plant.sigma",
)
_LEVER_ARM = panel(
    lines("lever arm $r$ [m]", ("plant.r", TRUE), ("nominal.r", _NOMINAL)), legend=Axes.legend
)
_NOMINAL_TORQUE = lines(
    math_axis("tau_e"),
    line("plant.tau_e_measured", "sensor", GREEN),
    ("plant.tau_e", {**TRUE, "linewidth": 1.5}),
    ("nominal.tau_e", _NOMINAL),
)
_MOST_WRONG = partial(panel, _NOMINAL_TORQUE, _most_wrong, "where the nominal torque is most wrong")
_NOMINAL_STIFFNESS = stiffness(("nominal.sigma", _NOMINAL))
_TORQUES = lines(
    math_axis("tau_e"),
    line("plant.tau_e_1", "side 1", GREEN),
    line("plant.tau_e_2", "side 2", VERMILION),
    line(
        lambda each: each.plant["tau_e_1"] + each.plant["tau_e_2"],
        "sum, which moves the link",
        "black",
        linewidth=0.8,
    ),
)
_two_columns, _five_columns = (partial(Axes.legend, ncols=count) for count in (2, 5))


def _largest_stiffness(axes: Axes, recording: Recording) -> None:
    """The part of figure 12 with the largest stiffness."""
    t, true = recording.t, recording.plant["sigma"]
    shown = window(t, float(t[np.argmax(np.where(t > 1.0, true, 0.0))]), 2.0)
    _NOMINAL_STIFFNESS(axes, recording, shown)
    axes.set_title("where the stiffness is largest", fontsize=9)
    axes.set_ylim(0.95 * true[shown].min(), 1.2 * true[shown].max())


def transmission(recording: Recording) -> Figure:
    """One flexible transmission: stiffness over time, the curves, and the relative errors."""
    figure = Figure(figsize=(7.2, 8.7), layout="constrained")
    axes = figure.subplot_mosaic([["time", "time"], ["torque", "stiffness"], ["errors", "errors"]])
    of_time = partial(Axes.legend, ncols=3)
    panel(stiffness(true=THIN), legend=of_time)(axes["time"], recording)
    colors = {style["label"]: style["color"] for _, style in ESTIMATES}
    drawn = {name: color for name, color in colors.items() if name in recording.estimators}
    for place, output in (("torque", "tau_e"), ("stiffness", "sigma")):
        over_deformation(axes[place], recording, output, "", drawn)
        axes[place].set_title(last_part(recording), fontsize=9)
    axes["stiffness"].legend()
    errors(*ESTIMATES)(axes["errors"], recording)
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
    panel(_TORQUES, legend=legend_above)(axes["torques"], recording)
    parts = (
        ("sigma", BLUE, "device"),
        ("sigma_1", GREEN, "side 1"),
        ("sigma_2", VERMILION, "side 2"),
    )
    for signal, color, name in parts:
        estimate = line(f"RESIDUAL.{signal}", f"RESIDUAL, {name}", color)
        true = f"plant.{signal}"
        drawn = lines(math_axis("sigma"), (true, TRUE), estimate, within=true)
        panel(drawn, legend=partial(Axes.legend, loc="upper right"))(axes[signal], recording)
    for side, color in (("_1", GREEN), ("_2", VERMILION)):
        over_deformation(axes[f"curve{side}"], recording, "tau_e", side, {"RESIDUAL": color})
        over_deformation(axes[f"stiffness{side}"], recording, "sigma", side, {"RESIDUAL": color})
        axes[f"curve{side}"].set_title(f"side {side[1]}, {last_part(recording)}", fontsize=9)
        axes[f"curve{side}"].legend(loc="upper left")
    of_parts = (line(f"RESIDUAL.{signal}", name, color) for signal, color, name in parts)
    errors(*of_parts)(axes["errors"], recording)
    return figure


FIGURES: dict[str, Callable[[Recording], Figure]] = {
    "fig3-deformation": _stacked(_DEFORMATION),
    "fig4-velocity": _stacked(
        panel(_VELOCITY, legend=Axes.legend),
        # Time interval in which the quantisation is largest compared with the velocity.
        panel(_VELOCITY, partial(_reversal, "theta_dot", 0.05), "at a reversal"),
    ),
    "fig5-flexibility-torque": _stacked(
        panel(_FLEXIBILITY_TORQUE, legend=_two_columns),
        panel(
            _FLEXIBILITY_TORQUE,
            partial(_reversal, "tau_e", 0.25),
            "where the torque changes sign",
        ),
    ),
    "fig6-stiffness": _stacked(
        panel(stiffness(), legend=_two_columns),
        panel(stiffness(), lambda each: window(each.t, 0.0, 0.3), "start-up"),
    ),
    "fig7-stability-factor": _stacked(panel(_STABILITY_FACTOR, legend=Axes.legend)),
    "fig8-constant-factors": _stacked(panel(_CONSTANT_FACTORS, legend=_two_columns)),
    "fig9-deformation": _stacked(_DEFORMATION),
    "fig10-lever-arm": _stacked(_LEVER_ARM),
    "fig11-flexibility-torque": _stacked(
        panel(_NOMINAL_TORQUE, legend=legend_above), _MOST_WRONG()
    ),
    "fig12-stiffness": _stacked(
        panel(_NOMINAL_STIFFNESS, legend=_five_columns), _largest_stiffness
    ),
    "transmission": transmission,
    "summary": _stacked(panel(stiffness(), legend=_two_columns), errors(*ESTIMATES)),
    "experiment": _stacked(
        _DEFORMATION,
        _LEVER_ARM,
        _MOST_WRONG(legend=legend_above),
        panel(_NOMINAL_STIFFNESS, legend=_five_columns),
        errors(*ESTIMATES),
    ),
    "antagonistic": antagonistic,
}
"""Functions from the recording of a scenario to a figure, which no window manager holds."""
