"""The curve of a joint as Matplotlib draws it: torque and stiffness over the deformation."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from sigmahat.joint.curve import Array, Branch, Curve, nearest
from sigmahat.logs.measured import MeasuredPoints
from sigmahat.plotting.colors import BLUE, cycle
from sigmahat.plotting.scale import limits
from sigmahat.plotting.symbols import math_axis

_FADED = 0.35


def draw_curve(torque: Axes, stiffness: Axes, curve: Curve, points: MeasuredPoints) -> None:
    """Both panels; the measured points stand behind the torque, faintly."""
    several = len(curve.branches) > 1
    colors = cycle(len(curve.branches)) if several else [BLUE] * len(curve.branches)
    measured: list[Array] = []
    band = None if several else "95 % band"
    for i, (branch, color) in enumerate(zip(curve.branches, colors, strict=True)):
        measured.append(_points(torque, curve, i, points, color))
        label = f"{branch.set_point:.3g}" if several else r"fitted $f(\theta_c, \phi)$"
        _branch(torque, branch, branch.tau_e, branch.torque_interval(), color, label, band)
        label = f"{branch.set_point:.3g}" if several else r"estimate $\hat\sigma$"
        _branch(stiffness, branch, branch.sigma, branch.stiffness_interval(), color, label, band)
    _scale(torque, [*measured, *(_shown(b, b.tau_e, b.torque_interval()) for b in curve.branches)])
    _scale(stiffness, [_shown(b, b.sigma, b.stiffness_interval()) for b in curve.branches])
    torque.set_ylabel(math_axis("tau_e"))
    stiffness.set_ylabel(math_axis("sigma"))
    for axes in (torque, stiffness):
        axes.set_xlabel(math_axis("phi"))
        axes.locator_params(axis="x", nbins=6)
        axes.ticklabel_format(axis="x", scilimits=(-2, 3))
    _legends(torque, stiffness, curve)


def _legends(torque: Axes, stiffness: Axes, curve: Curve) -> None:
    """The set-points once, beside the stiffness; else what is drawn."""
    band = ["with 95 % band"] if curve.claims else []
    if len(curve.branches) > 1:
        title = "\n".join(["set-point $s$", *band])
        stiffness.legend(title=title, loc="center left", bbox_to_anchor=(1.0, 0.5), reverse=True)
        return
    for axes in (torque, stiffness) if curve.branches else ():
        axes.legend(loc="upper left")
        bottom, top = axes.get_ylim()
        axes.set_ylim(bottom, top + 0.2 * (top - bottom))


def _branch(
    axes: Axes,
    branch: Branch,
    values: Array,
    interval: tuple[Array, Array] | None,
    color: str,
    label: str,
    band: str | None,
) -> None:
    """A line with its band, both faded beyond the data."""
    within = branch.within
    axes.plot(branch.phi[within], values[within], color=color, label=label, linewidth=1.4)
    axes.plot(branch.phi, values, color=color, alpha=_FADED, linestyle="--")
    if interval is None:
        return
    low, high = interval
    style: Any = {"color": color, "linewidth": 0}
    axes.fill_between(branch.phi, low, high, alpha=0.08, **style)
    axes.fill_between(branch.phi, low, high, where=within.tolist(), alpha=0.22, label=band, **style)


def _points(axes: Axes, curve: Curve, branch: int, points: MeasuredPoints, color: str) -> Array:
    """The points that belong to a branch. Returns the torques that the scale is to show."""
    settings = [each.set_point for each in curve.branches]
    own = np.flatnonzero(nearest(settings, points.set_point) == branch)
    style: Any = {"color": color, "linestyle": "", "marker": "o", "markeredgewidth": 0}
    axes.plot(
        points.phi[own],
        points.tau_e[own],
        markersize=2,
        alpha=0.1,
        zorder=0.5,
        rasterized=True,
        **style,
    )
    if len(curve.branches) == 1:
        axes.plot([], [], markersize=4, alpha=0.4, label="measured", **style)
    return np.array(limits(points.tau_e[own])) if len(own) else np.empty(0)


def _shown(branch: Branch, values: Array, interval: tuple[Array, Array] | None) -> Array:
    """Values that the scale is to show: those where the data reach."""
    every = [values, *(interval or ())]
    return np.concatenate([each[branch.within] for each in every])


def _scale(axes: Axes, shown: list[Array]) -> None:
    values = np.concatenate([np.empty(0), *shown])
    values = values[np.isfinite(values)]
    if len(values):
        low, high = float(values.min()), float(values.max())
        margin = 0.15 * ((high - low) or abs(high) or 1.0)
        axes.set_ylim(low - margin, high + margin)
