"""Panels over time, and drawing functions that several panels need."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from sigmahat.fmi.master import Recording
from sigmahat.plotting.style import BLUE, GREEN, VERMILION, math_axis

Array = NDArray[np.float64]

# Wide and light, so that an estimate on top of the truth still shows it.
TRUE: dict[str, Any] = {"color": "#aaaaaa", "linewidth": 3.0, "label": "true"}
EVERYTHING = slice(None)
STIFFNESS = math_axis("sigma")
TORQUE = math_axis("tau_e")

_THIN: dict[str, Any] = {"color": "#888888", "linewidth": 1.2}

_ESTIMATORS: dict[str, dict[str, Any]] = {
    "RESIDUAL": {"color": BLUE},
    "SENSOR": {"color": GREEN, "linestyle": (0, (5, 2))},
    "MODEL": {"color": VERMILION, "linestyle": (0, (1, 1.5))},
    "RESIDUAL-paper-prior": {"color": VERMILION, "linestyle": (0, (5, 2))},
}
_ERROR_WINDOW = 0.1  # [s]


def line(axes: Axes, t: Array, values: Array, **style: Any) -> None:
    """A signal over time."""
    axes.plot(t, values, **style)
    axes.margins(x=0.01)


def stiffness_lines(axes: Axes, recording: Recording, window: slice, thin: bool = False) -> None:
    """True stiffness, and the estimate of each modality.

    thin  for a true stiffness that oscillates so fast that a wide line would fill an area
    """
    t, true = recording.t[window], recording.plant["sigma"][window]
    line(axes, t, true, **({**TRUE, **_THIN} if thin else TRUE))
    for name, style in estimator_styles(recording):
        line(axes, t, recording.estimators[name]["sigma"][window], **style)
    limit(axes, true)
    axes.set_ylabel(STIFFNESS)


def error_lines(axes: Axes, recording: Recording) -> None:
    """Relative error of the stiffness of each modality."""
    for name, style in estimator_styles(recording):
        estimate = recording.estimators[name]["sigma"]
        error_line(axes, recording.t, recording.plant["sigma"], estimate, **style)
    error_axes(axes)


def estimator_styles(recording: Recording) -> Iterator[tuple[str, dict[str, Any]]]:
    """Estimators of the recording that have a style, and their style with a label."""
    for name, style in _ESTIMATORS.items():
        if name in recording.estimators:
            yield name, {**style, "label": name}


def error_line(axes: Axes, t: Array, true: Array, estimate: Array, **style: Any) -> None:
    """Relative error of a stiffness, the largest error of each window."""
    window = int(np.searchsorted(t, _ERROR_WINDOW))
    windows = len(t) // window
    error = np.abs(estimate / true - 1)[: windows * window] * 100
    worst = error.reshape(windows, window).max(axis=1)
    line(axes, t[: windows * window : window], worst, **style)


def error_axes(axes: Axes) -> None:
    """Scale, label and legend of a panel with error lines."""
    axes.set_yscale("log")
    axes.set_ylabel(f"relative error [%],\nlargest within {_ERROR_WINDOW:g} s")
    axes.legend(ncols=3)


def limit(axes: Axes, true: Array) -> None:
    """Limits the axis to the range of the true values, however far an estimate goes."""
    top = float(np.max(true))
    axes.set_ylim(min(0.0, float(np.min(true))) - 0.1 * top, 1.4 * top)


def legend_above(axes: Axes) -> None:
    """Legend above the lines, for lines that fill the panel."""
    bottom, top = axes.get_ylim()
    axes.set_ylim(bottom, top + 0.2 * (top - bottom))
    axes.legend(loc="upper right", ncols=len(axes.get_lines()))


def window(t: Array, centre: float, half_width: float) -> slice:
    """Samples within half_width [s] of centre [s]."""
    first, last = np.searchsorted(t, (centre - half_width, centre + half_width))
    return slice(int(first), int(last) + 1)
