"""Figures 3 to 8 of the paper and a summary, drawn from a recording.

Every function takes the recording of a scenario with the estimators MODEL, SENSOR and RESIDUAL
and returns a figure that no window manager knows about.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from sigmahat.cosimulation import Recording

Array = NDArray[np.float64]

# Colours of Okabe and Ito, told apart with every kind of colour vision.
_BLUE, _GREEN, _VERMILION, _SKY = "#0072B2", "#009E73", "#D55E00", "#56B4E9"
_MODALITIES: dict[str, dict[str, Any]] = {
    "RESIDUAL": {"color": _BLUE},
    "SENSOR": {"color": _GREEN, "linestyle": (0, (5, 2))},
    "MODEL": {"color": _VERMILION, "linestyle": (0, (1, 1.5))},
}
# Wide and light, so that an estimate on top of the truth still shows it.
_TRUE: dict[str, Any] = {"color": "#aaaaaa", "linewidth": 3.0, "label": "true"}

_HELD: dict[str, Any] = {"color": _SKY, "drawstyle": "steps-post"}

_STYLE: Any = {
    "font.size": 9,
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "legend.fontsize": 8,
    "lines.linewidth": 1.0,
    "savefig.dpi": 150,
    "svg.hashsalt": "sigmahat",  # the same picture gives the same file
}

_STIFFNESS = r"stiffness $\sigma$ [N$\cdot$m/rad]"
_TORQUE = r"flexibility torque $\tau_e$ [N$\cdot$m]"
_VELOCITY = r"motor velocity $\dot\theta$ [rad/s]"


def deformation(recording: Recording) -> Figure:
    """Figure 3: deformation phi."""
    figure, (axes,) = _figure(1)
    _line(axes, recording.t, recording.plant["phi"], color=_BLUE, label=r"deformation $\phi$")
    axes.set_ylabel(r"deformation $\phi$ [rad]")
    axes.legend()
    return figure


def velocity(recording: Recording) -> Figure:
    """Figure 4: motor velocity, true, differenced, and from the modified Kalman filter.

    The second panel shows a reversal of the motor, where the quantisation is largest beside the
    velocity.
    """
    t, true = recording.t, recording.plant["theta_dot"]
    differenced = np.diff(recording.plant["theta_measured"], prepend=0.0) / (t[1] - t[0])
    differenced[0] = 0.0
    filtered = recording.estimators["RESIDUAL"]["theta_dot"]
    figure, panels = _figure(2)
    reversal = _first_reversal(t, true)
    for axes, window in zip(panels, (_everything(t), _window(t, reversal, 0.05)), strict=True):
        for values, style in (
            (true, _TRUE),
            (differenced, {"label": r"differenced, $\Delta\theta/T$", **_HELD}),
            (filtered, {"color": _VERMILION, "label": "modified kinematic Kalman filter"}),
        ):
            _line(axes, t[window], values[window], **style)
        axes.set_ylabel(_VELOCITY)
    panels[0].legend()
    panels[1].set_title("at a reversal", fontsize=9)
    return figure


def flexibility_torque(recording: Recording) -> Figure:
    """Figure 5: flexibility torque, true, from the residual, from the sensor, and as fitted."""
    t, estimate = recording.t, recording.estimators["RESIDUAL"]
    figure, panels = _figure(2)
    reversal = _first_reversal(t, recording.plant["tau_e"])
    for axes, window in zip(panels, (_everything(t), _window(t, reversal, 0.25)), strict=True):
        for values, style in (
            (estimate["tau_e_residual"], {"color": _SKY, "label": r"residual $\gamma r_e$"}),
            (recording.plant["tau_e_measured"], {"color": _GREEN, "label": "sensor"}),
            (recording.plant["tau_e"], _TRUE),
            (estimate["tau_e"], {"color": _VERMILION, "label": r"fitted, $f(\theta_c, \phi)$"}),
        ):
            _line(axes, t[window], values[window], **style)
        axes.set_ylabel(_TORQUE)
    panels[0].legend(ncols=2)
    panels[1].set_title("where the torque changes sign", fontsize=9)
    return figure


def stiffness(recording: Recording) -> Figure:
    """Figure 6: stiffness, true and estimated in the three modalities, and its start-up."""
    t = recording.t
    figure, panels = _figure(2)
    for axes, window in zip(panels, (_everything(t), _window(t, 0.0, 0.3)), strict=True):
        _stiffness_lines(axes, recording, window)
    panels[0].legend(ncols=2)
    panels[1].set_title("start-up", fontsize=9)
    return figure


def stability_factor(recording: Recording) -> Figure:
    """Figure 7: stability factor a(k) of the RESIDUAL estimate."""
    figure, (axes,) = _figure(1)
    a = recording.estimators["RESIDUAL"]["a"]
    _line(axes, recording.t, a, color=_BLUE, label="RESIDUAL")
    axes.set_yscale("log")
    axes.set_ylabel("stability factor $a(k)$ [1]")
    axes.legend()
    return figure


def constant_factors(recording: Recording) -> Figure:
    """Figure 8: stiffness with constant stability factors against the enhanced one."""
    figure, (axes,) = _figure(1)
    t, true = recording.t, recording.plant["sigma"]
    constant = {
        float(series.parameters["rls.a"]): series["sigma"]
        for series in recording.estimators.values()
        if series.parameters["rls.kind"] == "ConstantFactor"
    }
    small, large = sorted(constant)
    _line(axes, t, true, **_TRUE)
    for a, color, what in ((small, _GREEN, "small"), (large, _VERMILION, "large")):
        _line(axes, t, constant[a], color=color, label=f"constant, too {what}: $a$ = {a:g}")
    enhanced = recording.estimators["RESIDUAL"]["sigma"]
    _line(axes, t, enhanced, color=_BLUE, label="enhanced: $a(k)$")
    _limit(axes, true)
    axes.set_ylabel(_STIFFNESS)
    axes.legend(ncols=2)
    return figure


def summary(recording: Recording) -> Figure:
    """Stiffness, true and estimated, and the relative error of each estimate."""
    t, true = recording.t, recording.plant["sigma"]
    figure, (above, below) = _figure(2)
    _stiffness_lines(above, recording, _everything(t))
    above.legend(ncols=2)
    window = int(np.searchsorted(t, 0.1))
    windows = len(t) // window
    for name, style in _MODALITIES.items():
        error = np.abs(recording.estimators[name]["sigma"] / true - 1)[: windows * window] * 100
        worst = error.reshape(windows, window).max(axis=1)
        _line(below, t[: windows * window : window], worst, label=name, **style)
    below.set_yscale("log")
    below.set_ylabel("relative error [%],\nlargest within 0.1 s")
    below.legend(ncols=3)
    return figure


FIGURES: dict[str, Callable[[Recording], Figure]] = {
    "fig3-deformation": deformation,
    "fig4-velocity": velocity,
    "fig5-flexibility-torque": flexibility_torque,
    "fig6-stiffness": stiffness,
    "fig7-stability-factor": stability_factor,
    "fig8-constant-factors": constant_factors,
    "summary": summary,
}
"""Every figure by the name of its files."""


def save(draw: Callable[[Recording], Figure], recording: Recording, path: Path) -> None:
    """Draws a figure into <path>.png and <path>.svg. The same recording gives the same SVG."""
    with matplotlib.rc_context(_STYLE):
        figure = draw(recording)
        figure.savefig(path.with_suffix(".png"))
        figure.savefig(path.with_suffix(".svg"), metadata={"Date": None})


def _figure(panels: int) -> tuple[Figure, list[Axes]]:
    """Panels one below the other, time on the horizontal axis."""
    figure = Figure(figsize=(7.2, 1.2 + 2.5 * panels), layout="constrained")
    axes = figure.subplots(panels, squeeze=False)[:, 0].tolist()
    for each in axes:
        each.set_xlabel("time $t$ [s]")
    return figure, axes


def _stiffness_lines(axes: Axes, recording: Recording, window: slice) -> None:
    t, true = recording.t[window], recording.plant["sigma"][window]
    _line(axes, t, true, **_TRUE)
    for name, style in _MODALITIES.items():
        _line(axes, t, recording.estimators[name]["sigma"][window], label=name, **style)
    _limit(axes, true)
    axes.set_ylabel(_STIFFNESS)


def _line(axes: Axes, t: Array, values: Array, **style: Any) -> None:
    kept = _envelope(values)
    axes.plot(t[kept], values[kept], **style)
    axes.margins(x=0.01)


def _envelope(values: Array, buckets: int = 1000) -> NDArray[np.intp]:
    """Samples that make the same picture: the least and the greatest of each bucket."""
    count = len(values) // buckets
    if count < 4:
        return np.arange(len(values))
    whole = values[: buckets * count].reshape(buckets, count)
    first = np.arange(buckets) * count
    ends = (0, len(values) - 1)
    return np.unique(np.r_[first + whole.argmin(axis=1), first + whole.argmax(axis=1), ends])


def _limit(axes: Axes, true: Array) -> None:
    """Keeps the scale where the true values are, however far an estimate goes."""
    top = float(np.max(true))
    axes.set_ylim(min(0.0, float(np.min(true))) - 0.1 * top, 1.4 * top)


def _everything(t: Array) -> slice:
    return slice(0, len(t))


def _window(t: Array, centre: float, half_width: float) -> slice:
    """Samples within half_width [s] of centre [s]."""
    first, last = np.searchsorted(t, (centre - half_width, centre + half_width))
    return slice(int(first), int(last) + 1)


def _first_reversal(t: Array, values: Array) -> float:
    """Time at which values first change sign after 1 s [s]; the middle if they do not."""
    later = t > 1.0
    changes = np.flatnonzero(np.diff(np.sign(values[later])))
    return float(t[later][changes[0]] if len(changes) else t[len(t) // 2])
