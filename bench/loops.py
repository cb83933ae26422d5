"""The loops of the package, in C and in Python, and FMPy."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import fmpy
import numpy as np

import sigmahat
from sigmahat.runs.scenario import T
from subjects import MEASUREMENTS, OUTPUTS, Array, Subject

JOINTS = 30


def objects(z: Array) -> Iterator[Subject]:
    """sigmahat.Estimator over arrays: one joint, and many."""
    columns = dict(zip(MEASUREMENTS, np.ascontiguousarray(z.T), strict=True))
    one = sigmahat.Estimator({}, OUTPUTS)
    yield Subject("Estimator.run", lambda: one.run(**columns), len(z))
    short = {name: np.tile(each[: len(z) // 10], (JOINTS, 1)) for name, each in columns.items()}
    many = sigmahat.Estimator([{}] * JOINTS, OUTPUTS)
    count = JOINTS * (len(z) // 10)
    yield Subject(f"Estimator.run, {JOINTS} joints", lambda: many.run(**short), count)
    regression = sigmahat.Estimator({"method": "FilteredRegression"}, OUTPUTS)
    yield Subject("Estimator.run, FilteredRegression", lambda: regression.run(**columns), len(z))
    row = z[0].tolist()
    named = dict(zip(MEASUREMENTS, row, strict=True))
    few = max(len(z) // 100, 1)

    def ticks() -> None:
        for _ in range(few):
            one.tick(**named)

    yield Subject("Estimator.tick", ticks, few)


def whole(z: Array) -> Iterator[Subject]:
    """The estimator FMU over measurements, with all that comes before and after: FMPy and ours."""
    t = T * np.arange(len(z))
    names = ("time", *MEASUREMENTS)
    rows = np.rec.fromarrays([t, *z.T], [(name, float) for name in names])
    path = sigmahat.fmu("StiffnessEstimator")
    yield Subject(
        "simulate_fmu of FMPy",
        lambda: fmpy.simulate_fmu(
            path, stop_time=t[-1], step_size=T, output_interval=T, input=rows, output=OUTPUTS
        ),
        len(z),
        every=20,
    )
    # The FMU in the place of a plant, so that the measurements are its inputs.
    inputs = {name: partial(_recorded, rows[name]) for name in MEASUREMENTS}
    plant = sigmahat.Plant(str(path), {}, inputs, OUTPUTS)
    yield Subject(
        "simulate of sigmahat",
        lambda: sigmahat.simulate(plant, {}, T, len(z) - 1),
        len(z),
        every=5,
    )


def _recorded(values: Array, _t: Array) -> Array:
    return values
