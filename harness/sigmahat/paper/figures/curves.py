"""Torque and stiffness of a transmission against the deformation, as an estimator finds them.

The spring of these scenarios does not change, so that both are curves. The curves show the last
part of a run, in which an estimate changes little.
"""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sigmahat.fmi.master import Recording
from sigmahat.paper.figures.panels import (
    EVERYTHING,
    STIFFNESS,
    TORQUE,
    TRUE,
    error_axes,
    error_line,
    error_lines,
    estimator_styles,
    legend_above,
    limit,
    line,
    stiffness_lines,
)
from sigmahat.plotting.style import BLUE, GREEN, VERMILION, math_axis

_LAST = 1 / 3  # fraction of the run
_DOTS: dict[str, Any] = {"linestyle": "", "marker": ".", "markersize": 3}
_COUNT = 80  # number of dots, small enough that the truth is visible between the dots
_TIME, _PHI = math_axis("t"), math_axis("phi")


def transmission(recording: Recording) -> Figure:
    """One flexible transmission: stiffness over time, the curves, and the relative errors."""
    figure = Figure(figsize=(7.2, 8.7), layout="constrained")
    axes = figure.subplot_mosaic([["time", "time"], ["torque", "stiffness"], ["errors", "errors"]])
    stiffness_lines(recording, axes["time"], EVERYTHING, thin=True)
    axes["time"].legend(ncols=3)
    styles = {name: str(style["color"]) for name, style in estimator_styles(recording)}
    for panel, output in (("torque", "tau_e"), ("stiffness", "sigma")):
        over_deformation(axes[panel], recording, output, "", styles)
        axes[panel].set_title(_last_part(recording), fontsize=9)
    axes["stiffness"].legend()
    error_lines(axes["errors"], recording)
    for name in ("time", "errors"):
        axes[name].set_xlabel(_TIME)
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
        limit(axes[signal], plant[signal])
        axes[signal].set_ylabel(STIFFNESS)
        axes[signal].legend(loc="upper right")
        error_line(axes["errors"], t, plant[signal], estimate[signal], color=color, label=name)
    for side, color in (("_1", GREEN), ("_2", VERMILION)):
        over_deformation(axes[f"curve{side}"], recording, "tau_e", side, {"RESIDUAL": color})
        over_deformation(axes[f"stiffness{side}"], recording, "sigma", side, {"RESIDUAL": color})
        axes[f"curve{side}"].set_title(f"side {side[1]}, {_last_part(recording)}", fontsize=9)
        axes[f"curve{side}"].legend(loc="upper left")
    error_axes(axes["errors"])
    for name in ("torques", "sigma", "sigma_1", "sigma_2", "errors"):
        axes[name].set_xlabel(_TIME)
    return figure


def _torques(axes: Axes, recording: Recording) -> None:
    t, plant = recording.t, recording.plant
    for i, color in ((1, GREEN), (2, VERMILION)):
        line(axes, t, plant[f"tau_e_{i}"], color=color, label=f"side {i}")
    total = plant["tau_e_1"] + plant["tau_e_2"]
    line(axes, t, total, color="black", linewidth=0.8, label="sum, which moves the link")
    axes.set_ylabel(TORQUE)
    legend_above(axes)


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
    axes.set_xlabel(_PHI)
    axes.set_ylabel(math_axis(output))
    axes.locator_params(axis="x", nbins=5)


def _last_part(recording: Recording) -> str:
    return f"last {_LAST * recording.t[-1]:g} s"
