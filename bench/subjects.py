"""Creates the benchmark subjects. Each subject repeats the same work on the same inputs."""

import ctypes
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import fmpy
import numpy as np
from numpy.typing import NDArray

import sigmahat
from sigmahat.experiments.scenario import Sine, T
from sigmahat.fmi.instance import Fmu, Slave, installed
from sigmahat.fmi.master import simulate
from sigmahat.fmi.sample_loop import SampleLoop, step_times
from sigmahat.paper.scenarios import SCENARIOS

Array = NDArray[np.float64]

SIZES = (3, 6, 18, 40)
MAKES = ("sigmahat", "eigen")
"""Recursions that compute an estimate."""
JOINTS = 30
P_0 = 1e3
METHODS = ("Paper2011", "FilteredRegression", "FilteredRegression, 21 columns")
MEASUREMENTS = ("theta", "q", "theta_c", "tau", "tau_e_sensor")
MEASURED = [f"{name}_measured" for name in ("theta", "q", "theta_c", "tau", "tau_e")]
"""Outputs of the plant that the estimator measures."""
OUTPUTS = ("sigma", "tau_e", "theta_dot")
TORQUES = {"tau": Sine(0.3, 0.1), "tau_c": Sine(8.0, 0.1)}
"""Torques of the motors in the scenario table1."""


@dataclass(frozen=True)
class Subject:
    """A benchmark subject: a unit of work whose time is measured."""

    name: str
    batch: Callable[[], object]
    """Function that does the unit of work `count` times."""
    count: int
    every: int = 1
    """Distance of the rounds in which the subject runs."""


def doubles(array: Array) -> Any:
    """Returns a pointer to a contiguous array, which is valid only as long as the array exists."""
    assert array.flags.c_contiguous and array.dtype == np.float64
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


class Native:
    """An object of the shared library that processes samples, with its last outputs."""

    def __init__(
        self, library: ctypes.CDLL, kind: str, outputs: int, maker: str, *arguments: Any
    ) -> None:
        """Creates the object by <maker>_start. Raises RuntimeError for refused arguments."""
        start, self._run = library[f"{maker}_start"], library[f"{kind}_run"]
        start.restype = ctypes.c_void_p
        self._state = ctypes.c_void_p(start(*arguments))
        if not self._state:
            raise RuntimeError(f"{maker}_start{arguments} refused")
        self.outputs = np.zeros(outputs)

    def run(self, *samples: Array) -> None:
        self._run(self._state, *map(doubles, samples), len(samples[0]), doubles(self.outputs))


# Least squares


def regression(size: int, samples: int) -> tuple[Array, Array]:
    """Returns regressors F and outputs y of a filter with `size` taps, white noise as input.

    The regressor is a delay line: F(k) = (x(k), x(k-1), ...).
    """
    random = np.random.default_rng(size)
    x = random.standard_normal(samples + size - 1)
    F = np.lib.stride_tricks.sliding_window_view(x, size)[:, ::-1]
    y = F @ random.standard_normal(size) + 0.01 * random.standard_normal(samples)
    return np.ascontiguousarray(F), y


def recursion(library: ctypes.CDLL, make: str, size: int) -> Native:
    """Creates recursive least squares by one of MAKES, or an update of the covariance only."""
    return Native(library, "recursion", size, make, size, ctypes.c_double(P_0))


def least_squares(library: ctypes.CDLL, size: int, samples: int) -> Iterator[Subject]:
    """Yields all recursions, and as the reference an update of the covariance only."""
    data = regression(size, samples)
    for make in (*MAKES, "covariance"):
        yield Subject(f"{make} {size}", partial(recursion(library, make, size).run, *data), samples)


# Ticks


def measurements(samples: int) -> Array:
    """Simulates the first measurements of the scenario table1 [size: samples x 5]."""
    plant = replace(SCENARIOS["table1"].plant, record=MEASURED)
    run = simulate(plant, {}, T, samples - 1)
    return np.column_stack([run.plant[name] for name in MEASURED])


def tick(library: ctypes.CDLL, method: str) -> Native:
    """Creates the estimator of the C library, which is called without an FMU."""
    return Native(library, "tick", len(OUTPUTS), "tick", method.encode())


class Steps:
    """An FMU in the sample loop of the package, with one step for each row of inputs."""

    def __init__(
        self,
        fmu: Fmu,
        inputs: Iterable[str],
        outputs: Sequence[str],
        u: Array,
        slopes: bool = False,
    ) -> None:
        """slopes: inputs are linear in a step instead of constant."""
        slave = Slave(fmu, "bench")
        slave.initialize({})
        references = fmu.references(inputs, "input")
        self.outputs, self.count = np.empty(len(outputs)), len(u)
        self._times = step_times(T * np.arange(len(u), dtype=np.float64), T)
        self._loop = SampleLoop()
        self._loop.set_real(slave, references, u)
        if slopes:
            self._loop.set_slopes(slave, references, np.diff(u, axis=0, append=u[-1:]) / T)
        self._loop.step(slave, self._times)
        self._loop.get(slave, "Real", fmu.references(outputs), self.outputs)

    def run(self) -> None:
        """Makes one step for each row, beginning at the present time of the FMU."""
        self._loop.run(0, self.count)
        self._times[:, 0] += self.count * T


def ticks(library: ctypes.CDLL, z: Array) -> Iterator[Subject]:
    """Yields the tick of the estimator in the C library, and the same tick in the FMU."""
    for method in METHODS:
        yield Subject(f"tick {method}", partial(tick(library, method).run, z), len(z))
    fmu = installed("StiffnessEstimator")
    yield Subject("FMU", Steps(fmu, MEASUREMENTS, OUTPUTS, z).run, len(z))


# Plant and whole runs


def plant(samples: int) -> Iterator[Subject]:
    """Yields steps of 1 ms of the AwAS plant, with constant and with linear torques in a step."""
    t = T * np.arange(samples, dtype=np.float64)
    u = np.column_stack([signal(t) for signal in TORQUES.values()])
    for name, slopes in (("plant, held", False), ("plant, linear", True)):
        steps = Steps(installed("AwasPlant"), TORQUES, MEASURED, u, slopes)
        yield Subject(name, steps.run, samples)


def objects(z: Array) -> Iterator[Subject]:
    """Yields sigmahat.Estimator on arrays: of one joint, and of many joints."""
    columns = dict(zip(MEASUREMENTS, np.ascontiguousarray(z.T), strict=True))
    one = sigmahat.Estimator({}, OUTPUTS)
    yield Subject("Estimator.run", lambda: one.run(**columns), len(z))
    short = {name: np.tile(each[: len(z) // 10], (JOINTS, 1)) for name, each in columns.items()}
    many = sigmahat.Estimator([{}] * JOINTS, OUTPUTS)
    count = JOINTS * (len(z) // 10)
    yield Subject(f"Estimator.run, {JOINTS} joints", lambda: many.run(**short), count)


def whole(z: Array) -> Iterator[Subject]:
    """Yields complete simulations of the estimator FMU, start and end included: FMPy and ours."""
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
    # The FMU is used as a plant, so that the measurements are its inputs.
    inputs = {name: partial(_recorded, rows[name]) for name in MEASUREMENTS}
    plant = sigmahat.Plant(str(path), {}, inputs, OUTPUTS)
    yield Subject(
        "simulate of sigmahat",
        lambda: sigmahat.simulate(plant, {}, T, len(z) - 1),
        len(z),
        every=5,
    )


def table1(steps: int) -> Subject:
    """Creates the scenario table1 with one estimator, as `sigmahat` runs it in its process."""
    scenario = SCENARIOS["table1"]
    estimators = {"RESIDUAL": scenario.estimators["RESIDUAL"]}
    run = partial(simulate, scenario.plant, estimators, T, steps)
    return Subject("table1 RESIDUAL", run, 1, every=20)


def _recorded(values: Array, _t: Array) -> Array:
    return values
