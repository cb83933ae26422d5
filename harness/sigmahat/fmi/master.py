"""Co-simulation master: one plant FMU and any number of estimator FMUs, side by side.

At every t_k = k T the outputs of the plant at t_k go into the estimators, which run their tick
at t_k; then the plant goes on to t_k+1 under inputs that are linear in between.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from fmpy import fmi2
from numpy.typing import NDArray

from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.fmi.instance import Fmu, Recorder, Slave, Value

Signal = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Values of an input at the times given [s]."""

_PROGRESS_STEPS = 100


@dataclass(frozen=True)
class Plant:
    """A plant FMU."""

    fmu: str
    """Name of an FMU of this package, or path of a .fmu file."""
    start: Mapping[str, Value]
    """Start values by FMU name, in the unit of the variable; enumerations by item name."""
    inputs: Mapping[str, Signal]
    """Signal for each input that is not to stay at its start value."""
    record: Sequence[str]
    """Variables to record."""


@dataclass(frozen=True)
class Estimator:
    """An estimator FMU."""

    fmu: str
    """Name of an FMU of this package, or path of a .fmu file."""
    start: Mapping[str, Value]
    """Start values by FMU name, in the unit of the variable; enumerations by item name."""
    connections: Mapping[str, str]
    """Which output of the plant feeds each input."""
    record: Sequence[str]
    """Variables to record."""


@dataclass(frozen=True)
class Series:
    """What was recorded of one FMU."""

    values: Mapping[str, NDArray[Any]]
    """Recorded variables by name, each of shape (N + 1,), in the unit of the variable."""
    units: Mapping[str, str]
    """Unit of each recorded Real, as in the model description."""
    parameters: Mapping[str, Value]
    """All parameters of the FMU as they were at the start."""

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.values[name]


@dataclass(frozen=True)
class Recording:
    """Plant and estimators at t_k = k T, k = 0..N."""

    t: NDArray[np.float64]
    """Time [s], shape (N + 1,)."""
    plant: Series
    """What was recorded of the plant."""
    estimators: Mapping[str, Series]
    """What was recorded of each estimator, by its name."""


def simulate(
    plant: Plant,
    estimators: Mapping[str, Estimator],
    T: float,
    steps: int,
    progress: Callable[[int], object] = lambda steps: None,
) -> Recording:
    """Steps plant and estimators over N = steps periods of T [s].

    The estimators tick at t_0 to t_N, N + 1 times; the plant makes N steps. From time to time
    progress is called with the number of steps made since the last call.

    Raises FileNotFoundError for a missing FMU, ValueError for a name that an FMU does not have or
    a value that does not fit, FmuError with the FMU's own message if an FMU refuses. Warnings of
    FMUs go to the logger "sigmahat".
    """
    t = T * np.arange(steps + 1, dtype=np.float64)
    with ExitStack() as stack:
        fmus: dict[Path, Fmu] = {}

        def instantiate(fmu: str, name: str) -> Slave:
            path = Path(fmu) if fmu.endswith(".fmu") else installed_fmu(fmu)
            if path not in fmus:
                fmus[path] = stack.enter_context(Fmu(path))
            return stack.enter_context(Slave(fmus[path], name))

        plant_slave = instantiate(plant.fmu, "plant")
        drive = _Drive(plant_slave, plant.inputs, t)
        plant_slave.initialize({**plant.start, **drive.first})
        truth = Recorder(plant_slave, plant.record, len(t))
        links = {}
        for name, estimator in estimators.items():
            slave = instantiate(estimator.fmu, name)
            slave.initialize(estimator.start)
            links[name] = _Link(plant_slave, slave, estimator, len(t))

        for k, time in enumerate(t.tolist()):
            truth.sample(k)
            for link in links.values():
                link.tick(k, time, T)
            if k < steps:
                drive.step(k, time, T)
                if (k + 1) % _PROGRESS_STEPS == 0:
                    progress(_PROGRESS_STEPS)
        progress(steps % _PROGRESS_STEPS)

        return Recording(
            t,
            _series(truth, plant_slave, plant.start),
            {
                name: _series(link.recorder, link.slave, estimators[name].start)
                for name, link in links.items()
            },
        )


def _series(recorder: Recorder, slave: Slave, start: Mapping[str, Value]) -> Series:
    return Series(recorder.columns(), recorder.units, slave.fmu.parameters(start))


class _Drive:
    """Steps the plant under inputs that are linear from t_k to t_k+1."""

    def __init__(self, plant: Slave, inputs: Mapping[str, Signal], t: NDArray[np.float64]) -> None:
        count = len(inputs)
        values = np.empty((len(t), count))
        for i, signal in enumerate(inputs.values()):
            values[:, i] = signal(t)
        self.first = dict(zip(inputs, values[0].tolist(), strict=True))
        self._values = np.ctypeslib.as_ctypes(values)
        slopes = np.diff(values, axis=0) / np.diff(t)[:, None]
        self._slopes = np.ctypeslib.as_ctypes(slopes)
        self._plant = plant
        self._references = plant.fmu.references(inputs, "input")
        self._orders = (fmi2.fmi2Integer * count)(*[1] * count)

    def step(self, k: int, t: float, T: float) -> None:
        call, fmi, references = self._plant.call, self._plant.functions, self._references
        count = len(references)
        call(fmi.fmi2SetReal, references, count, self._values[k])
        call(fmi.fmi2SetRealInputDerivatives, references, count, self._orders, self._slopes[k])
        call(fmi.fmi2DoStep, t, T, fmi2.fmi2True)


class _Link:
    """An estimator and its wires from the plant."""

    def __init__(self, plant: Slave, slave: Slave, estimator: Estimator, samples: int) -> None:
        self._plant = plant
        self.slave = slave
        self._sources = plant.fmu.references(estimator.connections.values(), "output")
        self._inputs = slave.fmu.references(estimator.connections.keys(), "input")
        self._buffer = (fmi2.fmi2Real * len(self._inputs))()
        self.recorder = Recorder(slave, estimator.record, samples)

    def tick(self, k: int, t: float, T: float) -> None:
        plant, slave, count = self._plant, self.slave, len(self._buffer)
        plant.call(plant.functions.fmi2GetReal, self._sources, count, self._buffer)
        slave.call(slave.functions.fmi2SetReal, self._inputs, count, self._buffer)
        slave.call(slave.functions.fmi2DoStep, t, T, fmi2.fmi2True)
        self.recorder.sample(k)
