"""The figures of the paper, and a summary of each kind of joint, as panels of a recording.

A figure is a function that makes rows of panels from the recording of a scenario; FIGURES has all
of them by name, and `show.figure` draws the rows.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sigmahat.experiments.scenario import NOMINAL, PLANT, signal_of, source_and_variable
from sigmahat.fmi.master import Recording
from sigmahat.show.panel import TRUE, FigureRows, Panel, Trace, TraceKind
from sigmahat.show.style import BLACK, BLUE, GREEN, SKY, VERMILION, plain_axis

Array = NDArray[np.float64]
_Part = Callable[[Recording], slice]  # the samples of a recording that a panel shows

_DASHED, _DOTTED = (5.0, 2.0), (1.0, 1.5)
_ERROR_WINDOW = 0.1  # time of which the largest error is shown [s]
_LAST = 1 / 3  # fraction of a run that is shown against the deformation: an estimate changes little
_DOTS = 80  # few enough that the truth stays visible between the dots of an estimate


@dataclass(frozen=True)
class _Line:
    """How a signal of a recording is drawn."""

    signal: str | Callable[[Recording], Array]
    """Name of the signal, as in a comparison of a scenario, or a function that computes it."""
    label: str
    color: str
    width: float = 1.0
    dash: tuple[float, ...] = ()

    def is_recorded(self, recording: Recording) -> bool:
        """Whether the recording has the estimator of the signal: variants may be missing."""
        if not isinstance(self.signal, str):
            return True
        source, _ = source_and_variable(self.signal)
        return source in (PLANT, NOMINAL, *recording.estimators)

    def curve(self, recording: Recording, part: slice) -> Trace:
        signal = self.signal
        values = signal_of(recording, signal) if isinstance(signal, str) else signal(recording)
        return Trace(
            self.label,
            self.color,
            recording.t[part],
            values[part],
            width=self.width,
            dash=self.dash,
        )


def _true(signal: str, width: float = 3.0) -> _Line:
    """A reference, wide and light, so that it still shows under an estimate."""
    return _Line(signal, "true", TRUE, width)


def _nominal(signal: str) -> _Line:
    return _Line(signal, "nominal", BLACK, 0.8)


_MODALITIES = (
    ("RESIDUAL", BLUE, ()),
    ("SENSOR", GREEN, _DASHED),
    ("MODEL", VERMILION, _DOTTED),
    ("RESIDUAL-paper-prior", VERMILION, _DASHED),
)
"""Estimators that are shown, with colour and dashes."""


def _estimates() -> list[_Line]:
    return [_Line(f"{name}.sigma", name, color, dash=dash) for name, color, dash in _MODALITIES]


def _whole(recording: Recording) -> slice:
    return slice(0, len(recording.t))


def _over_time(
    y_label: str,
    lines: Sequence[_Line],
    recording: Recording,
    part: _Part = _whole,
    *,
    within: str = "",
    caption: str = "",
    y_log: bool = False,
) -> Panel:
    """Lines over time; lines whose estimator was not recorded are left out.

    within  signal whose range limits the axis, however far an estimate goes
    """
    shown = part(recording)
    curves = [each.curve(recording, shown) for each in lines if each.is_recorded(recording)]
    y_range = None
    if within:
        reference = signal_of(recording, within)[shown]
        low, high = float(np.min(reference)), float(np.max(reference))
        y_range = min(0.0, low) - 0.1 * high, 1.4 * high
    return Panel(
        "", plain_axis("t"), y_label, curves, y_log=y_log, y_range=y_range, caption=caption
    )


def _stiffness(
    recording: Recording,
    *before: _Line,
    part: _Part = _whole,
    true_width: float = 3.0,
    caption: str = "",
) -> Panel:
    """The true stiffness and the estimate of each modality, on top of the lines `before`."""
    lines = (*before, _true("plant.sigma", true_width), *_estimates())
    label = plain_axis("sigma")
    return _over_time(label, lines, recording, part, within="plant.sigma", caption=caption)


def _errors(recording: Recording, lines: Sequence[_Line]) -> Panel:
    """The largest relative error of each estimated stiffness, in one window of time after another.

    lines  of signals "ESTIMATOR.VARIABLE", whose truth is the variable of the plant
    """
    curves = []
    for line in lines:
        if not line.is_recorded(recording):
            continue
        _, variable = source_and_variable(str(line.signal))
        estimate = line.curve(recording, _whole(recording))
        error = 100 * np.abs(estimate.y / recording.plant[variable] - 1)
        length = int(np.searchsorted(recording.t, _ERROR_WINDOW))
        count = len(error) // length
        largest = error[: count * length].reshape(count, length).max(axis=1)
        starts = recording.t[: count * length : length]
        curves.append(replace(estimate, x=starts, y=largest))
    label = f"relative error [%],\nlargest within {_ERROR_WINDOW:g} s"
    return Panel("", plain_axis("t"), label, curves, y_log=True)


def _over_deformation(
    output: str, side: str, colors: dict[str, str], recording: Recording, about: str = ""
) -> Panel:
    """An output, tau_e or sigma, against the deformation: the truth, and each estimator as dots.

    colors  by estimator; those that were not recorded are left out
    """
    last = recording.t >= (1 - _LAST) * recording.t[-1]
    phi, true = recording.plant[f"phi{side}"][last], recording.plant[f"{output}{side}"][last]
    order = np.argsort(phi)
    curves = [Trace("true", TRUE, phi[order], true[order], width=3.0)]
    for name, color in colors.items():
        if name in recording.estimators:
            estimate = recording.estimators[name]
            x, y = estimate[f"phi{side}"][last], estimate[f"{output}{side}"][last]
            dots = np.argsort(x)[:: max(1, len(x) // _DOTS)]
            curves.append(Trace(name, color, x[dots], y[dots], TraceKind.POINTS))
    caption = f"{about}last {_LAST * recording.t[-1]:g} s"
    return Panel("", plain_axis("phi"), plain_axis(output), curves, linked=False, caption=caption)


def _window(t: Array, centre: float, half_width: float) -> slice:
    """The samples within half_width [s] of centre [s]."""
    first, last = np.searchsorted(t, (centre - half_width, centre + half_width))
    return slice(int(first), int(last) + 1)


def _reversal(signal: str, half_width: float, recording: Recording) -> slice:
    """The samples around the first change of sign of a signal of the plant after 1 s."""
    t = recording.t
    later = t > 1.0
    changes = np.flatnonzero(np.diff(np.sign(recording.plant[signal][later])))
    # A signal that keeps its sign is shown around the middle of the run.
    centre = t[later][changes[0]] if len(changes) else t[len(t) // 2]
    return _window(t, float(centre), half_width)


def _most_wrong(recording: Recording) -> slice:
    """The samples where the nominal torque is most wrong."""
    error = np.abs(signal_of(recording, "nominal.tau_e") - recording.plant["tau_e"])
    return _window(recording.t, float(recording.t[np.argmax(error)]), 0.5)


def _stiffest(recording: Recording) -> slice:
    """The samples around the largest stiffness after 1 s."""
    t = recording.t
    stiffness = np.where(t > 1.0, recording.plant["sigma"], 0.0)
    return _window(t, float(t[np.argmax(stiffness)]), 2.0)


def _differenced(recording: Recording) -> Array:
    """The velocity by differences of the measured position [rad/s]."""
    t = recording.t
    velocity: Array = np.diff(recording.plant["theta_measured"], prepend=0.0) / (t[1] - t[0])
    velocity[0] = 0.0
    return velocity


def _deformation(recording: Recording) -> Panel:
    return _over_time(plain_axis("phi"), [_Line("plant.phi", "deformation φ", BLUE)], recording)


def _velocity(recording: Recording, part: _Part = _whole, caption: str = "") -> Panel:
    lines = [
        _true("plant.theta_dot"),
        _Line(_differenced, "differenced, Δθ/T", SKY),
        _Line("RESIDUAL.theta_dot", "modified kinematic Kalman filter", VERMILION),
    ]
    return _over_time(plain_axis("theta_dot"), lines, recording, part, caption=caption)


def _flexibility_torque(recording: Recording, part: _Part = _whole, caption: str = "") -> Panel:
    lines = [
        _Line("RESIDUAL.tau_e_residual", "residual \u03b3 rₑ", SKY),
        _Line("plant.tau_e_measured", "sensor", GREEN),
        _true("plant.tau_e"),
        _Line("RESIDUAL.tau_e", "fitted, f(θ_c, φ)", VERMILION),
    ]
    return _over_time(plain_axis("tau_e"), lines, recording, part, caption=caption)


def _stability_factor(recording: Recording) -> Panel:
    lines = [_Line("RESIDUAL.a", "RESIDUAL", BLUE)]
    return _over_time("stability factor a(k) [1]", lines, recording, y_log=True)


def _constant_factors(recording: Recording) -> Panel:
    lines = [
        _true("plant.sigma"),
        _Line("RESIDUAL, a = 0.0001.sigma", "constant, too small: a = 0.0001", GREEN),
        _Line("RESIDUAL, a = 0.01.sigma", "constant, too large: a = 0.01", VERMILION),
        _Line("RESIDUAL.sigma", "enhanced: a(k)", BLUE),
    ]
    return _over_time(plain_axis("sigma"), lines, recording, within="plant.sigma")


def _lever_arm(recording: Recording) -> Panel:
    lines = [_true("plant.r"), _nominal("nominal.r")]
    return _over_time("lever arm r [m]", lines, recording)


def _nominal_torque(recording: Recording, part: _Part = _whole, caption: str = "") -> Panel:
    lines = [
        _Line("plant.tau_e_measured", "sensor", GREEN),
        _true("plant.tau_e", width=1.5),
        _nominal("nominal.tau_e"),
    ]
    return _over_time(plain_axis("tau_e"), lines, recording, part, caption=caption)


def _where_most_wrong(recording: Recording) -> Panel:
    return _nominal_torque(recording, _most_wrong, "where the nominal torque is most wrong")


def _nominal_stiffness(recording: Recording) -> Panel:
    return _stiffness(recording, _nominal("nominal.sigma"))


def _largest_stiffness(recording: Recording) -> Panel:
    """The part of figure 12 with the largest stiffness."""
    caption = "where the stiffness is largest"
    panel = _stiffness(recording, _nominal("nominal.sigma"), part=_stiffest, caption=caption)
    true = recording.plant["sigma"][_stiffest(recording)]
    return replace(panel, y_range=(0.95 * float(true.min()), 1.2 * float(true.max())))


def _transmission(recording: Recording) -> FigureRows:
    """One flexible transmission: stiffness over time, the curves, and the relative errors."""
    colors = {name: color for name, color, _ in _MODALITIES}
    return [
        # A wide line would fill an area where the stiffness oscillates as fast as here.
        [_stiffness(recording, true_width=1.2)],
        [_over_deformation(name, "", colors, recording) for name in ("tau_e", "sigma")],
        [_errors(recording, _estimates())],
    ]


def _antagonistic(recording: Recording) -> FigureRows:
    """Torques of both transmissions, the stiffness of the device and of each side, and errors."""
    torques = [
        _Line("plant.tau_e_1", "side 1", GREEN),
        _Line("plant.tau_e_2", "side 2", VERMILION),
        _Line(
            lambda each: each.plant["tau_e_1"] + each.plant["tau_e_2"],
            "sum, which moves the link",
            BLACK,
            0.8,
        ),
    ]
    estimates = [
        _Line(f"RESIDUAL.sigma{side}", f"RESIDUAL, {name}", color)
        for side, color, name in (
            ("", BLUE, "device"),
            ("_1", GREEN, "side 1"),
            ("_2", VERMILION, "side 2"),
        )
    ]
    device, *sides = (
        _over_time(plain_axis("sigma"), [_true(true), line], recording, within=true)
        for line in estimates
        for true in [f"{PLANT}.{source_and_variable(str(line.signal))[1]}"]
    )
    of_sides = (("_1", GREEN), ("_2", VERMILION))
    curves = [
        [
            _over_deformation(
                output, side, {"RESIDUAL": color}, recording, f"side {side.removeprefix('_')}, "
            )
            for side, color in of_sides
        ]
        for output in ("tau_e", "sigma")
    ]
    torque = _over_time(plain_axis("tau_e"), torques, recording)
    return [[torque], [device], sides, *curves, [_errors(recording, estimates)]]


def _start(recording: Recording) -> slice:
    return _window(recording.t, 0.0, 0.3)


FIGURES: dict[str, Callable[[Recording], FigureRows]] = {
    "fig3-deformation": lambda run: [[_deformation(run)]],
    "fig4-velocity": lambda run: [
        [_velocity(run)],
        # Where the quantisation is largest compared with the velocity.
        [_velocity(run, lambda each: _reversal("theta_dot", 0.05, each), "at a reversal")],
    ],
    "fig5-flexibility-torque": lambda run: [
        [_flexibility_torque(run)],
        [
            _flexibility_torque(
                run, lambda each: _reversal("tau_e", 0.25, each), "where the torque changes sign"
            )
        ],
    ],
    "fig6-stiffness": lambda run: [
        [_stiffness(run)],
        [_stiffness(run, part=_start, caption="start-up")],
    ],
    "fig7-stability-factor": lambda run: [[_stability_factor(run)]],
    "fig8-constant-factors": lambda run: [[_constant_factors(run)]],
    "fig9-deformation": lambda run: [[_deformation(run)]],
    "fig10-lever-arm": lambda run: [[_lever_arm(run)]],
    "fig11-flexibility-torque": lambda run: [[_nominal_torque(run)], [_where_most_wrong(run)]],
    "fig12-stiffness": lambda run: [[_nominal_stiffness(run)], [_largest_stiffness(run)]],
    "transmission": _transmission,
    "summary": lambda run: [[_stiffness(run)], [_errors(run, _estimates())]],
    "experiment": lambda run: [
        [_deformation(run)],
        [_lever_arm(run)],
        [_where_most_wrong(run)],
        [_nominal_stiffness(run)],
        [_errors(run, _estimates())],
    ],
    "antagonistic": _antagonistic,
}
"""FigureRows of panels from the recording of a scenario, by the name of the figure."""
