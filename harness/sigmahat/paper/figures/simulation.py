"""Figures 3 to 8: section VI.B, the AwAS in simulation."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sigmahat.fmi.master import Recording
from sigmahat.paper.figures.panels import (
    STIFFNESS,
    TORQUE,
    TRUE,
    everything,
    first_reversal,
    legend_above,
    limit,
    line,
    stiffness_lines,
    time_panels,
    window,
)
from sigmahat.plotting.style import BLUE, GREEN, SKY, VERMILION

_HELD: dict[str, Any] = {"color": SKY, "drawstyle": "steps-post"}
_VELOCITY = r"motor velocity $\dot\theta$ [rad/s]"


def deformation(recording: Recording) -> Figure:
    """Figures 3 and 9: deformation phi."""
    figure, (axes,) = time_panels(1)
    deformation_panel(axes, recording)
    legend_above(axes)
    return figure


def deformation_panel(axes: Axes, recording: Recording) -> None:
    """Deformation phi."""
    line(axes, recording.t, recording.plant["phi"], color=BLUE, label=r"deformation $\phi$")
    axes.set_ylabel(r"deformation $\phi$ [rad]")


def velocity(recording: Recording) -> Figure:
    """Figure 4: motor velocity, true, differenced, and from the modified Kalman filter.

    The second panel shows a reversal of the motor, where the quantisation is largest compared with
    the velocity.
    """
    t, true = recording.t, recording.plant["theta_dot"]
    differenced = np.diff(recording.plant["theta_measured"], prepend=0.0) / (t[1] - t[0])
    differenced[0] = 0.0
    filtered = recording.estimators["RESIDUAL"]["theta_dot"]
    figure, panels = time_panels(2)
    reversal = first_reversal(t, true)
    for axes, shown in zip(panels, (everything(t), window(t, reversal, 0.05)), strict=True):
        for values, style in (
            (true, TRUE),
            (differenced, {"label": r"differenced, $\Delta\theta/T$", **_HELD}),
            (filtered, {"color": VERMILION, "label": "modified kinematic Kalman filter"}),
        ):
            line(axes, t[shown], values[shown], **style)
        axes.set_ylabel(_VELOCITY)
    panels[0].legend()
    panels[1].set_title("at a reversal", fontsize=9)
    return figure


def flexibility_torque(recording: Recording) -> Figure:
    """Figure 5: flexibility torque, true, from the residual, from the sensor, and as fitted."""
    t, estimate = recording.t, recording.estimators["RESIDUAL"]
    figure, panels = time_panels(2)
    reversal = first_reversal(t, recording.plant["tau_e"])
    for axes, shown in zip(panels, (everything(t), window(t, reversal, 0.25)), strict=True):
        for values, style in (
            (estimate["tau_e_residual"], {"color": SKY, "label": r"residual $\gamma r_e$"}),
            (recording.plant["tau_e_measured"], {"color": GREEN, "label": "sensor"}),
            (recording.plant["tau_e"], TRUE),
            (estimate["tau_e"], {"color": VERMILION, "label": r"fitted, $f(\theta_c, \phi)$"}),
        ):
            line(axes, t[shown], values[shown], **style)
        axes.set_ylabel(TORQUE)
    panels[0].legend(ncols=2)
    panels[1].set_title("where the torque changes sign", fontsize=9)
    return figure


def stiffness(recording: Recording) -> Figure:
    """Figure 6: stiffness, true and estimated in the three modalities, and its start-up."""
    t = recording.t
    figure, panels = time_panels(2)
    for axes, shown in zip(panels, (everything(t), window(t, 0.0, 0.3)), strict=True):
        stiffness_lines(axes, recording, shown)
    panels[0].legend(ncols=2)
    panels[1].set_title("start-up", fontsize=9)
    return figure


def stability_factor(recording: Recording) -> Figure:
    """Figure 7: stability factor a(k) of the RESIDUAL estimate."""
    figure, (axes,) = time_panels(1)
    a = recording.estimators["RESIDUAL"]["a"]
    line(axes, recording.t, a, color=BLUE, label="RESIDUAL")
    axes.set_yscale("log")
    axes.set_ylabel("stability factor $a(k)$ [1]")
    axes.legend()
    return figure


def constant_factors(recording: Recording) -> Figure:
    """Figure 8: stiffness with constant stability factors, and with the enhanced factor."""
    figure, (axes,) = time_panels(1)
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
    return figure
