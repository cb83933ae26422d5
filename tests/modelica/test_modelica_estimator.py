"""The C functions of the Modelica package give the same results as sigmahat.Estimator."""

import ctypes
import math
import re
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
import pytest
from numpy.typing import NDArray

import sigmahat
from controllers import run
from gate import need
from recordings import one_seed
from sigmahat.fmi.instance import Fmu
from sigmahat.fmi.master import Plant, simulate
from sigmahat_build.modelica import KEYWORDS

DRIVERS = Path(__file__).parents[1] / "drivers" / "modelica"
FLAGS = ["-std=c99", "-O2", "-g", "-ffp-contract=off", "-fPIC"]
WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]
SANITIZER = ("-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
T, N = 1e-3, 3000
NOISY = {"tau_measured": 2, "tau_e_measured": 3}
INPUTS = ("theta", "q", "theta_c", "tau", "tau_e_sensor")


class Tool:
    """A library of the external C functions, with methods that call these like a Modelica block."""

    def __init__(self, package: Path, folder: Path, fmu: Fmu) -> None:
        self.fmu, self.sources = fmu, package / "Resources" / "C-Sources"
        calls = (package / "Estimators" / "Internal.mo").read_text(encoding="utf-8")
        block = (package / "Estimators" / "StiffnessEstimator.mo").read_text(encoding="utf-8")
        self.includes = [
            each.replace("\\", "") + "\n"
            for each in re.findall(r'Include="(#include .+?)"[,)]', calls)
        ]
        assert len(self.includes) == 3
        given = re.search(
            r"Internal\.Estimator\(\s*\{(.*?)\},\s*\{(.*?)\},\s*rls.eta_0\)", block, re.S
        )
        taken = re.search(r"sigmahat_estimator_tick\(estimator, t,([^)]*)\)", calls)
        assert given and taken
        self.reals, self.integers = (
            [_parameter(n) for n in each.split(",")] for each in given.groups()
        )
        self.arguments = [name.strip() for name in taken[1].split(",")]
        self.outputs = self.arguments[len(INPUTS) :]
        assert self.arguments[: len(INPUTS)] == list(INPUTS)
        objects = [
            self.compiled(folder, each)
            for each in (*self.includes, '#include "sigmahat_noise.c"\n', '#include "tool.c"\n')
        ]
        library = folder / "tool.so"
        gcc("-shared", *objects, "-lm", "-o", library)
        self.library = ctypes.CDLL(str(library))
        self.library.tool_new.restype = ctypes.c_void_p
        self.library.sigmahat_standard_normal.restype = ctypes.c_double

    def compiled(self, folder: Path, text: str, *flags: str) -> Path:
        """Compiles a C source text and returns the object file."""
        source = Path(tempfile.mkdtemp(dir=folder)) / "unit.c"
        source.write_text(text)
        search = (f"-I{self.sources}", f"-I{DRIVERS}")
        gcc(*flags, *search, "-c", source, "-o", source.with_suffix(".o"))
        return source.with_suffix(".o")

    def messages(self) -> str:
        """Returns the error messages since the last call of `messages`."""
        buffer = ctypes.c_char.in_dll(self.library, "tool_messages")
        text = ctypes.string_at(ctypes.addressof(buffer)).decode()
        buffer.value = b"\0"
        return text

    def values(self, parameters: Mapping[str, Any]) -> tuple[list[float], list[int], list[float]]:
        """Returns the arguments of the constructor for parameters with their names in the FMU."""

        def number(name: str) -> float:
            # For a parameter that the Modelica block does not have, the block passes a number.
            known = name in parameters
            return self.fmu.number(name, parameters[name]) if known else float(name)

        eta_0 = [float(parameters[f"rls.eta_0[{i},{j}]"]) for i in range(8) for j in range(5)]
        return [*map(number, self.reals)], [int(number(n)) for n in self.integers], eta_0

    def new(self, parameters: Mapping[str, Any]) -> int | None:
        """Creates an external object, or returns None after an error."""
        reals, integers, eta_0 = self.values(parameters)
        made: int | None = self.library.tool_new(
            (ctypes.c_double * len(reals))(*reals),
            (ctypes.c_int * len(integers))(*integers),
            (ctypes.c_double * len(eta_0))(*eta_0),
        )
        return made

    def run(
        self, parameters: Mapping[str, Any], samples: NDArray[np.float64], *before: float
    ) -> dict[str, NDArray[Any]]:
        """Returns the outputs of a tick for each row of samples, which has time and inputs.

        A second object with other inputs makes a tick in between. If `before` is given, each tick
        is made twice, first with the inputs `before`.
        """
        objects = [ctypes.c_void_p(self.new(parameters)) for _ in range(2)]
        types: dict[str, Any] = {"double": ctypes.c_double, "int": ctypes.c_int}
        places = [(types[kind] * size)() for kind, size in map(self.declared, self.outputs)]
        pointers = [ctypes.byref(each) for each in places]
        rows: dict[str, list[Any]] = {name: [] for name in self.outputs}
        for t, *z in samples.tolist():
            for which, inputs in ((0, before), (1, [0.0] * 5), (0, z)):
                if inputs:
                    numbers = [ctypes.c_double(each) for each in (t, *inputs)]
                    self.library.sigmahat_estimator_tick(objects[which], *numbers, *pointers)
            for name, place in zip(self.outputs, places, strict=True):
                rows[name].append(list(place) if name == "eta" else place[0])
        for each in objects:
            self.library.sigmahat_estimator_free(each)
        return {name: np.array(each) for name, each in rows.items()}

    def declared(self, name: str) -> tuple[str, int]:
        """Returns the C type and the number of elements of an output."""
        if name == "eta":
            return "double", 40
        return "double" if self.fmu.variable(name).type == "Real" else "int", 1


def _parameter(expression: str) -> str:
    """Returns the FMU name of a parameter from the Modelica expression that the block passes."""
    name = re.sub(r"Integer\((.*)\)|if (.*) then 1 else 0", r"\1\2", expression.strip())
    for theirs, ours in KEYWORDS.items():
        name = re.sub(rf"^{ours}\.", f"{theirs}.", name)
    return name


def gcc(*arguments: str | Path) -> None:
    assert run(need("gcc"), *FLAGS, *WARNINGS, *arguments) == ""


@pytest.fixture(scope="module")
def tool(build: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tool]:
    """The compiled C functions of the Modelica package in the released archive."""
    folder = tmp_path_factory.mktemp("package")
    with ZipFile(build / "release" / "sigmahat-modelica.zip") as archive:
        archive.extractall(folder)
    (package,) = folder.glob("Sigmahat *")
    with Fmu(sigmahat.fmu("StiffnessEstimator")) as fmu:
        yield Tool(package, folder, fmu)


SETTINGS: dict[str, dict[str, Any]] = {
    "paper": {
        **{"modality": "Sensor", "deformation": "Filtered", "filter.kind": "Kalman"},
        **{"filter.weighting": "AsPrinted", "rls.kind": "ConstantFactor"},
        **{"rls.symmetric": False, "torque.held": True},
    },
    "regression": {
        **{"method": "FilteredRegression", "modality": "Model", "torque.held": True},
        **{"rls.n": 3, "rls.m": 2},
    },
    "regression as it starts": {"method": "FilteredRegression"},
}


def otherwise(setting: Mapping[str, Any]) -> dict[str, Any]:
    """Returns all parameters of the block, with real values that each differ from the default."""
    changed: dict[str, Any] = {}
    for number, (name, value) in enumerate(sigmahat.Estimator().parameters[0].items()):
        if isinstance(value, float) and name != "samplePeriod":
            changed[name] = (value or 1e-3) * (1 + 0.02 * math.sin(number))
        else:
            changed[name] = value
    del changed["encoder.theta_c"]  # without effect, so not in the block
    return {**changed, **setting}


@pytest.fixture(scope="module")
def samples() -> NDArray[np.float64]:
    """Time and inputs of the scenario table1, with one sample that is not finite."""
    plant = one_seed("table1").recording.plant
    columns = [plant[f"{n}_measured"][:N] for n in ("theta", "q", "theta_c", "tau", "tau_e")]
    z = np.column_stack([T * np.arange(N), *columns])
    z[2000, 2] = np.nan
    return z


@pytest.mark.parametrize("setting", SETTINGS.values(), ids=SETTINGS)
def test_the_outputs_are_those_of_the_library_to_the_last_bit(
    setting: dict[str, Any], samples: NDArray[np.float64], tool: Tool
) -> None:
    """Each parameter has a unique value, so that the test detects swapped arguments."""
    parameters = otherwise(setting)
    found = tool.run(parameters, samples)
    eta = [f"eta[{i},{j}]" for i in range(8) for j in range(5)]
    record = [name for name in tool.outputs if name != "eta"]
    estimator = sigmahat.Estimator(parameters, record=[*record, *eta])
    expected = estimator.run(**dict(zip(INPUTS, samples[:, 1:].T, strict=True)))
    for name in record:
        column = [tool.fmu.number(name, each) for each in expected[name].tolist()]
        np.testing.assert_array_equal(found[name], column, err_msg=name)
    np.testing.assert_array_equal(found["eta"], np.column_stack([expected[n] for n in eta]))
    assert found["valid"].sum() == N - 1 and np.ptp(found["sigma"]) > 1
    given = parameters.keys() & {*tool.reals, *tool.integers}
    assert given == {name for name in parameters if not name.startswith("rls.eta_0")}


def test_a_second_tick_at_the_same_time_replaces_the_first(
    samples: NDArray[np.float64], tool: Tool
) -> None:
    once = tool.run(otherwise({}), samples)
    twice = tool.run(otherwise({}), samples, 1.0, 2.0, 3.0, 4.0, 5.0)
    for name, column in once.items():
        np.testing.assert_array_equal(column, twice[name], err_msg=name)


@pytest.mark.slow("the library is compiled with the sanitizer")
def test_all_in_one_file_they_run_without_an_error_of_memory(tool: Tool, tmp_path: Path) -> None:
    """A Modelica tool may write all external functions and repeated includes into one file."""
    includes = "".join(tool.includes) * 2 + '#include "sigmahat_noise.c"\n#include "tool.c"\n'
    given = "const double reals[] = {%s}; const int integers[] = {%s}; const double eta_0[] = {%s};"
    lists = (", ".join(map(repr, each)) for each in tool.values(otherwise(SETTINGS["regression"])))
    declared = {name: tool.declared(name) for name in tool.outputs}
    places = " ".join(f"{kind} {name}[{size}];" for name, (kind, size) in declared.items())
    tick = "sigmahat_estimator_tick(o, 1e-3 * k, sin(k), 1.1 * sin(k), 1, cos(k), 0, %s);"
    body = (
        f"{given % tuple(lists)} {places} int k; void *o = tool_new(reals, integers, eta_0);"
        f" for (k = 0; k < 300; ++k) {{ {tick % ', '.join(tool.outputs)} }}"
        " sigmahat_estimator_free(o); return *valid != 1;"
    )
    unit = tool.compiled(tmp_path, f"{includes}int main(void) {{ {body} }}\n", *SANITIZER)
    gcc(*SANITIZER, unit, "-lm", "-o", tmp_path / "program")
    assert run(tmp_path / "program") == ""


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"noise.tau": 2e12}, "noise.tau = 2e+12 is out of its range: 1e-12 to 1e12."),
        ({"model.k_s": -2.0}, "nominal.k_s = -2 is out of its range: >= 0."),
        ({"rls.n": 9}, "rls.n = 9 is out of its range: 1 to 8."),
    ],
)
def test_a_parameter_out_of_its_range_is_an_error_of_the_model(
    wrong: dict[str, Any], message: str, tool: Tool
) -> None:
    tool.messages()
    assert tool.new({**otherwise({}), **wrong}) is None
    assert tool.messages() == f"StiffnessEstimator: parameter {message}\n"


def test_skipped_ticks_and_too_large_deformations_are_told_once(
    samples: NDArray[np.float64], tool: Tool
) -> None:
    with_gap = samples[1500:2500].copy()
    with_gap[400:600, 1] = np.inf
    tool.messages()
    tool.run(otherwise({"method": "FilteredRegression", "range.phi": 1e-3}), with_gap)
    lines = tool.messages().splitlines()
    assert len(lines) == 2
    assert "far beyond range.phi" in lines[0] and "tick at t = 1.9 s skipped" in lines[1]


def test_the_noise_is_that_of_the_plants(tool: Tool) -> None:
    start = {"noise.seed": 7, "noise.tau_variance": 4.0, "noise.tau_e_variance": 9.0}
    # GIVEN a plant at rest, THEN it measures only noise, from the channels of TorqueNoise.mo.
    deviation = {f"{n}_{i}": sd for i in (1, 2) for n, sd in NOISY.items()}
    recording = simulate(Plant("AntagonisticVsaPlant", start, {}, list(deviation)), {}, T, 1000)
    for channel, (name, factor) in enumerate(deviation.items()):
        normals = [tool.library.sigmahat_standard_normal(7, k, channel) for k in range(1001)]
        np.testing.assert_array_equal(recording.plant[name], factor * np.array(normals))
