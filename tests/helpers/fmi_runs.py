"""Runs of any FMU through its C interface, whose results can be compared bit for bit."""

from __future__ import annotations

import ctypes
import math
import random
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from fmi_instance import OK, Instance

ESTIMATORS = ["StiffnessEstimator", "AntagonisticStiffnessEstimator"]
PLANTS = ["AwasPlant", "FlexibleJointPlant", "AntagonisticVsaPlant", "RealJointPlant"]

# Inputs of the FMUs as functions of time: measurements that excite all parameters, and torques.
SIGNALS: dict[str, Callable[[float], float]] = {
    "theta": lambda t: 0.5 * math.sin(9 * t),
    "theta_1": lambda t: 0.5 * math.sin(9 * t) + 0.02,
    "theta_2": lambda t: 0.5 * math.sin(9 * t) - 0.02 * math.cos(5 * t),
    "q": lambda t: 0.5 * math.sin(9 * t) + 0.01 * math.sin(13 * t),
    "theta_c": lambda t: 20 * math.sin(3 * t),
    "tau": lambda t: 0.3 * math.cos(9 * t),
    "tau_1": lambda t: 0.3 * math.cos(9 * t),
    "tau_2": lambda t: 0.2 * math.cos(11 * t),
    "tau_c": lambda t: 8 * math.sin(3 * t),
    "tau_ext": lambda t: 0.1 * math.cos(7 * t),
    "r": lambda t: 0.07 + 0.01 * math.sin(3 * t),
    "D_theta_change": lambda t: -0.2 * t,
    "tau_coulomb_change": lambda t: 0.3 * t,
    "tau_e_sensor": lambda t: 2 * math.sin(13 * t),
    "tau_e_sensor_1": lambda t: 2 * math.sin(13 * t),
    "tau_e_sensor_2": lambda t: 1.5 * math.sin(12 * t),
}


def names(fmu: Any, causality: str, variability: str | None = None) -> list[str]:
    """Names of the variables with a causality and, if given, a variability, in their order."""
    return [
        name
        for name, variable in fmu.variables.items()
        if variable.causality == causality and variability in (None, variable.variability)
    ]


def random_steps(count: int, seed: int) -> list[tuple[float, float]]:
    """Communication points and step sizes [s] of successive steps, from 0.1 ms to 4 ms."""
    source = random.Random(seed)
    t, steps = 0.0, []
    for _ in range(count):
        h = source.choice([1e-3, 1e-3, source.uniform(1e-4, 4e-3)])
        steps.append((t, h))
        t += h
    return steps


class Driver:
    """Steps an instance with the inputs SIGNALS. In some steps they are linear, in others held."""

    def __init__(self, fmu: Instance) -> None:
        self.fmu = fmu
        self.inputs = names(fmu, "input")
        self.outputs = [n for n in names(fmu, "output") if fmu.variables[n].type == "Real"]
        self._to = fmu.references(self.inputs)
        self._from = fmu.references(self.outputs)
        self._orders = (ctypes.c_int * len(self.inputs))(*[1] * len(self.inputs))

    def step(self, t: float, h: float) -> bytes:
        """Makes one step. Returns all Real outputs after it, as bytes."""
        fmu, count = self.fmu, ctypes.c_size_t(len(self.inputs))
        reals = ctypes.c_double * len(self.inputs)
        now = [SIGNALS[name](t) for name in self.inputs]
        assert fmu.call("fmi2SetReal", self._to, count, reals(*now)) == OK
        if int(t * 1e4) % 2:
            slopes = [(SIGNALS[n](t + h) - u) / h for n, u in zip(self.inputs, now, strict=True)]
            status = fmu.call(
                "fmi2SetRealInputDerivatives", self._to, count, self._orders, reals(*slopes)
            )
            assert status == OK
        assert fmu.step(t, h) == OK, fmu.messages
        return self.result()

    def result(self) -> bytes:
        """All Real outputs, as bytes."""
        values = (ctypes.c_double * len(self.outputs))()
        count = ctypes.c_size_t(len(self.outputs))
        assert self.fmu.call("fmi2GetReal", self._from, count, values) == OK
        return bytes(values)

    def run(self, steps: Iterable[tuple[float, float]]) -> list[bytes]:
        return [self.step(t, h) for t, h in steps]


def continue_from(
    path: Path,
    states: Sequence[bytes],
    rests: Sequence[Sequence[tuple[float, float]]],
    instance: Callable[[Path], Any] = Instance,
    driven: Callable[[Any], Any] = Driver,
) -> list[list[bytes]]:
    """Continues from serialised states in a new instance. Returns the outputs of each run."""
    results = []
    with instance(path) as fmu:
        driver = driven(fmu)
        for data, rest in zip(states, rests, strict=True):
            status, state = fmu.deserialise(data)
            assert status == OK and fmu.restore(state) == OK, fmu.messages
            fmu.free(state)
            results.append(driver.run(rest))
    return results
