"""The integrator of the plants, on problems with a solution in closed form."""

from __future__ import annotations

import importlib.util
import math
from pathlib import Path
from typing import Any

import casadi as ca
import cffi
import numpy as np
import pytest

from c_library import REPOSITORY, declarations
from plant_runs import Array
from sigmahat.export import plant_codegen
from sigmahat.plants.equations import PlantEquations


def problems() -> PlantEquations:
    """Independent equations, each with a known solution; see `exact`."""
    plant = PlantEquations("Problems")
    u = plant.input("u")
    stiffness = plant.parameter("stiffness")
    growth = plant.parameter("growth")
    time = plant.state("time", 0.0, scale=1.0)
    stiff = plant.state("stiff", 1.0, scale=1.0)
    logistic = plant.state("logistic", 0.25, scale=1.0)
    position = plant.state("position", 0.0, scale=1.0)
    velocity = plant.state("velocity", 1.0, scale=1.0)
    integral = plant.state("integral", 0.0, scale=1.0)
    decay = plant.state("decay", 0.0, scale=1.0)
    plant.derivative(time, ca.SX(1.0))
    plant.derivative(stiff, -stiffness * (stiff - ca.cos(time)) - ca.sin(time))
    plant.derivative(logistic, growth * logistic * (1 - logistic))
    plant.derivative(position, velocity)
    plant.derivative(velocity, -25 * position)
    plant.derivative(integral, u)
    plant.derivative(decay, -stiffness * decay)
    plant.output("time", time)
    return plant


START = np.array([0.0, 1.0, 0.25, 0.0, 1.0, 0.0, 0.0])
LOGISTIC, POSITION, VELOCITY, INTEGRAL, DECAY = 2, 3, 4, 5, 6


def exact(t: float, growth: float = 1.0) -> Array:
    return np.array(
        [
            t,
            math.cos(t),
            1 / (1 + 3 * math.exp(-growth * t)),
            math.sin(5 * t) / 5,
            math.cos(5 * t),
            0.0,
            0.0,
        ]
    )


ZERO = np.zeros(1)
MILD = np.array([1.0, 1.0])  # stiffness, growth
FAST = np.array([1.0, 4.0])
STIFF = np.array([1e6, 1.0])


class Radau:
    """fmu_src/radau.c with the equations of a plant, compiled."""

    def __init__(self, plant: PlantEquations, folder: Path) -> None:
        plant_codegen.write(
            plant, list(plant.parameters), list(plant.inputs), list(plant.outputs), folder
        )
        sources = REPOSITORY / "fmu_src"
        ffi = cffi.FFI()
        ffi.cdef(declarations(sources / "radau.h"))
        ffi.set_source(
            "radau",
            '#include "radau.h"',
            sources=[str(sources / "radau.c"), str(folder / "plant_functions.c")],
            include_dirs=[str(sources), str(folder)],
        )
        spec = importlib.util.spec_from_file_location("radau", ffi.compile(str(folder)))
        assert spec is not None and spec.loader is not None
        module: Any = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        self._ffi, self._lib = module.ffi, module.lib

    def _pointer(self, values: Array) -> Any:
        return self._ffi.cast("double *", self._ffi.from_buffer(values))

    def step(self, x: Array, h: float, p: Array, u: Array = ZERO, du: Array = ZERO) -> Any:
        x_new = np.empty_like(x)
        arguments = [self._pointer(values) for values in (x, u, du, p)]
        error = self._lib.sh_radau_step(*arguments, h, self._pointer(x_new))
        return x_new, error

    def integrate(
        self,
        x: Array,
        duration: float,
        p: Array,
        u: Array = ZERO,
        du: Array = ZERO,
        hint: float = math.inf,
    ) -> Any:
        """State after a duration, the number of steps, and the next step."""
        x, h = x.copy(), np.array([hint])
        arguments = [self._pointer(values) for values in (x, u, du, p)]
        steps = self._lib.sh_radau_integrate(*arguments, duration, self._pointer(h))
        return x, steps, h[0]


@pytest.fixture(scope="module")
def radau(tmp_path_factory: pytest.TempPathFactory) -> Radau:
    return Radau(problems(), tmp_path_factory.mktemp("radau"))


def error_after(radau: Radau, steps: int, p: Array) -> Array:
    """Error of each state at t = 1 after steps of one length."""
    x = START
    for _ in range(steps):
        x, _ = radau.step(x, 1 / steps, p)
    return np.abs(x - exact(1.0, growth=p[1]))


@pytest.mark.parametrize("state", [LOGISTIC, POSITION, VELOCITY])
def test_order_is_five(radau: Radau, state: int) -> None:
    errors = [error_after(radau, steps, FAST)[state] for steps in (8, 16, 32)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(5.0, abs=0.2)


def test_error_estimate_is_of_order_four(radau: Radau) -> None:
    estimates = [radau.step(START, h, FAST)[1] for h in (0.1, 0.05, 0.025)]
    orders = np.log2(np.array(estimates[:-1]) / estimates[1:])
    assert orders == pytest.approx(4.0, abs=0.3)


def test_a_stiff_equation_is_solved_in_steps_far_above_its_time_constant(radau: Radau) -> None:
    assert error_after(radau, 10, STIFF)[1] < 1e-9


def test_a_fast_mode_dies_in_one_step(radau: Radau) -> None:
    x = START.copy()
    x[DECAY] = 1.0
    x_new, _ = radau.step(x, 1.0, STIFF)
    assert abs(x_new[DECAY]) < 1e-5


def test_a_linear_input_is_integrated_exactly(radau: Radau) -> None:
    x, _ = radau.step(START, 0.5, MILD, np.array([3.0]), np.array([-2.0]))
    assert x[INTEGRAL] == pytest.approx(3.0 * 0.5 - 2.0 * 0.5**2 / 2, rel=1e-15)


@pytest.mark.parametrize("duration", [0.01, 1.0, 20.0])
@pytest.mark.parametrize("p", [MILD, STIFF], ids=["mild", "stiff"])
def test_steps_keep_to_the_allowed_error(radau: Radau, duration: float, p: Array) -> None:
    x, steps, _ = radau.integrate(START, duration, p)
    np.testing.assert_allclose(x, exact(duration), rtol=0, atol=1e-8)
    assert steps <= 3 + 120 * duration  # some 150 in a period of the oscillator


def test_a_step_is_proposed_that_the_next_call_can_use(radau: Radau) -> None:
    _, _, h = radau.integrate(START, 1.0, MILD)
    assert radau.integrate(exact(1.0), 0.9 * h, MILD, hint=h)[1] == 1
    assert radau.integrate(exact(1.0), 1.1 * h, MILD, hint=h)[1] == 2


def test_a_solution_that_ceases_to_exist_is_reported(radau: Radau) -> None:
    x = START.copy()
    x[LOGISTIC] = -1.0  # goes to minus infinity at t = log 2
    reached, steps, _ = radau.integrate(x, 1.0, MILD)
    assert steps == 0
    assert reached[0] == pytest.approx(math.log(2), abs=1e-6)


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_state_that_is_no_number_is_reported(radau: Radau, value: float) -> None:
    x = START.copy()
    x[POSITION] = value
    assert radau.integrate(x, 1.0, MILD)[1] == 0
