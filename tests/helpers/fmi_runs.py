"""Runs of any FMU through its C interface, whose results can be compared bit for bit."""

import ctypes
import math
import random
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import sigmahat
from fmi_instance import OK, REAL, SIZE, Instance, Instance3

ESTIMATORS = ["StiffnessEstimator", "AntagonisticStiffnessEstimator"]
PLANTS = ["AwasPlant", "FlexibleJointPlant", "AntagonisticVsaPlant", "RealJointPlant"]

OTHER_THAN_0 = {
    **{"1": 0.2, "1/s": 1.0, "s": 1e-3, "m": 0.05, "rad": 2e-4, "rad/s": 0.1, "N/m": 1e4},
    **{"N.m": 0.02, "N.m/rad": 50.0, "N.m/rad3": 1e4, "N.m.s/rad": 10.0},
}
"""Values for parameters that are 0 at the start, by unit; each value has an effect."""

# Inputs of the FMUs as functions of time: measurements that excite all parameters, and torques.
SIGNALS: dict[str, Callable[[float], float]] = {
    **dict.fromkeys(("tau_e_sensor", "tau_e_sensor_1"), lambda t: 2 * math.sin(13 * t)),
    **dict.fromkeys(("tau", "tau_1"), lambda t: 0.3 * math.cos(9 * t)),
    "theta": lambda t: 0.5 * math.sin(9 * t),
    "theta_1": lambda t: 0.5 * math.sin(9 * t) + 0.02,
    "theta_2": lambda t: 0.5 * math.sin(9 * t) - 0.02 * math.cos(5 * t),
    "q": lambda t: 0.5 * math.sin(9 * t) + 0.01 * math.sin(13 * t),
    "theta_c": lambda t: 20 * math.sin(3 * t),
    "tau_2": lambda t: 0.2 * math.cos(11 * t),
    "tau_c": lambda t: 8 * math.sin(3 * t),
    "tau_ext": lambda t: 0.1 * math.cos(7 * t),
    "r": lambda t: 0.07 + 0.01 * math.sin(3 * t),
    "D_theta_change": lambda t: -0.2 * t,
    "tau_coulomb_change": lambda t: 0.3 * t,
    "tau_e_sensor_2": lambda t: 1.5 * math.sin(12 * t),
}


def names(fmu: Any, causality: str, variability: str | None = None) -> list[str]:
    """Names of the variables with a causality and, if given, a variability, in their order."""
    return [
        name
        for name, variable in fmu.variables.items()
        if variable.causality == causality and variability in (None, variable.variability)
    ]


def limits(variable: Any) -> Iterator[tuple[str, float, float]]:
    """For a parameter: name of the limit, the limit, and the next value outside."""
    lowest, highest = variable.min, variable.max
    if variable.type == "Enumeration":
        values = [item.value for item in variable.declaredType.items]
        lowest, highest = values[0], values[-1]
    for which, limit, outward in (("min", lowest, -math.inf), ("max", highest, math.inf)):
        if variable.type in ("Real", "Float64"):
            real = float(outward if limit is None else limit)
            yield which, real, math.nextafter(real, outward)
        elif limit is not None:
            yield which, int(limit), int(limit) + int(math.copysign(1, outward))


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
    """Steps an instance with the inputs SIGNALS, and gives all Real outputs as bytes.

    In FMI 2.0, inputs are linear in some steps and held in the others, or always held.
    """

    def __init__(self, fmu: Any, held: bool = False) -> None:
        self.fmu, self.held = fmu, held or isinstance(fmu, Instance3)
        self.inputs = names(fmu, "input")
        reals = ("Real", "Float64")
        self.outputs = [n for n in names(fmu, "output") if fmu.variables[n].type in reals]
        self._to, self._from = fmu.references(self.inputs), fmu.references(self.outputs)

    def step(self, t: float, h: float) -> bytes:
        """Makes one step. Returns the outputs after it."""
        fmu, count = self.fmu, len(self.inputs)
        now = [SIGNALS[name](t) for name in self.inputs]
        assert fmu.access(f"Set{fmu.real}", self._to, (REAL * count)(*now)) == OK
        if not self.held and int(t * 1e4) % 2:
            slopes = [(SIGNALS[n](t + h) - u) / h for n, u in zip(self.inputs, now, strict=True)]
            orders = (ctypes.c_int * count)(*[1] * count)
            values = (REAL * count)(*slopes)
            assert fmu.call("SetRealInputDerivatives", self._to, SIZE(count), orders, values) == OK
        assert fmu.step(t, h) == OK, fmu.messages
        return self.result()

    def result(self) -> bytes:
        values = (REAL * len(self.outputs))()
        assert self.fmu.access(f"Get{self.fmu.real}", self._from, values) == OK
        return bytes(values)

    def run(self, steps: Iterable[tuple[float, float]]) -> list[bytes]:
        return [self.step(t, h) for t, h in steps]


@dataclass(frozen=True)
class Fmi:
    """A version of FMI: a function that makes an instance of the FMU with a given name."""

    kind: type[Instance] | type[Instance3]
    path: Callable[[str], Path]

    def __call__(self, fmu: str = "StiffnessEstimator", /, **options: Any) -> Any:
        return self.kind(self.path(fmu), **options)


FMI2 = Fmi(Instance, sigmahat.fmu)


def continue_from(
    kind: type[Any],
    path: Path,
    states: Sequence[bytes],
    rests: Sequence[Sequence[tuple[float, float]]],
) -> list[list[bytes]]:
    """Continues from serialised states in a new instance. Returns the outputs of each run."""
    results = []
    with kind(path) as fmu:
        driver = Driver(fmu)
        for data, rest in zip(states, rests, strict=True):
            status, state = fmu.deserialise(data)
            assert status == OK and fmu.restore(state) == OK, fmu.messages
            fmu.free(state)
            results.append(driver.run(rest))
    return results
