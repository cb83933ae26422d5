"""Code generation of the plants."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from sigmahat.export import plant_codegen
from sigmahat.export.plant_codegen import Elimination
from sigmahat.plants.equations import PlantEquations


@pytest.mark.parametrize("seed", range(20))
def test_elimination_solves_sparse_systems(seed: int) -> None:
    rng = np.random.default_rng(seed)
    size = int(rng.integers(1, 12))
    values = rng.normal(size=(size, size)) * (rng.random((size, size)) < 0.3)
    np.fill_diagonal(values, size)
    sparse = ca.SX.sym("A", ca.sparsify(values).sparsity())
    b = ca.SX.sym("b", size)
    elimination = Elimination(sparse)
    factors = ca.SX.sym("factors", elimination.factors.size1())
    factorize = ca.Function("factorize", [sparse], [elimination.factors])
    solve = ca.Function("solve", [factors, b], [elimination.solve(factors, b)])
    right = rng.normal(size=size)
    x = np.array(solve(factorize(ca.sparsify(values)), right)).ravel()
    np.testing.assert_allclose(x, np.linalg.solve(values, right), rtol=1e-12, atol=1e-13)


def test_code_is_the_same_in_every_process(tmp_path: Path) -> None:
    texts = []
    for seed in ("1", "2"):
        subprocess.run(
            [sys.executable, "-m", "sigmahat.export.plant_codegen", "AwasPlant", tmp_path / seed],
            check=True,
            env={**os.environ, "PYTHONHASHSEED": seed},
        )
        names = ("plant_functions.c", "plant_functions.h")
        texts.append([(tmp_path / seed / name).read_text() for name in names])
    assert texts[0] == texts[1]
    assert str(tmp_path) not in "".join(texts[0])


def mass() -> PlantEquations:
    plant = PlantEquations("MassPlant")
    force = plant.input("force")
    m = plant.parameter("mass")
    x = plant.state("x", start=0.0, scale=1.0)
    v = plant.state("v", start=plant.parameter("initial.v"), scale=1.0)
    plant.derivative(x, v)
    plant.derivative(v, force / m)
    plant.output("x", x + plant.noise(ca.SX(4.0)))
    return plant


def test_functions_take_variables_in_the_order_asked_for() -> None:
    by_name = {
        function.name(): function
        for function in plant_codegen.functions(mass(), ["initial.v", "mass"], ["force"], ["x"])
    }
    p = [7.0, 2.0]
    assert by_name["sh_plant_start"](p).full().ravel().tolist() == [0.0, 7.0]
    assert by_name["sh_plant_xdot"]([1.0, 3.0], 8.0, p).full().ravel().tolist() == [3.0, 4.0]
    assert float(by_name["sh_plant_outputs"]([1.0, 3.0], 8.0, p, 0.5)) == 1.0 + 2 * 0.5


def test_a_state_needs_its_derivative() -> None:
    plant = mass()
    plant.state("forgotten", start=0.0, scale=1.0)
    with pytest.raises(ValueError, match="no derivative of state forgotten"):
        plant_codegen.functions(plant, ["mass", "initial.v"], ["force"], ["x"])


def test_declarations_that_contradict_each_other() -> None:
    plant = mass()
    x = next(iter(plant.states.values())).symbol
    with pytest.raises(ValueError, match="force is declared twice"):
        plant.parameter("force")
    with pytest.raises(ValueError, match="state x is declared twice"):
        plant.state("x", start=0.0, scale=1.0)
    with pytest.raises(ValueError, match="derivative of x is given twice"):
        plant.derivative(x, x)
    with pytest.raises(ValueError, match="output x is given twice"):
        plant.output("x", x)
    with pytest.raises(ValueError, match="force is not a state"):
        plant.derivative(plant.inputs["force"], x)
    with pytest.raises(ValueError, match=r"scale = 0\.0; expected a finite number above 0"):
        plant.state("y", start=0.0, scale=0.0)
