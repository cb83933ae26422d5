"""Panels as data: signals over time, an output over the deformation, relative errors."""

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from sigmahat.experiments.scenario import NOMINAL, PLANT, signal_of, source_and_variable
from sigmahat.fmi.master import Recording
from sigmahat.show.style import BLUE, GREEN, VERMILION, math_axis

Array = NDArray[np.float64]
Signal = str | Callable[[Recording], Array]  # a signal of a comparison, or a function that has it
Line = tuple[Signal, dict[str, Any]]  # signal and style
Lines = Callable[[Axes, Recording, slice], object]  # draws some of the samples
Panel = Callable[[Axes, Recording], object]


def line(signal: Signal, label: str, color: str, **style: Any) -> Line:
    return signal, {"label": label, "color": color, **style}


# Wide and light, so that an estimate on top of the truth still shows it.
TRUE: dict[str, Any] = {"color": "#aaaaaa", "linewidth": 3.0, "label": "true"}
THIN: dict[str, Any] = {**TRUE, "color": "#888888", "linewidth": 1.2}
"""For a true stiffness that oscillates so fast that a wide line would fill an area."""
ESTIMATES: tuple[Line, ...] = tuple(
    (f"{name}.sigma", {"color": color, "linestyle": linestyle, "label": name})
    for name, color, linestyle in (
        ("RESIDUAL", BLUE, "-"),
        ("SENSOR", GREEN, (0, (5, 2))),
        ("MODEL", VERMILION, (0, (1, 1.5))),
        ("RESIDUAL-paper-prior", VERMILION, (0, (5, 2))),
    )
)
"""The stiffness of every estimator that has a style."""

_ERROR_WINDOW = 0.1  # [s]
_LAST = 1 / 3  # fraction of a run that is shown against the deformation: an estimate changes little
_COUNT = 80  # number of dots, small enough that the truth is visible between the dots


def lines(label: str, *drawn: Line, within: str = "", scale: str = "linear") -> Lines:
    """Signals over time; estimators that a recording does not have are left out.

    within  signal whose range limits the axis, however far an estimate goes
    """

    def draw(axes: Axes, recording: Recording, shown: slice) -> None:
        for values, style in _recorded(drawn, recording):
            axes.plot(recording.t[shown], values[shown], **style)
        if within:
            true = signal_of(recording, within)[shown]
            top = float(np.max(true))
            axes.set_ylim(min(0.0, float(np.min(true))) - 0.1 * top, 1.4 * top)
        axes.margins(x=0.01)
        axes.set(xlabel=math_axis("t"), ylabel=label, yscale=scale)

    return draw


def stiffness(*before: Line, true: dict[str, Any] = TRUE) -> Lines:
    """True stiffness and the estimate of each modality, on top of other lines."""
    drawn = (*before, ("plant.sigma", true), *ESTIMATES)
    return lines(math_axis("sigma"), *drawn, within="plant.sigma")


def errors(*drawn: Line) -> Panel:
    """Relative error of each stiffness, the largest error of each window."""

    def draw(axes: Axes, recording: Recording) -> None:
        window = int(np.searchsorted(recording.t, _ERROR_WINDOW))
        windows = len(recording.t) // window
        for error, style in _recorded(drawn, recording, _relative_error):
            worst = error[: windows * window].reshape(windows, window).max(axis=1)
            axes.plot(recording.t[: windows * window : window], worst, **style)
        axes.margins(x=0.01)
        label = f"relative error [%],\nlargest within {_ERROR_WINDOW:g} s"
        axes.set(xlabel=math_axis("t"), ylabel=label, yscale="log")
        axes.legend(ncols=3)

    return draw


def _relative_error(recording: Recording, signal: str) -> Array:
    true = recording.plant[source_and_variable(signal)[1]]
    error: Array = np.abs(signal_of(recording, signal) / true - 1) * 100
    return error


def _recorded(
    drawn: Iterable[Line],
    recording: Recording,
    read: Callable[[Recording, str], Array] = signal_of,
) -> Iterator[tuple[Array, dict[str, Any]]]:
    for signal, style in drawn:
        if not isinstance(signal, str):
            yield signal(recording), style
        elif source_and_variable(signal)[0] in (PLANT, NOMINAL, *recording.estimators):
            yield read(recording, signal), style


def panel(
    drawn: Lines,
    part: Callable[[Recording], slice] = lambda recording: slice(None),
    title: str = "",
    legend: Callable[[Axes], object] = lambda axes: None,
) -> Panel:
    """Lines over the whole run, or over a part of it."""

    def draw(axes: Axes, recording: Recording) -> None:
        drawn(axes, recording, part(recording))
        if title:
            axes.set_title(title, fontsize=9)
        legend(axes)

    return draw


def legend_above(axes: Axes) -> None:
    """Legend above the lines, for lines that fill the panel."""
    bottom, top = axes.get_ylim()
    axes.set_ylim(bottom, top + 0.2 * (top - bottom))
    axes.legend(loc="upper right", ncols=len(axes.get_lines()))


def window(t: Array, centre: float, half_width: float) -> slice:
    """Samples within half_width [s] of centre [s]."""
    first, last = np.searchsorted(t, (centre - half_width, centre + half_width))
    return slice(int(first), int(last) + 1)


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
        axes.plot(x[few], y[few], linestyle="", marker=".", markersize=3, color=color, label=name)
    axes.set(xlabel=math_axis("phi"), ylabel=math_axis(output))
    axes.locator_params(axis="x", nbins=5)


def last_part(recording: Recording) -> str:
    return f"last {_LAST * recording.t[-1]:g} s"
