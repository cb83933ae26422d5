"""Co-simulation master: one plant FMU and any number of estimator FMUs, side by side.

At every t_k = k T the estimators get the outputs of the plant at t_k, and run their tick. Then the
plant makes a step to t_k+1, with inputs that are linear during the step.
"""

import math
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sigmahat.fmi.instance import Slave, named
from sigmahat.fmi.model import Value
from sigmahat.fmi.sample_loop import Recorder, SampleLoop, step_times
from sigmahat.fmi.series import Series

Signal = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Values of an input at the times given [s]."""

_PIECE = 0.05  # [s] about, between two moments at which Ctrl-C can end the loop
_MOST = 1024  # steps in a piece


@dataclass(frozen=True)
class Plant:
    """A plant FMU."""

    fmu: str  #: Name of an FMU of this package, or path of a .fmu file.
    start: Mapping[str, Value]
    """Start values by FMU name, in the unit of the variable; enumerations by item name."""
    inputs: Mapping[str, Signal]  #: Signal for each input that is not to stay at its start value.
    record: Sequence[str]  #: Variables to record.


@dataclass(frozen=True)
class EstimatorFmu:
    """An estimator FMU."""

    fmu: str  #: Name of an FMU of this package, or path of a .fmu file.
    start: Mapping[str, Value]
    """Start values by FMU name, in the unit of the variable; enumerations by item name."""
    connections: Mapping[str, str]  #: Output of the plant that feeds each input.
    record: Sequence[str]  #: Variables to record.


@dataclass(frozen=True)
class Recording:
    """Plant and estimators at t_k = k T, k = 0..N."""

    t: NDArray[np.float64]  #: Time [s], shape (N + 1,).
    plant: Series  #: Recorded variables of the plant.
    estimators: Mapping[str, Series]  #: Recorded variables of each estimator, by its name.


def simulate(
    plant: Plant,
    estimators: Mapping[str, EstimatorFmu],
    T: float,
    steps: int,
    progress: Callable[[int], object] = lambda steps: None,
) -> Recording:
    """Steps plant and estimators over N = steps periods of T [s].

    The estimators tick at t_0 to t_N, N + 1 times; the plant makes N steps. Plant and estimators
    can be any FMUs for FMI 2.0 Co-Simulation. Inputs are linear during a step, but held if the
    plant cannot interpolate (see canInterpolateInputs in its model description).
    The noise of a plant of this package has a period of its own, the parameter noise.samplePeriod.
    Progress is called from time to time with the number of steps since the last call.

    Raises FileNotFoundError for a missing FMU, ValueError for an unknown name or a value that does
    not fit, and FmuError with the message of the FMU if an FMU refuses. Warnings of
    FMUs go to the logger "sigmahat".
    """
    if not (math.isfinite(T) and T > 0) or steps != int(steps) or steps < 0:
        raise ValueError(f"expected T > 0 s and a number of steps, got T = {T} and {steps} steps")
    t = T * np.arange(int(steps) + 1, dtype=np.float64)
    times = step_times(t, T)
    with ExitStack() as stack:
        plant_slave = stack.enter_context(Slave(named(str(plant.fmu)), "plant"))
        names, values = list(plant.inputs), np.empty((len(t), len(plant.inputs)))
        for i, signal in enumerate(plant.inputs.values()):
            values[:, i] = signal(t)
        inputs = plant_slave.fmu.references(names, "input")
        first = dict(zip(names, values[0].tolist(), strict=True))
        plant_slave.initialize({**plant.start, **first})
        truth, recorders = Recorder(plant_slave, plant.record, len(t)), {}
        tick = SampleLoop()
        truth.add_to(tick)
        for name, estimator in estimators.items():
            slave = stack.enter_context(Slave(named(str(estimator.fmu)), name))
            slave.initialize(estimator.start)
            wires = np.empty(len(estimator.connections))
            outputs = plant_slave.fmu.references(estimator.connections.values(), "output")
            tick.get(plant_slave, "Real", outputs, wires)
            tick.set_real(slave, slave.fmu.references(estimator.connections, "input"), wires)
            tick.step(slave, times)
            recorders[name] = Recorder(slave, estimator.record, len(t))
            recorders[name].add_to(tick)
        loop = SampleLoop(tick)
        loop.set_real(plant_slave, inputs, values)
        if plant_slave.fmu.description.coSimulation.canInterpolateInputs:
            loop.set_slopes(plant_slave, inputs, np.diff(values, axis=0) / np.diff(t)[:, None])
        loop.step(plant_slave, times)

        _run_in_pieces(loop, steps, progress)
        tick.run(steps, steps + 1)

        return Recording(
            t,
            _series(truth, plant.start, t),
            {name: _series(recorders[name], each.start, t) for name, each in estimators.items()},
        )


def _run_in_pieces(loop: SampleLoop, steps: int, progress: Callable[[int], object]) -> None:
    """Runs the loop in pieces, whose size adapts to the time that the FMUs need for a step."""
    first, size = 0, 1
    while first < steps:
        end, begin = min(first + size, steps), time.perf_counter()
        loop.run(first, end)
        progress(end - first)
        took = time.perf_counter() - begin
        size = min(2 * size, _MOST) if took < _PIECE / 2 else max(size // 2, 1)
        first = end


def _series(recorder: Recorder, start: Mapping[str, Value], t: NDArray[np.float64]) -> Series:
    fmu = recorder.slave.fmu
    return Series.of(fmu, recorder.columns(), fmu.parameters(start), t)
