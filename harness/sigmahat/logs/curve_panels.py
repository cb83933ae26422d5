"""The panels of a curve: torque and stiffness against the deformation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from sigmahat.joint import curve as joint
from sigmahat.logs.measured import MeasuredPoints
from sigmahat.plotting.panels import COLORS, Curve, Panel
from sigmahat.plotting.style import QUANTITIES, around, limits, plain_axis


def curve_panels(curve: joint.Curve, points: MeasuredPoints) -> Iterator[Panel]:
    """The torque with the measured points, and the stiffness; no panels without data."""
    if not curve.branches:
        return
    settings = [branch.set_point for branch in curve.branches]
    of_branch = joint.nearest(settings, points.set_point)
    torques, stiffnesses = [], []
    for i, branch in enumerate(curve.branches):
        own = of_branch == i
        label = f"set-point {branch.set_point:.3g}" if len(settings) > 1 else "estimate"
        color = COLORS[i % len(COLORS)]
        behind = points.phi[own], points.tau_e[own]
        line = Curve(label, color, branch.phi, branch.sigma, within=branch.within, width=2.0)
        stiffnesses.append(replace(line, band=branch.stiffness_interval()))
        band = branch.torque_interval()
        torques.append(replace(line, y=branch.tau_e, band=band, behind=behind))
    for name, curves in (("tau_e", torques), ("sigma", stiffnesses)):
        words = QUANTITIES[name].words.capitalize()
        yield Panel(
            f"{words} against deformation",
            plain_axis("phi"),
            plain_axis(name),
            curves,
            linked=False,
            caption=_caption(name, curve),
            y_range=_scale(curves),
        )


def _caption(name: str, curve: joint.Curve) -> str:
    parts = ["points: measured"] if name == "tau_e" else []
    parts += ["band: 95 %"] if curve.claims else []
    return "; ".join([*parts, "faded: outside of the data"])


def _scale(curves: list[Curve]) -> tuple[float, float] | None:
    """Range of the axis: the range of the data, without single points that are far off."""
    shown = []
    for each in curves:
        shown += [values[each.within] for values in (each.y, *(each.band or ()))]
        if each.behind is not None and len(each.behind[1]):
            shown.append(np.array(limits(each.behind[1])))
    return around(shown, 0.1)
