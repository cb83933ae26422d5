"""Torque and stiffness over the deformation in a simulation, true and estimated."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.plotting.symbols import QUANTITIES, plain_axis
from sigmahat.report.contents import COLORS, TRUE, Curve, Kind, Panel
from sigmahat.report.time_panels import SIDES, of_side

_LAST = 1 / 3
"""Part of the run that is shown: there an estimate changes little."""
_COUNT = 100
"""Samples of the estimate: so few that the truth is seen between them."""

Signals = Mapping[str, NDArray[Any]]


def over_deformation(signals: Signals, estimator: str) -> Iterator[Panel]:
    """Two panels for each transmission that does not change its stiffness; sides of a pair apart.

    None without the truth. signals  of the plant and of one estimator
    """
    for side in SIDES:
        needed = [f"{name}{side}" for name in ("phi", "tau_e", "sigma", "setPoint")]
        needed += [f"plant.{name}" for name in needed[:3]]
        if not all(name in signals for name in needed):
            continue
        late = slice(int(len(signals["t"]) * (1 - _LAST)), None)
        own = {name: signals[name][late] for name in needed}
        if np.ptp(own[f"setPoint{side}"]) > 0:
            continue
        for name in ("tau_e", "sigma"):
            words = QUANTITIES[name].words.capitalize()
            yield Panel(
                f"{words} over the deformation{of_side(side)}, {estimator}",
                plain_axis("phi"),
                plain_axis(name),
                list(_curves(own, name, side)),
                linked=False,
                caption=f"last {_LAST * float(signals['t'][-1]):.3g} s",
            )


def _curves(signals: Signals, name: str, side: str) -> Iterator[Curve]:
    """The truth as a line, and the estimate as dots on it or beside it."""
    phi, true = signals[f"plant.phi{side}"], signals[f"plant.{name}{side}"]
    every = _few(phi, 10 * _COUNT)
    yield Curve("true", TRUE, phi[every], true[every], width=3.5)
    phi, value = signals[f"phi{side}"], signals[f"{name}{side}"]
    few = _few(phi, _COUNT)
    yield Curve("estimate", COLORS[0], phi[few], value[few], Kind.POINTS)


def _few(phi: NDArray[Any], count: int) -> NDArray[np.intp]:
    """About count samples, in the order of the deformation."""
    few: NDArray[np.intp] = np.argsort(phi)[:: max(1, len(phi) // count)]
    return few
