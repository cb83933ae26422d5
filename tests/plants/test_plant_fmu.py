"""Tests of the FMU of a user-defined plant."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmu_manipulation_toolbox.cli.fmutool import fmutool

import sigmahat
from sigmahat import PlantEquations, PlantVariable, encoder, write_plant_fmu
from sigmahat.plant_fmu import plant_codegen

VARIABLES = {
    "force": PlantVariable("N.m", "Torque"),
    "mass": PlantVariable("kg.m2", "Inertia", 2.0),
    "initial.x": PlantVariable("rad", "Position at the start", 0.5),
    "variance": PlantVariable("N2.m2", "Of the noise", 1e-2),
    "x": PlantVariable("rad", "Position"),
    "counted": PlantVariable("rad", "Position through an encoder of 100 counts"),
    "measured": PlantVariable("N.m", "Torque with noise"),
}


def mass() -> PlantEquations:
    plant = PlantEquations("MassPlant")
    force = plant.input("force")
    x = plant.state("x", start=plant.parameter("initial.x"), scale=1.0)
    v = plant.state("v", start=0.0, scale=1.0)
    plant.derivative(x, v)
    plant.derivative(v, force / plant.parameter("mass"))
    plant.output("x", x)
    plant.output("counted", encoder(x, 100))
    plant.output("measured", force + plant.noise(plant.parameter("variance")))
    return plant


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("plant") / "in" / "MassPlant.fmu"
    write_plant_fmu(mass(), VARIABLES, path)
    return path


def run(fmu: Path, seed: int) -> sigmahat.Series:
    plant = sigmahat.Plant(
        fmu=str(fmu),
        start={"mass": 4.0, "noise.seed": seed, "noise.samplePeriod": 1e-2},
        inputs={"force": lambda t: 0 * t + 2.0},
        record=["x", "counted", "measured"],
    )
    return sigmahat.simulate(plant, {}, T=1e-2, steps=500).plant


def test_moves_as_newton_says(fmu: Path) -> None:
    series = run(fmu, seed=1)
    t = 1e-2 * np.arange(501)
    np.testing.assert_allclose(series["x"], 0.5 + 2.0 / 4.0 * t**2 / 2, rtol=1e-9)
    count = 2 * np.pi / 100
    np.testing.assert_allclose(series["counted"], count * np.round(series["x"] / count), rtol=1e-9)


def test_noise_is_that_of_the_seed(fmu: Path) -> None:
    first, again, other = (run(fmu, seed)["measured"][1:] - 2.0 for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert not np.any(first == other)
    assert np.std(first) == pytest.approx(0.1, rel=0.15)  # with 500 samples, the error is 3 %


def test_description_says_what_the_equations_are(fmu: Path) -> None:
    description = fmpy.read_model_description(str(fmu))
    variables = {v.name: v for v in description.modelVariables}
    assert set(variables) == {*VARIABLES, "noise.seed", "noise.samplePeriod"}
    for name, variable in VARIABLES.items():
        assert variables[name].unit == variable.unit
        assert variables[name].description == variable.description
    expected = {
        "continuous": {"force", "x"},
        "tunable": {"mass", "variance"},
        "fixed": {"initial.x", "noise.seed", "noise.samplePeriod"},
        "discrete": {"counted", "measured"},
    }
    for variability, names in expected.items():
        assert {n for n, v in variables.items() if v.variability == variability} == names
    unknowns = {
        u.variable.name: {d.name for d in u.dependencies} for u in description.initialUnknowns
    }
    assert unknowns == {
        "x": {"initial.x"},
        "counted": {"initial.x"},
        "measured": {"force", "variance", "noise.seed"},
    }


def test_is_within_the_rules(
    fmu: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["fmutool", "-input", str(fmu), "-check"])
    fmutool()
    assert "No semantic error against the FMI-2 standard." in "".join(capsys.readouterr())


def test_brings_its_sources(fmu: Path, tmp_path: Path) -> None:
    """FMPy can compile a binary for another machine from the sources in the FMU."""
    folder = Path(fmpy.extract(str(fmu), unzipdir=str(tmp_path)))
    assert (folder / "sources" / "plant_functions.c").is_file()
    xml = (folder / "modelDescription.xml").read_text(encoding="utf-8")
    assert "AwasPlant" not in xml
    listed = {path.stem for path in (folder / "binaries" / fmpy.platform).iterdir()}
    assert listed == {"MassPlant"}


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"mass": None}, "expected an entry for parameter mass"),
        ({"mas": VARIABLES["mass"]}, "unknown variable of MassPlant 'mas'; did you mean 'mass'"),
        ({"mass": PlantVariable("kg.m", "?")}, r"MassPlant\.mass: unknown unit 'kg\.m'.*kg\.m2"),
    ],
)
def test_variables_that_do_not_fit(
    changed: dict[str, PlantVariable | None], message: str, tmp_path: Path
) -> None:
    others = {name: each for name, each in {**VARIABLES, **changed}.items() if each is not None}
    with pytest.raises(ValueError, match=message):
        write_plant_fmu(mass(), others, tmp_path / "x.fmu")


@pytest.mark.parametrize("name", ["noise.seed", "noise.samplePeriod", "signal.tau.amplitude"])
def test_a_parameter_whose_name_is_taken(name: str, tmp_path: Path) -> None:
    plant = mass()
    plant.parameter(name)
    more = {**VARIABLES, name: PlantVariable("1", "Something else")}
    with pytest.raises(ValueError, match=f"every plant has {name}; rename this parameter"):
        write_plant_fmu(plant, more, tmp_path / "x.fmu")


def test_a_compiler_that_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(RuntimeError, match="no C compiler found"):
        write_plant_fmu(mass(), VARIABLES, tmp_path / "x.fmu")
    monkeypatch.setenv("CC", "no-such-compiler -O2")
    with pytest.raises(RuntimeError, match="CC=no-such-compiler -O2: No such file"):
        write_plant_fmu(mass(), VARIABLES, tmp_path / "x.fmu")
    assert not (tmp_path / "x.fmu").exists()


# Generation of the C code of a plant


def test_code_is_the_same_in_every_process(tmp_path: Path) -> None:
    texts, template = [], Path(__file__).parents[2] / "modelDescription" / "AwasPlant.xml"
    for seed in ("1", "2"):
        command = [sys.executable, "-m", "sigmahat_build", "equations"]
        environment = {**os.environ, "PYTHONHASHSEED": seed}
        subprocess.run([*command, template, tmp_path / seed], check=True, env=environment)
        names = ("plant_functions.c", "plant_functions.h")
        texts.append([(tmp_path / seed / name).read_text() for name in names])
    assert texts[0] == texts[1]
    assert str(tmp_path) not in "".join(texts[0])


def test_a_state_needs_its_derivative() -> None:
    plant = mass()
    plant.state("forgotten", start=0.0, scale=1.0)
    parameters = ["mass", "initial.x", "variance"]
    with pytest.raises(ValueError, match="no derivative of state forgotten"):
        plant_codegen.functions(plant, parameters, ["force"], ["x", "counted", "measured"])


def test_declarations_that_contradict_each_other() -> None:
    plant = mass()
    x, force = next(iter(plant.states.values())).symbol, plant.inputs["force"]
    wrong: list[tuple[str, Callable[[], object]]] = [
        ("force is declared twice", lambda: plant.parameter("force")),
        ("state x is declared twice", lambda: plant.state("x", start=0.0, scale=1.0)),
        ("derivative of x is given twice", lambda: plant.derivative(x, x)),
        ("output x is given twice", lambda: plant.output("x", x)),
        ("force is not a state", lambda: plant.derivative(force, x)),
        (r"finite scale above 0, got 0\.0", lambda: plant.state("y", start=0.0, scale=0.0)),
    ]
    for message, declare in wrong:
        with pytest.raises(ValueError, match=message):
            declare()
