"""Figures 3 to 12 of the paper, one picture for each scenario, and the comparison of methods.

Every function but comparison() takes the recording of a scenario that names it. All return a
figure that no window manager knows about.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any, TypeVar

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from sigmahat.fmi.master import Recording
from sigmahat.paper.comparisons import METHODS, Line
from sigmahat.paper.nominal_awas import nominal

Array = NDArray[np.float64]
Source = TypeVar("Source")
"""What a figure is drawn from."""

# Colours of Okabe and Ito, told apart with every kind of colour vision.
_BLUE, _GREEN, _VERMILION, _SKY = "#0072B2", "#009E73", "#D55E00", "#56B4E9"
_MODALITIES: dict[str, dict[str, Any]] = {
    "RESIDUAL": {"color": _BLUE},
    "SENSOR": {"color": _GREEN, "linestyle": (0, (5, 2))},
    "MODEL": {"color": _VERMILION, "linestyle": (0, (1, 1.5))},
    "RESIDUAL-paper-prior": {"color": _VERMILION, "linestyle": (0, (5, 2))},
}
# Wide and light, so that an estimate on top of the truth still shows it.
_TRUE: dict[str, Any] = {"color": "#aaaaaa", "linewidth": 3.0, "label": "true"}

_NOMINAL: dict[str, Any] = {"color": "black", "linewidth": 0.8, "label": "nominal"}

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

_ERROR_WINDOW = 0.1
"""[s]"""

_STIFFNESS = r"stiffness $\sigma$ [N$\cdot$m/rad]"
_TORQUE = r"flexibility torque $\tau_e$ [N$\cdot$m]"
_VELOCITY = r"motor velocity $\dot\theta$ [rad/s]"


def deformation(recording: Recording) -> Figure:
    """Figures 3 and 9: deformation phi."""
    figure, (axes,) = _figure(1)
    _deformation(axes, recording)
    _legend_above(axes)
    return figure


def _deformation(axes: Axes, recording: Recording) -> None:
    _line(axes, recording.t, recording.plant["phi"], color=_BLUE, label=r"deformation $\phi$")
    axes.set_ylabel(r"deformation $\phi$ [rad]")


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


def lever_arm(recording: Recording) -> Figure:
    """Figure 10: lever arm r, true and by the nominal data."""
    figure, (axes,) = _figure(1)
    _lever_arm(axes, recording)
    return figure


def _lever_arm(axes: Axes, recording: Recording) -> None:
    _line(axes, recording.t, recording.plant["r"], **_TRUE)
    _line(axes, recording.t, nominal(recording)["r"], **_NOMINAL)
    axes.set_ylabel("lever arm $r$ [m]")
    axes.legend()


def nominal_torque(recording: Recording) -> Figure:
    """Figure 11: flexibility torque, by the nominal data and from the sensor.

    The second panel shows where the nominal data are most wrong.
    """
    figure, panels = _figure(2)
    _nominal_torque(panels[0], recording, _everything(recording.t))
    _legend_above(panels[0])
    _nominal_torque_zoom(panels[1], recording)
    return figure


def _nominal_torque(axes: Axes, recording: Recording, window: slice) -> None:
    for values, style in (
        (recording.plant["tau_e_measured"], {"color": _GREEN, "label": "sensor"}),
        (recording.plant["tau_e"], {**_TRUE, "linewidth": 1.5}),
        (nominal(recording)["tau_e"], _NOMINAL),
    ):
        _line(axes, recording.t[window], values[window], **style)
    axes.set_ylabel(_TORQUE)


def _nominal_torque_zoom(axes: Axes, recording: Recording) -> None:
    error = np.abs(nominal(recording)["tau_e"] - recording.plant["tau_e"])
    centre = float(recording.t[np.argmax(error)])
    _nominal_torque(axes, recording, _window(recording.t, centre, 0.5))
    axes.set_title("where the nominal torque is most wrong", fontsize=9)


def experiment_stiffness(recording: Recording) -> Figure:
    """Figure 12: stiffness, true, by the nominal data, and estimated in the three modalities.

    The second panel shows where it is largest.
    """
    t, true = recording.t, recording.plant["sigma"]
    figure, panels = _figure(2)
    _experiment_stiffness(panels[0], recording, _everything(t))
    panels[0].legend(ncols=5)
    window = _window(t, float(t[np.argmax(np.where(t > 1.0, true, 0.0))]), 2.0)
    _experiment_stiffness(panels[1], recording, window)
    panels[1].set_ylim(0.95 * true[window].min(), 1.2 * true[window].max())
    panels[1].set_title("where it is largest", fontsize=9)
    return figure


def _experiment_stiffness(axes: Axes, recording: Recording, window: slice) -> None:
    _line(axes, recording.t[window], nominal(recording)["sigma"][window], **_NOMINAL)
    _stiffness_lines(axes, recording, window)


def experiment(recording: Recording) -> Figure:
    """Figures 9 to 12 below each other, and the relative error of each estimate."""
    figure, panels = _figure(5)
    _deformation(panels[0], recording)
    _legend_above(panels[0])
    _lever_arm(panels[1], recording)
    _nominal_torque_zoom(panels[2], recording)
    _legend_above(panels[2])
    _experiment_stiffness(panels[3], recording, _everything(recording.t))
    panels[3].legend(ncols=5)
    _modality_errors(panels[4], recording)
    return figure


def antagonistic(recording: Recording) -> Figure:
    """Torques of both transmissions, stiffness of the device and of its sides, relative errors."""
    t, plant, estimate = recording.t, recording.plant, recording.estimators["RESIDUAL"]
    figure, (torques, stiffnesses, errors) = _figure(3)
    for i, color in ((1, _GREEN), (2, _VERMILION)):
        _line(torques, t, plant[f"tau_e_{i}"], color=color, label=f"side {i}")
    total = plant["tau_e_1"] + plant["tau_e_2"]
    _line(torques, t, total, color="black", linewidth=0.8, label="sum, which moves the link")
    torques.set_ylabel(_TORQUE)
    _legend_above(torques)

    for name, signal, color in (
        ("device", "sigma", _BLUE),
        ("side 1", "sigma_1", _GREEN),
        ("side 2", "sigma_2", _VERMILION),
    ):
        _line(stiffnesses, t, plant[signal], **_TRUE)
        _line(stiffnesses, t, estimate[signal], color=color, label=f"RESIDUAL, {name}")
        _error_line(errors, t, plant[signal], estimate[signal], color=color, label=name)
    _limit(stiffnesses, plant["sigma"])
    stiffnesses.set_ylabel(_STIFFNESS)
    lines = {str(each.get_label()): each for each in stiffnesses.get_lines()}
    stiffnesses.legend(handles=lines.values(), ncols=4)
    _error_axes(errors)
    return figure


def summary(recording: Recording) -> Figure:
    """Stiffness, true and estimated, and the relative error of each estimate."""
    figure, (above, below) = _figure(2)
    _stiffness_lines(above, recording, _everything(recording.t))
    above.legend(ncols=2)
    _modality_errors(below, recording)
    return figure


FIGURES: dict[str, Callable[[Recording], Figure]] = {
    "fig3-deformation": deformation,
    "fig4-velocity": velocity,
    "fig5-flexibility-torque": flexibility_torque,
    "fig6-stiffness": stiffness,
    "fig7-stability-factor": stability_factor,
    "fig8-constant-factors": constant_factors,
    "fig9-deformation": deformation,
    "fig10-lever-arm": lever_arm,
    "fig11-flexibility-torque": nominal_torque,
    "fig12-stiffness": experiment_stiffness,
    "summary": summary,
    "experiment": experiment,
    "antagonistic": antagonistic,
}
"""Every figure by the name of its files."""


def comparison(lines: Sequence[Line]) -> Figure:
    """MSREP of both methods over the frequency of the motion, for the AwAS with wrong motor data.

    Right: with Coulomb friction, too.
    """
    curves: dict[tuple[str, str], list[Line]] = {}
    for line in lines:
        if line.group.startswith("r(0)"):
            curves.setdefault((line.group, line.case), []).append(line)
    figure = Figure(figsize=(9.0, 5.0), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True).tolist()
    for method, color in zip(METHODS, (_VERMILION, _BLUE), strict=True):
        for ((group, case), points), marker in zip(curves.items(), "ovsD^", strict=False):
            friction = "Coulomb" in group
            panels[friction].plot(
                [float(point.joint.removesuffix(" Hz")) for point in points],
                [point.found[method].msrep for point in points],
                color=color,
                marker=marker,
                markersize=4,
                linestyle="--" if marker in "v^" else "-",
                label=f"{method}: {'Coulomb friction, ' if friction else f'{group}, '}{case}",
            )
    panels[0].set_title("all 15 s", fontsize=9)
    panels[1].set_title(r"Coulomb friction 0.02 N$\cdot$m, r(0) = 70 mm, after 1 s", fontsize=9)
    for axes in panels:
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("frequency of the motor torque [Hz]")
    panels[0].set_ylabel("MSREP [%]")
    drawn = [each for axes in panels for each in axes.get_lines()]
    handles = sorted(drawn, key=lambda each: METHODS.index(each.get_label().split(":")[0]))
    figure.legend(handles=handles, loc="outside lower center", ncols=2, fontsize=8)
    return figure


def save(draw: Callable[[Source], Figure], source: Source, path: Path) -> None:
    """Draws a figure into <path>.png and <path>.svg. The same source gives the same SVG."""
    with matplotlib.rc_context(_STYLE):
        figure = draw(source)
        figure.savefig(path.with_suffix(".svg"), metadata={"Date": None})
        pixels = BytesIO()
        figure.savefig(pixels, format="png")
    with Image.open(pixels) as image:  # 64 colours look the same in a third of the bytes
        image.convert("RGB").quantize(64).save(path.with_suffix(".png"), optimize=True)


def _figure(panels: int) -> tuple[Figure, list[Axes]]:
    """Panels one below the other, time on the horizontal axis."""
    figure = Figure(figsize=(7.2, 1.2 + 2.5 * panels), layout="constrained")
    axes = figure.subplots(panels, squeeze=False)[:, 0].tolist()
    for each in axes:
        each.set_xlabel("time $t$ [s]")
    return figure, axes


def _modalities(recording: Recording) -> Iterator[tuple[str, dict[str, Any]]]:
    """Estimators of the recording that have a style, and their style with a label."""
    for name, style in _MODALITIES.items():
        if name in recording.estimators:
            yield name, {**style, "label": name}


def _stiffness_lines(axes: Axes, recording: Recording, window: slice) -> None:
    t, true = recording.t[window], recording.plant["sigma"][window]
    _line(axes, t, true, **_TRUE)
    for name, style in _modalities(recording):
        _line(axes, t, recording.estimators[name]["sigma"][window], **style)
    _limit(axes, true)
    axes.set_ylabel(_STIFFNESS)


def _modality_errors(axes: Axes, recording: Recording) -> None:
    for name, style in _modalities(recording):
        estimate = recording.estimators[name]["sigma"]
        _error_line(axes, recording.t, recording.plant["sigma"], estimate, **style)
    _error_axes(axes)


def _error_line(axes: Axes, t: Array, true: Array, estimate: Array, **style: Any) -> None:
    """Relative error of a stiffness, the largest of each window."""
    window = int(np.searchsorted(t, _ERROR_WINDOW))
    windows = len(t) // window
    error = np.abs(estimate / true - 1)[: windows * window] * 100
    worst = error.reshape(windows, window).max(axis=1)
    _line(axes, t[: windows * window : window], worst, **style)


def _error_axes(axes: Axes) -> None:
    axes.set_yscale("log")
    axes.set_ylabel(f"relative error [%],\nlargest within {_ERROR_WINDOW:g} s")
    axes.legend(ncols=3)


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


def _legend_above(axes: Axes) -> None:
    """Legend above the lines, where they reach all over the panel."""
    bottom, top = axes.get_ylim()
    axes.set_ylim(bottom, top + 0.2 * (top - bottom))
    axes.legend(loc="upper right", ncols=len(axes.get_lines()))


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
