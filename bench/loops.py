"""The loops of the package, in C and in Python, and FMPy."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import nullcontext
from functools import partial
from unittest.mock import patch

import fmpy
import numpy as np

import sigmahat
from sigmahat.fmi import native
from sigmahat.fmi.instance import Slave
from sigmahat.fmi.opened import installed
from sigmahat.fmi.sample_loop import Recorder, SampleLoop, step_times
from sigmahat.runs.scenario import T
from subjects import MEASURED, MEASUREMENTS, OUTPUTS, TORQUES, Array, Subject

JOINTS = 30


def pair(samples: int) -> Iterator[Subject]:
    """AwasPlant with the torques of table1 and an estimator, connected."""
    t = T * np.arange(samples, dtype=np.float64)
    u = np.column_stack([signal(t) for signal in TORQUES.values()])
    yield Subject("pair, loop in C", _loop(u, t, in_c=True), samples)
    few = max(samples // 20, 2)
    yield Subject("pair, loop in Python", _loop(u[:few], t[:few], in_c=False), few, every=5)


def _loop(u: Array, t: Array, in_c: bool) -> Callable[[], None]:
    """The loop of the package, in C or in Python; the FMUs begin again each time."""
    plant, estimator = (
        Slave(installed(name), name) for name in ("AwasPlant", "StiffnessEstimator")
    )
    times, wires = step_times(t, T), np.empty(len(MEASURED))
    slopes = np.empty_like(u)
    loop = SampleLoop()
    Recorder(plant, ["sigma"], len(t)).add_to(loop)
    loop.get_real(plant, plant.fmu.references(MEASURED), wires)
    loop.set_real(estimator, estimator.fmu.references(MEASUREMENTS), wires)
    loop.step(estimator, times)
    Recorder(estimator, OUTPUTS, len(t)).add_to(loop)
    loop.set_real(plant, plant.fmu.references(TORQUES), u)
    loop.set_slopes(plant, plant.fmu.references(TORQUES), slopes)
    loop.step(plant, times)

    def batch() -> None:
        for slave in (plant, estimator):
            slave.call(slave.functions.fmi2Reset)
            slave.initialize({})
        np.divide(np.diff(u, axis=0, append=u[-1:]), T, out=slopes)
        with nullcontext() if in_c else patch.object(native, "library", lambda: None):
            loop.run(0, len(t))

    for slave in (plant, estimator):
        slave.initialize({})
    return batch


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
