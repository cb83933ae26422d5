"""Code generation of the plants."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import casadi as ca
import pytest

from sigmahat.export import plant_codegen
from sigmahat.plants.equations import PlantEquations


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
