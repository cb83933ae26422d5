"""The contents of a report from the files of `sigmahat reproduce`."""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sigmahat.logs.panels import (
    SIDES,
    Estimate,
    of_side,
    quantity_panels,
    reduce,
    sampling,
    stiffness_panels,
)
from sigmahat.paper.reproduction import SEEDS, TIME, read_result_files
from sigmahat.plotting.panels import COLORS, TRUE, Curve, Kind, Panel
from sigmahat.plotting.style import QUANTITIES, plain_axis
from sigmahat.report.contents import Contents, of_file

_MAIN = "RESIDUAL"  # estimator for panels of a single estimator: RESIDUAL needs no torque sensor
_STIFFNESS = re.compile(r"sigma(_\d)?")


def from_reproduction(folder: Path) -> Contents:
    """Stiffness of every estimator, and all other signals of one estimator.

    Raises ValueError as read_result_files() does.
    """
    files = read_result_files(folder)
    main = _MAIN if _MAIN in files.series else next(iter(files.series))
    signals = dict(files.series[main])
    t = signals.pop(TIME)
    estimates = []
    for name, own in files.series.items():
        keys = {each: f"{name} {each}" for each in own if _STIFFNESS.fullmatch(each)}
        signals |= {key: own[each] for each, key in keys.items()}
        estimates.append(Estimate(name, keys))
    reduced = reduce(t, signals)
    seeds = files.table[SEEDS][0].as_py()
    of_seeds = f" of {seeds} seeds; the plots show the first" if seeds > 1 else ""
    table = files.table  # the columns that have a value in some row
    shown = [name for name in table.column_names if table[name].null_count < len(table)]
    return Contents(
        f"Reproduction: {folder.resolve().name}",
        [f"{len(t)} samples{of_seeds}"],
        [of_file("Performance indices", table.select(shown))],
        [
            *stiffness_panels(reduced, estimates),
            *quantity_panels(reduced, main if len(files.series) > 1 else ""),
        ],
        answer=list(over_deformation(files.series[main], main)),
        notes=sampling(reduced),
        every=reduced.every if reduced.bucket > 1 else None,
    )


_LAST = 1 / 3  # fraction of the run that is shown: at the end, an estimate changes little
_COUNT = 100  # number of dots of the estimate: few, so that the truth is visible between the dots

Signals = Mapping[str, NDArray[Any]]


def over_deformation(signals: Signals, estimator: str) -> Iterator[Panel]:
    """Two panels for each transmission with a fixed spring; separate panels for sides of a pair.

    No panels without the truth. signals  of the plant and of one estimator
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
                f"{words} against deformation{of_side(side)}, {estimator}",
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
