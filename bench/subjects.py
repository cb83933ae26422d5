"""The subjects whose time is measured. Each repeats the same work on the same inputs."""

from __future__ import annotations

import ctypes
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import padasip
from fmpy import fmi2
from numpy.typing import NDArray

import sigmahat
from sigmahat.fmi.master import simulate
from sigmahat.paper.scenarios import SCENARIOS
from sigmahat.runs.scenario import Sine, T

Array = NDArray[np.float64]

HERE = Path(__file__).parent
SIZES = (3, 6, 18, 40)
P_0 = 1e3  # as BENCH_P_0 in least_squares.h
METHODS = ("Paper2011", "FilteredRegression", "FilteredRegression, 21 columns")
MODALITIES = ("RESIDUAL", "SENSOR", "MODEL")
MEASUREMENTS = ("theta", "q", "theta_c", "tau", "tau_e_sensor")
OUTPUTS = ("sigma", "tau_e", "theta_dot")
TORQUES = {"tau": Sine(0.3, 0.1), "tau_c": Sine(8.0, 0.1)}
"""Of scenario table1."""


@dataclass(frozen=True)
class Subject:
    """A piece of work whose time is measured."""

    name: str
    batch: Callable[[], object]
    """Does the piece of work `count` times."""
    count: int
    every: int = 1
    """It runs only in every round whose number is a multiple of this."""


class Library:
    """A shared library with subjects in C and C++."""

    def __init__(self, file: Path) -> None:
        self._library: Any = ctypes.CDLL(str(file))

    def start(self, maker: str, *arguments: Any) -> int:
        """Address of the object that <maker>_start makes. Raises RuntimeError if it is NULL."""
        made: int | None = self.function(f"{maker}_start", ctypes.c_void_p)(*arguments)
        if not made:
            raise RuntimeError(f"{maker}_start{arguments} refused")
        return made

    def function(self, name: str, result: Any = None) -> Any:
        """A function of the library. Pointers are passed to it as ctypes objects."""
        function = self._library[name]
        function.restype = result
        return function


def doubles(array: Array) -> Any:
    """Pointer to a contiguous array. It is valid only as long as the array exists."""
    assert array.flags.c_contiguous and array.dtype == np.float64
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


# Least squares


@dataclass(frozen=True)
class Regression:
    """Samples of a regression whose regressor is a delay line: F(k) = (x(k), x(k-1), ...)."""

    F: Array
    y: Array


def regression(size: int, samples: int) -> Regression:
    """Identification of a filter with `size` taps from white noise, with noise on the output."""
    random = np.random.default_rng(size)
    x = random.standard_normal(samples + size - 1)
    F = np.lib.stride_tricks.sliding_window_view(x, size)[:, ::-1]
    y = F @ random.standard_normal(size) + 0.01 * random.standard_normal(samples)
    return Regression(np.ascontiguousarray(F), y)


class Numpy:
    """Recursive least squares as written by hand in numpy."""

    def __init__(self, size: int) -> None:
        self.eta, self.P = np.zeros(size), P_0 * np.eye(size)

    def run(self, data: Regression) -> None:
        """Processes all samples."""
        for F, y in zip(data.F, data.y, strict=True):
            PF = self.P @ F
            K = PF / (1 + F @ PF)
            self.eta = self.eta + K * (y - F @ self.eta)
            self.P = self.P - np.outer(K, PF)


class Padasip:
    """FilterRLS of padasip without forgetting."""

    def __init__(self, size: int) -> None:
        self._filter = padasip.filters.FilterRLS(size, mu=1.0, eps=1 / P_0, w="zeros")

    @property
    def eta(self) -> Array:
        """Estimate."""
        weights: Array = self._filter.w
        return weights

    def run(self, data: Regression) -> None:
        """Processes all samples."""
        for F, y in zip(data.F, data.y, strict=True):
            self._filter.adapt(y, F)


class Compiled:
    """A recursion of the shared library."""

    def __init__(self, library: Library, make: str, size: int) -> None:
        self._library, self._make, self._size = library, make, size
        self._state = ctypes.c_void_p(library.start(make, size))
        self._run = library.function(f"{make}_run")

    @property
    def eta(self) -> Array:
        """Estimate."""
        eta = np.zeros(self._size)
        self._library.function(f"{self._make}_eta")(self._state, doubles(eta))
        return eta

    def run(self, data: Regression) -> None:
        """Processes all samples."""
        self._run(self._state, doubles(data.F), doubles(data.y), len(data.y))


def recursions(library: Library, size: int) -> dict[str, Any]:
    """A new recursion of every make that computes an estimate, by name."""
    makes = {
        make: Compiled(library, make, size) for make in ("sigmahat", "eigen", "dlib", "liquid")
    }
    return {**makes, "numpy": Numpy(size), "padasip": Padasip(size)}


def least_squares(library: Library, size: int, samples: int) -> Iterator[Subject]:
    """All recursions, and the covariance update alone as the reference."""
    whole, short = regression(size, samples), regression(size, max(samples // 50, 1))
    every = recursions(library, size) | {"covariance": Compiled(library, "covariance", size)}
    for make, rls in every.items():
        data = short if make in ("numpy", "padasip", "liquid") else whole
        yield Subject(f"{make} {size}", _bind(rls.run, data), len(data.y))


def native_recursions(native: Library, size: int) -> dict[str, Compiled]:
    """New recursions that are compiled for the processor of this machine, by name."""
    return {f"{make} native": Compiled(native, make, size) for make in ("sigmahat", "eigen")}


def native_least_squares(native: Library, size: int, samples: int) -> Iterator[Subject]:
    """The recursions of `native_recursions`."""
    data = regression(size, samples)
    for make, rls in native_recursions(native, size).items():
        yield Subject(f"{make} {size}", _bind(rls.run, data), samples)


def peak(library: Library, times: int) -> Subject:
    """Multiplications and additions in registers, without access to memory."""
    function = library.function("peak_run", ctypes.c_double)
    return Subject("peak", lambda: function(times), 2 * 24 * times)


# Ticks


def measurements(samples: int) -> Array:
    """Measurements of the estimator at the begin of scenario table1 [size: samples x 5]."""
    plant = SCENARIOS["table1"].plant
    record = [
        *("theta_measured", "q_measured", "theta_c_measured", "tau_measured", "tau_e_measured")
    ]
    run = simulate(replace(plant, record=record), {}, T, samples - 1)
    return np.column_stack([run.plant[name] for name in record])


class Ticks:
    """The estimator of the C library, called without an FMU."""

    def __init__(self, library: Library, method: str) -> None:
        self._state = ctypes.c_void_p(library.start("tick", method.encode()))
        self._run = library.function("tick_run")
        self.outputs = np.zeros(len(OUTPUTS))

    def run(self, z: Array) -> None:
        """Processes all samples."""
        self._run(self._state, doubles(z), len(z), doubles(self.outputs))


class Master:
    """An FMU, run by the master in C."""

    def __init__(
        self,
        library: Library,
        folder: Path,
        inputs: Sequence[str],
        outputs: Sequence[str],
        slopes: bool = False,
    ) -> None:
        description = fmpy.read_model_description(str(folder))
        name = description.coSimulation.modelIdentifier
        binary = folder / "binaries" / fmpy.platform / (name + fmpy.sharedLibraryExtension)
        references = {v.name: v.valueReference for v in description.modelVariables}
        self.state = ctypes.c_void_p(
            library.start(
                "master",
                str(binary).encode(),
                description.guid.encode(),
                (folder / "resources").as_uri().encode(),
                (ctypes.c_uint * len(inputs))(*(references[i] for i in inputs)),
                len(inputs),
                (ctypes.c_uint * len(outputs))(*(references[i] for i in outputs)),
                len(outputs),
                int(slopes),
            )
        )
        self._run = library.function("master_run", ctypes.c_int)
        self.outputs = np.zeros(len(outputs))

    def run(self, u: Array) -> None:
        """Makes one step for each row of inputs. Raises RuntimeError if the FMU refuses one."""
        h = ctypes.c_double(T)
        if self._run(self.state, doubles(u), len(u), h, doubles(self.outputs)) != 0:
            raise RuntimeError("the FMU refused a call")


class Fmpy:
    """An FMU, run by FMPy with the calls that its documentation shows."""

    def __init__(self, folder: Path) -> None:
        description = fmpy.read_model_description(str(folder))
        references = {v.name: v.valueReference for v in description.modelVariables}
        self._inputs = [references[name] for name in MEASUREMENTS]
        self._outputs = [references[name] for name in OUTPUTS]
        self._time = 0.0
        self.outputs: list[float] = []
        self._fmu = fmi2.FMU2Slave(
            guid=description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="bench",
        )
        self._fmu.instantiate()
        self._fmu.setupExperiment(startTime=0.0)
        self._fmu.enterInitializationMode()
        self._fmu.exitInitializationMode()

    def run(self, z: list[list[float]]) -> None:
        """Makes one step for each row of inputs."""
        fmu = self._fmu
        for row in z:
            fmu.setReal(self._inputs, row)
            fmu.doStep(currentCommunicationPoint=self._time, communicationStepSize=T)
            self._time += T
            self.outputs = fmu.getReal(self._outputs)


@dataclass(frozen=True)
class Fmus:
    """Folders of the unpacked FMUs. They must not change while the FMUs are loaded."""

    estimator: Path
    plant: Path
    pythonfmu: Path
    """The estimator in Python, `paper2011_slave.py`."""


def unpack(folder: Path) -> Fmus:
    """Builds the FMU of PythonFMU, and unpacks all FMUs into a folder."""
    script = HERE / "paper2011_slave.py"
    subprocess.run(
        [sys.executable, "-m", "pythonfmu", "build", "-f", script, "-d", folder],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    files = (
        sigmahat.fmu("StiffnessEstimator"),
        sigmahat.fmu("AwasPlant"),
        folder / "Paper2011.fmu",
    )
    return Fmus(*(Path(fmpy.extract(str(fmu), str(folder / fmu.stem))) for fmu in files))


def ticks(library: Library, fmus: Fmus, z: Array) -> Iterator[Subject]:
    """The tick of the C library, and the same in FMUs."""
    few = np.ascontiguousarray(z[: max(len(z) // 100, 1)])
    rows = few.tolist()
    for method in METHODS:
        yield Subject(f"tick {method}", _bind(Ticks(library, method).run, z), len(z))
    own_master = Master(library, fmus.estimator, MEASUREMENTS, OUTPUTS)
    yield Subject("FMU, C", _bind(own_master.run, z), len(z))
    yield Subject("FMU, FMPy", _bind(Fmpy(fmus.estimator).run, rows), len(rows))
    python_master = Master(library, fmus.pythonfmu, MEASUREMENTS, OUTPUTS)
    yield Subject("PythonFMU, C", _bind(python_master.run, few), len(few))
    yield Subject("PythonFMU, FMPy", _bind(Fmpy(fmus.pythonfmu).run, rows), len(rows))


# Plant and whole runs


def plant(library: Library, fmus: Fmus, samples: int) -> Iterator[Subject]:
    """Steps of 1 ms of the AwAS with the torques of table1, held or linear over the step."""
    outputs = ("q_measured", "theta_measured", "theta_c_measured", "tau_measured", "tau_e_measured")
    t = T * np.arange(samples, dtype=np.float64)
    u = np.column_stack([signal(t) for signal in TORQUES.values()])
    for name, slopes in (("plant, held", False), ("plant, linear", True)):
        master = Master(library, fmus.plant, list(TORQUES), outputs, slopes)
        yield Subject(name, _bind(master.run, u), samples)


def table1(steps: int) -> Iterator[Subject]:
    """The scenario with one estimator, as `sigmahat` runs it, without the start of a process."""
    scenario = SCENARIOS["table1"]
    for modality in MODALITIES:
        estimators = {modality: scenario.estimators[modality]}
        yield Subject(
            f"table1 {modality}", _bind(simulate, scenario.plant, estimators, T, steps), 1, every=20
        )


def _bind(function: Callable[..., object], *arguments: Any) -> Callable[[], object]:
    return lambda: function(*arguments)
