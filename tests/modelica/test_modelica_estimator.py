"""The C of the Modelica package, called as by a tool: the numbers of sigmahat.Estimator."""

from __future__ import annotations

import math
import re
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
import pytest
from numpy.typing import NDArray

import sigmahat
from gate import need
from modelica_calls import INPUTS, calls, constructor_arguments, outputs
from modelica_package import FILES, classes, external_arguments
from recordings import one_seed
from sigmahat.export.templates import render
from sigmahat.fmi.master import Plant, simulate

DRIVERS = Path(__file__).parents[1] / "drivers" / "modelica"
REPOSITORY = Path(__file__).parents[2]
FLAGS = ["-std=c99", "-O2", "-ffp-contract=off"]
WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]
T, N = 1e-3, 3000
NAMES = ("new", "tick", "free")


@pytest.fixture(scope="module")
def c_sources(build: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the C sources, from the archive."""
    folder = tmp_path_factory.mktemp("package")
    with ZipFile(build / "release" / "sigmahat-modelica.zip") as archive:
        archive.extractall(folder)
    (sources,) = folder.glob("*/Resources/C-Sources")
    return sources


def gcc(*arguments: str | Path) -> None:
    """Runs the compiler, with all warnings as errors."""
    command = [need("gcc"), *FLAGS, *WARNINGS, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def unit(folder: Path, c_sources: Path, text: str, *flags: str) -> Path:
    """The object file of a translation unit with this text."""
    source = Path(tempfile.mkdtemp(dir=folder)) / "unit.c"
    source.write_text(text)
    gcc(*flags, f"-I{c_sources}", f"-I{DRIVERS}", "-c", source, "-o", source.with_suffix(".o"))
    return source.with_suffix(".o")


@pytest.fixture(scope="module")
def objects(c_sources: Path, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Each external function of the estimator in a translation unit of its own."""
    folder = tmp_path_factory.mktemp("objects")
    return [unit(folder, c_sources, text) for text in includes()]


def includes() -> list[str]:
    """The annotations Include of the functions of the estimator."""
    text = "".join(file.read_text(encoding="utf-8") for file in FILES)
    found = re.findall(r'Include="(#include \\"sigmahat_estimator.+?)"[,)]', text)
    assert len(found) == len(NAMES)
    return [each.replace("\\", "") + "\n" for each in found]


def items() -> dict[str, dict[str, int]]:
    """Numbers of the items of each enumeration."""
    template = REPOSITORY / "modelDescription" / "StiffnessEstimator.xml"
    types = render(template, sigmahat.__version__).findall("TypeDefinitions/SimpleType")
    return {
        str(each.get("name")): {
            str(item.get("name")): int(str(item.get("value"))) for item in each.iterfind(".//Item")
        }
        for each in types
    }


CHOICES = {
    "method": "Method",
    "modality": "Modality",
    "deformation": "Deformation",
    "filter.kind": "FilterKind",
    "filter.weighting": "Weighting",
    "rls.kind": "RlsKind",
}


def numbers(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Parameters with enumerations and Booleans as their numbers in C."""
    declared = items()
    named = {
        name: declared[CHOICES[name]][value] if isinstance(value, str) else value
        for name, value in parameters.items()
    }
    return {name: int(v) if isinstance(v, bool) else v for name, v in named.items()}


SETTINGS: list[dict[str, Any]] = [
    {},
    {"method": "FilteredRegression"},
    {
        "modality": "Sensor",
        "deformation": "Filtered",
        "filter.kind": "Kalman",
        "filter.weighting": "AsPrinted",
        "rls.kind": "ConstantFactor",
        "rls.symmetric": False,
        "torque.held": True,
    },
    {
        "method": "FilteredRegression",
        "modality": "Model",
        "torque.held": True,
        "rls.n": 3,
        "rls.m": 2,
    },
]


def otherwise(setting: Mapping[str, Any]) -> dict[str, Any]:
    """All parameters of the block; the reals are not those of the start, each by its own factor."""
    start = dict(sigmahat.Estimator().parameters[0])
    start.pop("encoder.theta_c")  # it is not in the block, as it has no effect
    changed: dict[str, Any] = {}
    for number, (name, value) in enumerate(start.items()):
        if isinstance(value, float) and name != "samplePeriod":
            changed[name] = (value or 1e-3) * (1 + 0.02 * math.sin(number))
        else:
            changed[name] = value
    return {**changed, **setting}


@pytest.fixture(scope="module")
def samples() -> NDArray[np.float64]:
    """Time and inputs of table1, a sample that is not finite among them."""
    plant = one_seed("table1").recording.plant
    columns = [plant[f"{n}_measured"][:N] for n in ("theta", "q", "theta_c", "tau", "tau_e")]
    z = np.column_stack([T * np.arange(N), *columns])
    z[2000, 2] = np.nan
    return z


def run(program: Path, samples: NDArray[np.float64], *arguments: str) -> dict[str, NDArray[Any]]:
    done = subprocess.run([program, *arguments], input=samples.tobytes(), capture_output=True)
    assert done.returncode == 0, done.stderr
    table = np.frombuffer(done.stdout).reshape(len(samples), -1)
    found, column = {}, 0
    for name, (_, size) in outputs().items():
        found[name] = table[:, column : column + size]
        column += size
    assert column == table.shape[1]
    return found


def in_python(samples: NDArray[np.float64], start: Mapping[str, Any]) -> dict[str, NDArray[Any]]:
    names = [name for name in outputs() if name != "eta"]
    eta = [f"eta[{i},{j}]" for i in range(8) for j in range(5)]
    estimator = sigmahat.Estimator(start, record=[*names, *eta])
    found = estimator.run(**dict(zip(INPUTS, samples[:, 1:].T, strict=True)))
    doubt = items()["Doubt"]
    columns = {name: np.asarray(found[name]) for name in names}
    columns["doubt"] = np.array([doubt[name] for name in columns["doubt"]])
    columns = {name: column[:, None] for name, column in columns.items()}
    return {**columns, "eta": np.column_stack([found[name] for name in eta])}


def tool(folder: Path, objects: list[Path], parameters: Mapping[str, Any], *flags: str) -> Path:
    """The program drivers/modelica/tool.c for these parameters."""
    eta_0 = np.array([[parameters[f"rls.eta_0[{i},{j}]"] for j in range(5)] for i in range(8)])
    (folder / "calls.h").write_text(calls(numbers(parameters), eta_0))
    program = folder / "tool"
    gcc(*flags, f"-I{folder}", f"-I{DRIVERS}", DRIVERS / "tool.c", *objects, "-lm", "-o", program)
    return program


@pytest.mark.parametrize(
    "setting", SETTINGS, ids=["default", "regression", "sensor", "regression-model"]
)
def test_the_outputs_are_those_of_the_library_to_the_last_bit(
    setting: dict[str, Any], samples: NDArray[np.float64], objects: list[Path], tmp_path: Path
) -> None:
    """Each parameter has a value of its own, so that none takes the place of another."""
    parameters = otherwise(setting)
    found = run(tool(tmp_path, objects, parameters), samples)
    expected = in_python(samples, parameters)
    for name, column in found.items():
        np.testing.assert_array_equal(column, expected[name], err_msg=name)
    assert found["valid"].sum() == N - 1 and np.ptp(found["sigma"]) > 1


def test_a_second_tick_at_the_same_time_replaces_the_first(
    samples: NDArray[np.float64], objects: list[Path], tmp_path: Path
) -> None:
    program = tool(tmp_path, objects, otherwise({}))
    once, twice = run(program, samples), run(program, samples, "twice")
    for name, column in once.items():
        np.testing.assert_array_equal(column, twice[name], err_msg=name)


def test_all_in_one_file_they_compile_too(c_sources: Path, tmp_path: Path) -> None:
    """A tool may put all external functions into one file, each Include once or several times."""
    text = "".join(includes()) * 2 + '#include "sigmahat_noise.c"\n'
    tool(tmp_path, [unit(tmp_path, c_sources, text)], otherwise({}))


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"motor.gamma": 0.0}, "parameter motor.gamma = 0 is out of its range: finite and not 0."),
        ({"noise.tau": 2e12}, "parameter noise.tau = 2e+12 is out of its range: 1e-12 to 1e12."),
        ({"model.k_s": -2.0}, "parameter nominal.k_s = -2 is out of its range: >= 0."),
        ({"rls.n": 9}, "parameter rls.n = 9 is out of its range: 1 to 8."),
    ],
)
def test_a_parameter_out_of_its_range_is_an_error_of_the_model(
    wrong: dict[str, Any], message: str, objects: list[Path], tmp_path: Path
) -> None:
    program = tool(tmp_path, objects, {**otherwise({}), **wrong})
    done = subprocess.run([program], input=b"", capture_output=True, text=False)
    assert (done.returncode, done.stdout) == (3, b"")
    assert done.stderr.decode() == f"StiffnessEstimator: {message}\n"


def test_skipped_ticks_and_too_large_deformations_are_told_once(
    samples: NDArray[np.float64], objects: list[Path], tmp_path: Path
) -> None:
    parameters = otherwise({"method": "FilteredRegression", "range.phi": 1e-5})
    program = tool(tmp_path, objects, parameters)
    with_gap = samples[1500:2500].copy()
    with_gap[400:600, 1] = np.inf
    done = subprocess.run([program], input=with_gap.tobytes(), capture_output=True)
    lines = done.stderr.decode().splitlines()
    assert done.returncode == 0 and len(lines) == 2
    assert "far beyond range.phi" in lines[0] and "tick at t = 1.9 s skipped" in lines[1]


def test_the_address_sanitizer_finds_no_error_and_no_leak(
    samples: NDArray[np.float64], c_sources: Path, tmp_path: Path
) -> None:
    flags = ("-g", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    checked = [unit(tmp_path, c_sources, text, *flags) for text in includes()]
    run(tool(tmp_path, checked, otherwise({"method": "FilteredRegression"}), *flags), samples[:300])


def test_the_block_takes_the_outputs_in_the_order_of_the_function() -> None:
    block, tick = (classes()[f"Estimators.{n}"] for n in ("StiffnessEstimator", "Internal.tick"))
    (when,) = block.statements
    ((statement,),) = when.blocks
    taken = [str(each).replace("setPoint_used", "setPoint") for each in statement.left]
    assert taken == list(outputs())
    given = [str(each) for each in statement.right.operands]
    declared = [name for name, each in tick.symbols.items() if "input" in each.prefixes]
    assert ["t" if each == "time" else each for each in given] == declared
    arguments = external_arguments("Estimators/Internal.mo", "sigmahat_estimator_tick")
    assert arguments == [*declared, *outputs()]


def test_the_block_gives_every_parameter_to_the_constructor() -> None:
    flat = [
        n for each in constructor_arguments() for n in ([each] if isinstance(each, str) else each)
    ]
    expected = {n for n in otherwise({}) if not n.startswith("rls.eta_0[")} | {"rls.eta_0"}
    assert len(flat) == len(set(flat)) and set(flat) == expected


def test_the_noise_is_that_of_the_plants(c_sources: Path, tmp_path: Path) -> None:
    own = unit(tmp_path, c_sources, '#include "sigmahat_noise.c"\n')
    program = tmp_path / "noise"
    gcc(DRIVERS / "noise.c", own, "-lm", "-o", program)
    start = {"noise.seed": 7, "noise.tau_variance": 4.0, "noise.tau_e_variance": 9.0}
    # The plant is at rest: nothing but noise is measured. TorqueNoise.mo has these channels.
    deviation = {
        "tau_measured_1": 2,
        "tau_e_measured_1": 3,
        "tau_measured_2": 2,
        "tau_e_measured_2": 3,
    }
    recording = simulate(Plant("AntagonisticVsaPlant", start, {}, list(deviation)), {}, T, 1000)
    for channel, (name, factor) in enumerate(deviation.items()):
        command = [str(program), "7", str(channel), "1001"]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        normals = np.array([float.fromhex(line) for line in done.stdout.split()])
        np.testing.assert_array_equal(recording.plant[name], factor * normals)
